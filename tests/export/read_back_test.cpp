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
namespace {

using exporting::Format;
using exporting::TextFile;

class ReadBack : public testing::TestWithParam<std::size_t> {
protected:
    const Format& format() const { return exporting::format(GetParam()); }
    const Plan plan = test::golden_plan();
    const ExportOptions options = test::arc_options();

    void read_and_compare(const std::string& text) const {
        compare(format(), format().told(options), plan.waypoints, format().read({{"damaged", text}}));
    }
    std::string text() const { return format().write(plan, options).at(0).text; }
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
             {"[[", "(p[0.0", "(p[-0.0", "(p[0.1", "\"station_mm\":", ",weld", ",approach,", ",retract,", ",air,"}) {
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
    ASSERT_EQ(moves.size(), plan.waypoints.size());
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
    const std::string whole = text();
    for (std::size_t size = 0; size + 2 < whole.size(); size += 37) {
        EXPECT_THROW(read_and_compare(whole.substr(0, size)), InternalError) << size;
    }
}

// Any byte made another: the file is refused, or says the same as before.
TEST_P(ReadBack, SurvivesAnyDamagedByte) {
    const std::string whole = text();
    const std::string others = "x(-\n\"[;9";
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string damaged = whole;
        damaged[at] = others[at % others.size()];
        try {
            read_and_compare(damaged);
        } catch (const InternalError&) {
        }
    }
}

TEST_P(ReadBack, ComparesEveryNumber) {
    const auto& all = plan.waypoints;
    const auto told = format().told(options);
    std::vector<Waypoint> read = format().read(format().write(plan, options));
    const auto expect_noticed = [&](const char* what, const std::function<void(Waypoint&)>& change) {
        for (const std::size_t k : {std::size_t{0}, all.size() / 2, all.size() - 1}) {
            std::vector<Waypoint> changed = read;
            change(changed[k]);
            EXPECT_THROW(compare(format(), told, all, changed), InternalError) << what << " of " << k;
        }
    };
    expect_noticed("position", [](Waypoint& w) { w.p.x() += 0.0011; });
    expect_noticed("position", [](Waypoint& w) { w.p.z() = std::nan(""); });
    expect_noticed("orientation", [](Waypoint& w) {
        w.q = w.q * Eigen::Quaterniond(Eigen::AngleAxisd(3e-5, Eigen::Vector3d::UnitZ()));
    });
    expect_noticed("speed", [](Waypoint& w) { w.speed_mm_s *= 1.006; });
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
    std::size_t robot;
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
        {0, "qw,qx,qy,qz,speed", "qx,qy,qz,qw,speed", "does not say what was planned"},
        {0, "weld_start", "weld_begin", "kind was needed"},
        {0, "sigma_mm\n", "sigma\n", "sigma_mm was needed"},
        {1, "\"length\":\"mm\"", "\"length\":\"m\"", "\"length\" being mm"},
        {1, "\"qw\":", "\"w\":", "a member \"qw\""},
        {1, "]\n}\n", "]\n}\n}", "the end of the file"},
        {2, "ConfL\\Off;", "ConfL\\On;", "\\Off"},
        {2, "    ConfJ\\Off;\n", "", "ConfJ"},
        {2, "ArcLStart", "ArcL", "ArcLStart first"},
        {2, "ArcLEnd", "ArcL", "ArcLEnd first"},
        {2, ",seam1", "", "6 arguments"},
        {2, "\\WObj:=wobj0", "", "\\WObj"},
        {2, "9E9", "0", "9E9 for an external axis"},
        {2, "speed0:=[100", "speed0:=[100.6", "speed of 100.6"},
        {2, "[0.00000000,1.00000000", "[0.00100000,1.00000000", "normalised"},
        {2, "PROC golden_seam1", "PROC a_name_of_more_than_32_characters", "at most 32"},
        {2, "    golden_seam1;\n", "", "moves instead of"},
        {2, "    golden_seam1;\n", "    main;\n", "not of itself"},
        {2, "fine,tool0\\WObj:=wobj0;\n    ArcL ", "z10,tool0\\WObj:=wobj0;\n    ArcL ", "zone fine"},
        {3, "  set_tcp", "  # set_tcp", "set_tcp"},
        {3, "out(3, True)", "out(3, False)", "does not say what was planned"},
        {3, "r=0.001000", "r=0.020000", "half of both neighbouring moves"},
        {3, "v=0.008500, r", "v=0.009000, r", "speed of 9 mm/s"},
        {3, "v=0.008500, r", "t=0.008500, r", "overrides the speed"},
        {3, "movep(p[", "movep([", "a number was needed"},
        {3, "movep(", "movec(", "a known function"},
    };
    ExportOptions options = test::arc_options();
    options.program_name = "golden";
    const Plan plan = test::golden_plan();
    for (const Damage& damage : all) {
        const Format& format = exporting::format(damage.robot);
        const std::string damaged = replaced(format.write(plan, options).at(0).text, damage.from, damage.to);
        EXPECT_THAT(
            [&] {
                compare(format, format.told(options), plan.waypoints, format.read({{"damaged", damaged}}));
            },
            testing::ThrowsMessage<InternalError>(testing::HasSubstr(damage.message)))
            << format.name << ": " << damage.from << " -> " << damage.to;
    }
}

}  // namespace
}  // namespace seampath
