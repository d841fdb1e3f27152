#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "stages/export/text.hpp"
#include "stages/geometry/arc.hpp"

/// Reads FANUC TP programs as a controller would load and run them: attributes, numbered instructions, positions of
/// group 1 in the user and tool frame that are active. Anything else is an error.
namespace seampath::exporting {
namespace {

constexpr std::size_t kLongestName = 36;
constexpr std::size_t kLongestRemark = 32;

struct Position {
    Eigen::Vector3d p;
    Eigen::Quaterniond q;
    double user_frame = 0, tool = 0;
    std::string configuration;
};

struct Instruction {
    Scanner at;  // behind the line number
};

struct Loaded {
    std::string name;
    std::vector<Instruction> instructions;
    std::map<double, Position> positions;
    bool welds = false;  // the application's section was there
};

void expect_word(Scanner& scan, const std::string& word) {
    require(scan.name() == word, scan, word);
}

// A whole number in brackets.
double index(Scanner& scan) {
    scan.expect('[');
    const double n = scan.number();
    require(n >= 1 && n == std::floor(n), scan, "a number");
    scan.expect(']');
    return n;
}

// Keys and values up to the next section; what they hold is the loader's to compute, but for the number of lines.
double attributes(Scanner& scan) {
    static const std::array<std::string_view, 19> known{
        "OWNER",         "COMMENT",       "PROG_SIZE",    "CREATE",        "MODIFIED",
        "FILE_NAME",     "VERSION",       "PROTECT",      "MEMORY_SIZE",   "TCD",
        "STACK_SIZE",    "TASK_PRIORITY", "TIME_SLICE",   "BUSY_LAMP_OFF", "ABORT_REQUEST",
        "PAUSE_REQUEST", "DEFAULT_GROUP", "CONTROL_CODE", "LINE_COUNT"};
    double lines = -1;
    while (scan.at_name()) {
        const std::string key = scan.name();
        require(std::find(known.begin(), known.end(), key) != known.end(), scan, "a known attribute");
        if (key == "TCD") {
            scan.expect(':');
            continue;
        }
        scan.expect('=');
        if (key == "LINE_COUNT") {
            lines = scan.number();
            scan.expect(';');
            continue;
        }
        const std::string value = scan.to_line_end();
        require(value.ends_with(';') || (value.ends_with(',') && key != "DEFAULT_GROUP"), scan, "';' or ','");
        require(key != "DEFAULT_GROUP" || value == " 1,*,*,*,*;", scan, "group 1 alone");
    }
    return lines;
}

// "   5:" at the start of each; a line that is continued has blanks there.
std::vector<Instruction> instructions(Scanner& scan) {
    std::vector<Instruction> result;
    while (!scan.accept("/POS")) {
        const double number = scan.number();
        require(number == static_cast<double>(result.size()) + 1, scan, "the next line number");
        scan.expect(':');
        result.push_back({scan});
        std::string line = scan.to_line_end();
        while (!line.ends_with(" ;")) {
            require(line.find(';') == std::string::npos, scan, "';' at the end of the line");
            scan.expect(':');
            line = scan.to_line_end();
        }
        require(line.find(';') + 1 == line.size(), scan, "one ';'");
    }
    return result;
}

double coordinate(Scanner& scan, const std::string& name, const std::string& unit) {
    expect_word(scan, name);
    scan.expect('=');
    const double value = scan.number();
    expect_word(scan, unit);
    return value;
}

std::string configuration(Scanner& scan) {
    scan.expect('\'');
    std::string text;
    for (const char* letters : {"NF", "UD", "TB"}) {
        const std::string letter = scan.name();
        require(letter.size() == 1 && std::string(letters).find(letter) != std::string::npos, scan,
                "one of the letters " + std::string(letters));
        text += letter;
    }
    for (int turn = 0; turn < 3; ++turn) {
        scan.expect(',');
        const double number = scan.number();
        require(number == std::floor(number) && std::abs(number) < 10, scan, "a turn number");
        text += "," + plain(number);
    }
    scan.expect('\'');
    return text;
}

Position position(Scanner& scan) {
    Position result;
    scan.expect('{');
    expect_word(scan, "GP1");
    scan.expect(':');
    expect_word(scan, "UF");
    scan.expect(':');
    result.user_frame = scan.number();
    scan.expect(',');
    expect_word(scan, "UT");
    scan.expect(':');
    result.tool = scan.number();
    scan.expect(',');
    expect_word(scan, "CONFIG");
    scan.expect(':');
    result.configuration = configuration(scan);
    std::array<double, 6> numbers{};
    constexpr std::array<const char*, 6> kNames{"X", "Y", "Z", "W", "P", "R"};
    for (std::size_t i = 0; i < 6; ++i) {
        scan.expect(',');
        numbers[i] = coordinate(scan, kNames[i], i < 3 ? "mm" : "deg");
        require(i < 3 || std::abs(numbers[i]) <= 180, scan, "an angle within 180 deg");
    }
    scan.expect('}');
    scan.expect(';');
    result.p = {numbers[0], numbers[1], numbers[2]};
    // Fixed axes: W about X first, then P about Y, then R about Z.
    result.q = turned(numbers[5], numbers[4], numbers[3]);
    return result;
}

Loaded load(const TextFile& file) {
    require_crlf_ascii(file);
    Scanner scan(file, '\0');
    Loaded result;
    require(scan.accept("/PROG"), scan, "/PROG");
    result.name = scan.name();
    require(result.name.size() <= kLongestName && file.name == result.name + ".ls", scan,
            "the file's name, of at most 36 characters");
    require(scan.accept("/ATTR"), scan, "/ATTR");
    const double lines = attributes(scan);
    if (scan.accept("/APPL")) {
        result.welds = scan.to_line_end().empty() && scan.accept("ARC Welding Equipment : 1,*,*,*,*;");
        require(result.welds, scan, "the welding equipment");
    }
    require(scan.accept("/MN"), scan, "/MN");
    result.instructions = instructions(scan);
    require(lines == static_cast<double>(result.instructions.size()), scan, "as many lines as LINE_COUNT says");
    while (!scan.accept("/END")) {
        expect_word(scan, "P");
        const double number = index(scan);
        require(result.positions.emplace(number, position(scan)).second, scan, "each position once");
    }
    require(scan.done(), scan, "the end of the file");
    return result;
}

class Controller {
public:
    explicit Controller(const std::vector<TextFile>& files) {
        for (const TextFile& file : files) {
            programs_.push_back(load(file));
        }
        run(programs_.at(0), 0);
        require(!arc_ && !weave_, Scanner(files.at(0), '\0'), "arc and weave to end");
    }
    std::vector<Target> targets;

private:
    void run(const Loaded& program, int depth) {
        for (const Instruction& instruction : program.instructions) {
            Scanner scan = instruction.at;
            execute(scan, program, depth);
        }
    }

    void execute(Scanner& scan, const Loaded& program, int depth) {
        if (scan.accept('!')) {
            std::string remark = scan.to_line_end();
            require(remark.size() <= kLongestRemark + 2, scan, "a remark of at most 32 characters");
            return;
        }
        const std::string word = scan.name();
        if (word == "UFRAME_NUM" || word == "UTOOL_NUM") {
            scan.expect('=');
            (word == "UTOOL_NUM" ? tool_ : user_frame_) = scan.number();
        } else if (word == "CALL") {
            const std::string name = scan.name();
            const auto called =
                std::find_if(programs_.begin(), programs_.end(), [&](const Loaded& p) { return p.name == name; });
            require(called != programs_.end() && depth < 3, scan, "a program of these files, and not itself,");
            run(*called, depth + 1);
        } else if (word == "Weave") {
            weave(scan);
        } else if (word == "J" || word == "L" || word == "C") {
            motion(scan, word, program);
        } else {
            scan.fail("a known instruction before this place");
        }
        scan.expect(';');
    }

    void weave(Scanner& scan) {
        const std::string what = scan.name();
        require((what == "Sine" && !weave_ && arc_) || (what == "End" && weave_ && !arc_), scan,
                "a weave that begins behind Arc Start and ends behind Arc End");
        if (what == "Sine") {
            index(scan);
        }
        weave_ = what == "Sine";
    }

    void motion(Scanner& scan, const std::string& word, const Loaded& program) {
        require(targets.empty() == (word == "J"), scan, "a first move along the axes, and no other,");
        if (word == "C") {
            add(scan, program, Move::via);
            scan.expect(':');
        }
        add(scan, program, word == "J" ? Move::joint : word == "C" ? Move::circular : Move::linear);
        const double speed = speed_of(scan);
        targets.back().at.speed_mm_s = speed;
        if (word == "C") {
            targets[targets.size() - 2].at.speed_mm_s = speed;
        }
        const std::string termination = scan.name();
        const bool fine = termination == "FINE";
        require(fine || termination == "CNT100", scan, "FINE or CNT100");
        if (scan.accept(':')) {
            process(scan, program, fine);
        }
    }

    void add(Scanner& scan, const Loaded& program, Move move) {
        expect_word(scan, "P");
        const auto found = program.positions.find(index(scan));
        require(found != program.positions.end(), scan, "a position of this program");
        const Position& position = found->second;
        require(position.user_frame == user_frame_ && position.tool == tool_, scan, "the active user frame and tool");
        require(targets.empty() || position.configuration == configuration_, scan, "the same configuration");
        configuration_ = position.configuration;
        Target target;
        target.move = move;
        target.at.p = position.p;
        target.at.q = position.q;
        target.at.kind = arc_ ? WaypointKind::weld : WaypointKind::air;
        targets.push_back(target);
    }

    // Joint moves have a share of the axes' speeds; a time is for the whole of a move.
    double speed_of(Scanner& scan) const {
        const double number = scan.number();
        require(number >= 1 && number == std::floor(number), scan, "a whole number of a speed");
        const bool joint = targets.back().move == Move::joint;
        if (scan.accept('%')) {
            require(joint && number <= 100, scan, "a share on joint moves alone");
            return std::numeric_limits<double>::quiet_NaN();
        }
        require(!joint, scan, "% of a joint move");
        if (scan.accept("msec")) {
            require(number <= 32000, scan, "a time of at most 32000 msec");
            return 1000 * length() / number;
        }
        if (scan.accept("cm/min")) {
            require(number <= 12000, scan, "at most 12000cm/min");
            return number / 6;
        }
        require(scan.accept("mm/sec") && number <= 2000, scan, "at most 2000mm/sec, or cm/min or msec,");
        return number;
    }

    double length() const {
        const std::size_t k = targets.size() - 1;
        if (targets[k].move != Move::circular) {
            return (targets[k].at.p - targets[k - 1].at.p).norm();
        }
        const auto arc = arc_through(targets[k - 2].at.p, targets[k - 1].at.p, targets[k].at.p);
        return arc ? arc->radius * arc->angle : 0;
    }

    void process(Scanner& scan, const Loaded& program, bool fine) {
        require(program.welds && fine, scan, "the welding equipment in /APPL, and FINE,");
        expect_word(scan, "Arc");
        const std::string what = scan.name();
        require(what == (arc_ ? "End" : "Start"), scan, arc_ ? "End" : "Start");
        index(scan);
        targets.back().at.kind = arc_ ? WaypointKind::weld_end : WaypointKind::weld_start;
        arc_ = !arc_;
    }

    std::vector<Loaded> programs_;
    double user_frame_ = -1, tool_ = -1;
    std::string configuration_;
    bool arc_ = false, weave_ = false;
};

}  // namespace

std::vector<Target> read_fanuc(const std::vector<TextFile>& files) {
    return Controller(files).targets;
}

}  // namespace seampath::exporting
