#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "tests/export/plans.hpp"

/// The proof must be able to fail: programs are damaged as a wrong writer would, and the reading back has to notice.
namespace seampath {
namespace read_back_test {

using exporting::Format;
using exporting::Program;
using exporting::Target;
using exporting::TextFile;

class ReadBack : public testing::TestWithParam<std::size_t> {
protected:
    const Format& format() const { return exporting::format(GetParam()); }
    const Plan plan = test::golden_plan_for(format().name);
    const ExportOptions options = test::arc_options();
    const Program program = program_of(plan, format(), options);
    const std::vector<TextFile> files = format().write(program, options);

    /// With another text of the first file, or of that one.
    void read_and_compare(const std::string& text, std::size_t file = 0) const {
        std::vector<TextFile> damaged = files;
        damaged[file].text = text;
        compare(format(), format().told(options), program.targets, format().read(damaged));
    }
    const std::string& text() const { return files.at(0).text; }
};

INSTANTIATE_TEST_SUITE_P(Export, ReadBack, testing::Range<std::size_t>(0, kRobotNames.size()),
                         [](const auto& tested) { return std::string(kRobotNames[tested.param]); });

TEST_P(ReadBack, AcceptsWhatTheWriterWrote) {
    EXPECT_EQ(format().name, kRobotNames[GetParam()]);
    EXPECT_NO_THROW(read_and_compare(text()));
}

// A waypoint's line is one with a coordinate pattern of the language.
std::vector<std::size_t> move_lines(const std::vector<std::string>& lines) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        for (const char* mark :
             {" [[", "(p[0.0", "(p[-0.0", "(p[0.1", "\"station_mm\":", ",weld", ",approach,", ",retract,", ",air,",
              "LIN P", "PTP P", ":L P[", ":J P[", "MOVL C", "MOVJ C", "G1 X", "- {position", "{x: "}) {
            if (lines[i].find(mark) != std::string::npos && lines[i].find("set_tcp") == std::string::npos &&
                lines[i].front() != '#') {
                found.push_back(i);
                break;
            }
        }
    }
    return found;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = text.find('\n', at);
        lines.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return lines;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) {
        text += line + "\n";
    }
    return text;
}

TEST_P(ReadBack, NoticesMovesLeftOutDoubledOrSwapped) {
    const std::vector<std::string> lines = lines_of(text());
    const std::vector<std::size_t> moves = move_lines(lines);
    ASSERT_EQ(moves.size(), program.targets.size());
    for (std::size_t k = 0; k < moves.size(); ++k) {
        auto damaged = lines;
        damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(moves[k]));
        EXPECT_THROW(read_and_compare(joined(damaged)), InternalError) << "without " << lines[moves[k]];
        damaged = lines;
        damaged.insert(damaged.begin() + static_cast<std::ptrdiff_t>(moves[k]), lines[moves[k]]);
        EXPECT_THROW(read_and_compare(joined(damaged)), InternalError) << "twice " << lines[moves[k]];
        if (k + 1 < moves.size()) {
            damaged = lines;
            std::swap(damaged[moves[k]], damaged[moves[k + 1]]);
            EXPECT_THROW(read_and_compare(joined(damaged)), InternalError) << "swapped " << lines[moves[k]];
        }
    }
}

TEST_P(ReadBack, NoticesATruncatedFile) {
    for (std::size_t file = 0; file < files.size(); ++file) {
        const std::string& whole = files[file].text;
        for (std::size_t size = 0; size + 2 < whole.size(); size += 37) {
            EXPECT_THROW(read_and_compare(whole.substr(0, size), file), InternalError)
                << files[file].name << " " << size;
        }
    }
}

// Any byte made another, of long files one in several: the file is refused, or says the same as before.
TEST_P(ReadBack, SurvivesAnyDamagedByte) {
    const std::string others = "x(-\n\"[;9\xFF";
    for (std::size_t file = 0; file < files.size(); ++file) {
        constexpr std::size_t kTrials = 5000;
        const std::size_t size = files[file].text.size();
        for (std::size_t at = 0; at < size; at += 1 + size / kTrials) {
            std::string damaged = files[file].text;
            damaged[at] = others[at % others.size()];
            try {
                read_and_compare(damaged, file);
            } catch (const InternalError&) {
            }
        }
    }
}

// A word that no language has, before and behind every word of every line: each must be understood or refused. Only
// what a language itself leaves free may hold it: comments, the values of two headings, JSON's texts.
TEST_P(ReadBack, RefusesUnknownWordsAnywhere) {
    const std::vector<std::string> free{"!", ";", "#", "'", "&PARAM", "FILE_NAME", "///COMM", "\"tool\""};
    for (std::size_t file = 0; file < files.size(); ++file) {
        if (files[file].name.ends_with(".mcap")) {
            continue;
        }
        const std::vector<std::string> lines = lines_of(files[file].text);
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const std::string start =
                lines[i].substr(std::min(lines[i].size(), lines[i].find_first_not_of(" 0123456789:")));
            if (std::any_of(free.begin(), free.end(), [&](const auto& word) { return start.starts_with(word); })) {
                continue;
            }
            for (std::size_t at = 0; at < lines[i].size(); ++at) {
                if (at > 0 && lines[i][at - 1] != ' ' && lines[i][at - 1] != ',') {
                    continue;
                }
                std::vector<std::string> damaged = lines;
                damaged[i].insert(at, " frobnicate ");
                EXPECT_THROW(read_and_compare(joined(damaged), file), InternalError)
                    << files[file].name << ": " << damaged[i];
            }
        }
    }
}

TEST_P(ReadBack, ComparesEveryNumber) {
    const std::vector<Target>& all = program.targets;
    const auto told = format().told(options);
    const std::vector<Target> read = format().read(files);
    const auto expect_noticed = [&](const char* what, const std::function<void(Waypoint&)>& change) {
        for (const std::size_t k : {std::size_t{0}, all.size() / 2, all.size() - 1}) {
            std::vector<Target> changed = read;
            change(changed[k].at);
            EXPECT_THROW(compare(format(), told, all, changed), InternalError) << what << " of " << k;
        }
    };
    std::vector<Target> moved = read;
    moved.back().move = exporting::Move::circular;
    EXPECT_THROW(compare(format(), told, all, moved), InternalError) << "move";
    expect_noticed("position", [](Waypoint& w) { w.p.x() += 0.0011; });
    expect_noticed("position", [](Waypoint& w) { w.p.z() = std::nan(""); });
    expect_noticed("orientation", [](Waypoint& w) {
        w.q = w.q * Eigen::Quaterniond(Eigen::AngleAxisd(3e-5, Eigen::Vector3d::UnitZ()));
    });
    if (!std::isnan(read[0].at.speed_mm_s)) {
        expect_noticed("speed", [](Waypoint& w) { w.speed_mm_s *= 1.006; });
    }
    expect_noticed("kind", [](Waypoint& w) {
        w.kind = w.kind == WaypointKind::weld ? WaypointKind::weld_end : WaypointKind::weld;
    });
    if (told == exporting::Told::everything) {
        expect_noticed("time", [](Waypoint& w) { w.time_s += 1e-9; });
        expect_noticed("seam", [](Waypoint& w) { ++w.seam; });
        expect_noticed("index", [](Waypoint& w) { ++w.index; });
        expect_noticed("station", [](Waypoint& w) { w.station_mm += 1e-9; });
        expect_noticed("sigma", [](Waypoint& w) { w.sigma_mm += 1e-9; });
    }
}

struct Damage {
    std::string robot;
    std::string from, to, message;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// What each language itself forbids, or would read as something else.
TEST(ReadBackRules, HoldTheLanguages) {
    const std::vector<Damage> all{
        {"csv", "qw,qx,qy,qz,speed", "qx,qy,qz,qw,speed", "does not say what was planned"},
        {"csv", "weld_start", "weld_begin", "kind was needed"},
        {"csv", "sigma_mm\n", "sigma\n", "sigma_mm was needed"},
        {"json", "\"length\":\"mm\"", "\"length\":\"m\"", "\"length\" being mm"},
        {"json", "\"qw\":", "\"w\":", "a member \"qw\""},
        {"json", "]\n}\n", "]\n}\n}", "the end of the file"},
        {"abb", "ConfL\\Off;", "ConfL\\On;", "\\Off"},
        {"abb", "    ConfJ\\Off;\n", "", "ConfJ"},
        {"abb", "ArcLStart", "ArcL", "ArcLStart first"},
        {"abb", "ArcLEnd", "ArcL", "ArcLEnd first"},
        {"abb", ",seam1", "", "6 arguments"},
        {"abb", "\\WObj:=wobj0", "", "\\WObj"},
        {"abb", "9E9", "0", "9E9 for an external axis"},
        {"abb", "speed0:=[100", "speed0:=[100.6", "speed of 100.6"},
        {"abb", "[0.00000000,1.00000000", "[0.00100000,1.00000000", "normalised"},
        {"abb", "PROC golden_seam1", "PROC a_name_of_more_than_32_characters", "at most 32"},
        {"abb", "    golden_seam1;\n", "", "moves instead of"},
        {"abb", "    golden_seam1;\n", "    main;\n", "not of itself"},
        {"abb", "fine,tool0\\WObj:=wobj0;\n    ArcL ", "z10,tool0\\WObj:=wobj0;\n    ArcL ", "zone fine"},
        {"abb", "fine,tool0\\WObj:=wobj0;\n    ArcLStart", "z10,tool0\\WObj:=wobj0;\n    ArcLStart", "without a stop"},
        {"abb", "PROC golden_seam1", "PROC golden_seam0", "each procedure once"},
        {"abb", "speeddata speed1", "speeddata speed0", "all data once"},
        {"kuka", "LIN P5\r\n", "LIN P5 C_DIS\r\n", "without a stop"},
        {"fanuc", "L P[6] 100mm/sec FINE", "L P[6] 100mm/sec CNT100", "without a stop"},
        {"yaskawa", "MOVL C00005 V=600.0 PL=0", "MOVL C00005 V=600.0 PL=1", "without a stop"},
        {"ur", "  set_tcp", "  # set_tcp", "set_tcp"},
        {"ur", "out(3, True)", "out(3, False)", "does not say what was planned"},
        {"ur", "r=0.001000", "r=0.020000", "half of both neighbouring moves"},
        {"ur", "v=0.008500, r", "v=0.009000, r", "speed of 9 mm/s"},
        {"ur", "v=0.008500, r", "t=0.008500, r", "overrides the speed"},
        {"ur", "movep(p[", "movep([", "a pose before"},
        {"ur", "movep(", "movec(", "2 poses"},
        {"ur", "movep(", "moveq(", "a known function"},
        {"kuka", "BAS(#INITMOV,0)\r\n", "", "BAS(#INITMOV,0)"},
        {"kuka", "$TOOL=TOOL_DATA[6]\r\n", "", "$TOOL"},
        {"kuka", "$BASE=BASE_DATA[3]", "$BASE=BASE_DATA[0]", "a number of data"},
        {"kuka", "PTP P0", "LIN P0", "a first move along the axes"},
        {"kuka", "LIN P1\r\n", "LIN P1 C_DIS\r\n", "an exact stop"},
        {"kuka", "WAIT SEC 0\r\nArcOff", "ArcOff", "a wait where the arc changes"},
        {"kuka", "ArcOff()", "ArcOn()", "the same two sub-programs in turn"},
        {"kuka", "LIN P2", "LIN P99", "a frame of the .dat"},
        {"kuka", "LIN P2 C_DIS", "LIN P2 C_VEL", "c_dis"},
        {"kuka", "LIN P2 C_DIS", "LIN P2 C_DIS C_DIS", "the end of the line"},
        {"kuka", "LIN P2 C_DIS", "SLIN P2", "SPLINE"},
        {"kuka", "$VEL.CP=0.0085", "$VEL.CP=0.0086", "has a speed of 8.6"},
        {"kuka", "$VEL.CP=0.0085", "$VEL.OP=0.0085", "a known variable"},
        {"kuka", "\r\nEND", "\nEND", "carriage return"},
        {"fanuc", "UTOOL_NUM=2", "UTOOL_NUM=3", "the active user frame and tool"},
        {"fanuc", "LINE_COUNT\t= ", "LINE_COUNT\t= 1", "LINE_COUNT"},
        {"fanuc", "100mm/sec FINE\r\n    :  Arc Start[6]", "100mm/sec CNT100\r\n    :  Arc Start[6]", "and FINE"},
        {"fanuc", "Arc Start[6]", "Arc End[6]", "Start before"},
        {"fanuc", "  Weave Sine[8]", "  Weave Wave[8]", "a weave that begins"},
        {"fanuc", "/APPL\r\n  ARC Welding Equipment : 1,*,*,*,*;\r\n", "", "the welding equipment"},
        {"fanuc", "51cm/min", "8mm/sec", "has a speed of 8 mm/s"},
        {"fanuc", "51cm/min", "8.5mm/sec", "a whole number of a speed"},
        {"fanuc", "51cm/min CNT100", "51cm/min CNT90", "FINE or CNT100"},
        {"fanuc", "J P[1] 10%", "L P[1] 10%", "a first move along the axes"},
        {"fanuc", "CONFIG : 'N U T, 0, 0, 0'", "CONFIG : 'F U T, 0, 0, 0'", "the same configuration"},
        {"fanuc", "CONFIG : 'N U T, 0, 0, 0'", "CONFIG : 'X U T, 0, 0, 0'", "the letters NF"},
        {"fanuc", "/PROG  GOLDEN", "/PROG  GOLDE", "the file's name"},
        {"fanuc", "   1:", "   2:", "the next line number"},
        {"yaskawa", "///TOOL", "///TOUL", "///TOOL"},
        {"yaskawa", "///NPOS 1", "///NPOS 2", "///TOOL before"},
        {"yaskawa", "///POSTYPE USER", "///POSTYPE BASE", "USER"},
        {"yaskawa", "////FRAME USER 2", "////FRAME USER 1", "the frame of the positions"},
        {"yaskawa", "C00002=", "C00003=", "the next position"},
        {"yaskawa", "MOVJ C00000", "MOVL C00000", "a first move along the axes"},
        {"yaskawa", "V=51.0", "V=8.5", "has a speed of 1.41"},
        {"yaskawa", "V in cm/min", "V in mm/s", "has a speed"},
        {"yaskawa", "PL=0\r\nARCON", "PL=1\r\nARCON", "a stop, PL=0"},
        {"yaskawa", "ARCON ASF#(4)", "ARCON ASF#(0)", "a number from 1 on"},
        {"yaskawa", "WVOF\r\n", "", "WVOF"},
        {"yaskawa", "ARCOF", "ARCOFF", "a known instruction"},
        {"linuxcnc", "G21 ", "G20 ", "a known G code"},
        {"linuxcnc", "G21 ", "", "G21, G90 and G94"},
        {"linuxcnc", "G21 G90", "G21 G90 G90", "one word of a modal group"},
        {"linuxcnc", " F510\n", " F500\n", "has a speed of 8.3"},
        {"linuxcnc", "G64 P0.01", "G64", "a tolerance P with G64"},
        {"linuxcnc", "M62 P1\n", "", "in turn"},
        {"linuxcnc", "M62 P1", "M64 P1", "M62 or M63"},
        {"linuxcnc", "M63 P1", "M62 P1", "in turn"},
        {"linuxcnc", "M2\n", "", "M2"},
        {"linuxcnc", "M2\n", "M2\nM2\n", "the end of the file"},
        {"linuxcnc", "; Written by", "; " + std::string(300, 'x'), "252 characters"},
        {"linuxcnc", "A-135.00000", "A225.00000", "angles that go on without a jump"},
        {"linuxcnc", "G43", "M6", "a tool"},
        {"ros", "frame_id: base_link", "frame_id: base", "one frame"},
        {"ros", "position", "pozition", "position"},
        {"ros", "w: ", "v: ", "w was needed"},
        {"ros", "header:", "headr:", "header"},
        {"noether", "qw:", "w:", "members x, y, z, qw"},
        {"noether", "]],", "]]", "']'"},
        {"noether", "qx: 1.000000000000", "qx: 1.000100000000", "a unit quaternion"},
    };
    ExportOptions options = test::arc_options();
    options.program_name = "golden";
    for (const Damage& damage : all) {
        const Plan plan = test::golden_plan_for(damage.robot);
        const Format& format = exporting::format(static_cast<std::size_t>(
            std::find(kRobotNames.begin(), kRobotNames.end(), damage.robot) - kRobotNames.begin()));
        const Program program = program_of(plan, format, options);
        std::vector<TextFile> files = format.write(program, options);
        files[0].text = replaced(files[0].text, damage.from, damage.to);
        EXPECT_THAT([&] { compare(format, format.told(options), program.targets, format.read(files)); },
                    testing::ThrowsMessage<InternalError>(testing::HasSubstr(damage.message)))
            << format.name << ": " << damage.from << " -> " << damage.to;
    }
}

}  // namespace read_back_test
}  // namespace seampath
