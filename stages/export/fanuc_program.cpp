#include "stages/export/fanuc_program.hpp"

#include <array>
#include <cmath>

namespace seampath::exporting {
namespace {

constexpr std::size_t kLongestName = 36;

void expect_word(Scanner& scan, const std::string& word) {
    require(scan.name() == word, scan, word);
}

enum class Attribute { number, word, text, file, date, groups, code, more };

const std::map<std::string, Attribute>& known_attributes() {
    using enum Attribute;
    static const std::map<std::string, Attribute> known{{"OWNER", word},           {"COMMENT", text},
                                                        {"PROG_SIZE", number},     {"CREATE", date},
                                                        {"MODIFIED", date},        {"FILE_NAME", file},
                                                        {"VERSION", number},       {"PROTECT", word},
                                                        {"MEMORY_SIZE", number},   {"TCD", more},
                                                        {"STACK_SIZE", number},    {"TASK_PRIORITY", number},
                                                        {"TIME_SLICE", number},    {"BUSY_LAMP_OFF", number},
                                                        {"ABORT_REQUEST", number}, {"PAUSE_REQUEST", number},
                                                        {"DEFAULT_GROUP", groups}, {"CONTROL_CODE", code},
                                                        {"LINE_COUNT", number}};
    return known;
}

// Three numbers: 70-01-01 or 00:00:00.
void three_numbers(Scanner& scan, char between) {
    scan.number();
    for (int i = 0; i < 2; ++i) {
        scan.expect(between);
        scan.number();
    }
}

// What is no number is none of the program's business, but it must be what the key has.
double attribute(Scanner& scan, Attribute kind) {
    double number = 0;
    if (kind == Attribute::number) {
        number = scan.number();
    } else if (kind == Attribute::word || (kind == Attribute::file && scan.at_name())) {
        scan.name();
    } else if (kind == Attribute::text) {
        scan.quoted();
    } else if (kind == Attribute::date) {
        expect_word(scan, "DATE");
        three_numbers(scan, '-');
        expect_word(scan, "TIME");
        three_numbers(scan, ':');
    } else if (kind == Attribute::code) {
        scan.number();
        scan.number();
    } else if (kind == Attribute::groups) {
        require(scan.accept("1,*,*,*,*"), scan, "group 1 alone");
    }
    return number;
}

// Keys and values up to the next section: the number of lines.
double attributes(Scanner& scan) {
    double lines = -1;
    while (scan.at_name()) {
        const std::string key = scan.name();
        const auto known = known_attributes().find(key);
        require(known != known_attributes().end(), scan, "a known attribute");
        if (known->second == Attribute::more) {
            scan.expect(':');
            continue;
        }
        scan.expect('=');
        const double number = attribute(scan, known->second);
        lines = key == "LINE_COUNT" ? number : lines;
        require(scan.accept(';') || scan.accept(','), scan, "';' or ','");
    }
    return lines;
}

// "   5:" at the start of each; a line that is continued has blanks there.
std::vector<FanucInstruction> instructions(Scanner& scan) {
    std::vector<FanucInstruction> result;
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

void set_pose(Waypoint& w, Scanner& scan) {
    std::array<double, 6> numbers{};
    constexpr std::array<const char*, 6> kNames{"X", "Y", "Z", "W", "P", "R"};
    for (std::size_t i = 0; i < 6; ++i) {
        scan.expect(',');
        numbers[i] = coordinate(scan, kNames[i], i < 3 ? "mm" : "deg");
        require(i < 3 || std::abs(numbers[i]) <= 180, scan, "an angle within 180 deg");
    }
    w.p = {numbers[0], numbers[1], numbers[2]};
    // Fixed axes: W about X first, then P about Y, then R about Z.
    w.q = turned(numbers[5], numbers[4], numbers[3]);
}

// Behind the first J. What counts J2 in is the forearm's angle to the upper arm, not the pendant's J3.
std::array<double, 6> axes(Scanner& scan) {
    std::array<double, 6> j{};
    for (std::size_t i = 0; i < 6; ++i) {
        if (i > 0) {
            scan.expect(',');
            scan.expect('J');
        }
        require(scan.number() == static_cast<double>(i + 1), scan, "the next axis");
        scan.expect('=');
        j[i] = scan.number();
        expect_word(scan, "deg");
    }
    j[2] += j[1];
    return j;
}

FanucPosition position(Scanner& scan) {
    FanucPosition result;
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
    if (scan.accept('J')) {
        result.target = axes_target(axes(scan));
    } else {
        expect_word(scan, "CONFIG");
        scan.expect(':');
        result.configuration = configuration(scan);
        set_pose(result.target.at, scan);
    }
    scan.expect('}');
    scan.expect(';');
    return result;
}

}  // namespace

double fanuc_index(Scanner& scan) {
    scan.expect('[');
    const double n = scan.number();
    require(n >= 1 && n == std::floor(n), scan, "a number");
    scan.expect(']');
    return n;
}

FanucProgram load_fanuc(const TextFile& file) {
    require_crlf_ascii(file);
    Scanner scan(file, '\0');
    FanucProgram result;
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
        const double number = fanuc_index(scan);
        require(result.positions.emplace(number, position(scan)).second, scan, "each position once");
    }
    require(scan.done(), scan, "the end of the file");
    return result;
}

}  // namespace seampath::exporting
