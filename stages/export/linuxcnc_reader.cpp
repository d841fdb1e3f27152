#include <cmath>
#include <map>
#include <string>

#include "stages/export/text.hpp"

/// Reads G-code as LinuxCNC's interpreter would: blocks of words, modal groups, modal coordinates and feed. Anything
/// but what a program of straight moves may hold is an error.
namespace seampath::exporting {
namespace linuxcnc_reader {

constexpr std::size_t kLongestLine = 252;

// One word: a letter and a number without an exponent.
struct Word {
    char letter = 0;
    double number = 0;
};

class Interpreter {
public:
    explicit Interpreter(const TextFile& file) : scan_(file, ';', Scanner::Lines::kept) {
        std::size_t at = 0;
        while (at < file.text.size()) {
            const std::size_t end = file.text.find('\n', at);
            need(end != std::string::npos && end - at <= kLongestLine, "lines of at most 252 characters");
            at = end + 1;
        }
        while (!ended_) {
            need(!scan_.done(), "M2");
            block();
            scan_.end_line();
        }
        need(scan_.done(), "the end of the file");
        need(!arc_, "the output off at the end");
    }
    std::vector<Target> targets;

private:
    void need(bool holds, const std::string& needed) const { require(holds, scan_, needed); }

    Word word() {
        const char letter = scan_.letter();
        return {letter, scan_.decimal()};
    }

    void block() {
        std::map<int, double> group;  // modal group of each G word
        std::map<char, double> value;
        while (!scan_.at_line_end()) {
            const Word w = word();
            if (w.letter == 'G') {
                const int modal = group_of(w.number);
                need(group.emplace(modal, w.number).second, "one word of a modal group");
            } else {
                need(std::string("XYZABCFPTM").find(w.letter) != std::string::npos, "a known letter");
                need(value.emplace(w.letter, w.number).second, "each letter once");
            }
        }
        modes(group, value);
        if (value.contains('M')) {
            machine(value);
        } else if (value.contains('T')) {
            scan_.fail("M6 with a tool before this place");
        }
        const bool moves = value.contains('X') || value.contains('Y') || value.contains('Z') || value.contains('A') ||
                           value.contains('B') || value.contains('C');
        need(moves == group.contains(1), "G1 with coordinates");
        if (moves) {
            move(value);
        } else {
            need(!value.contains('F'), "a feed with a move");
        }
    }

    // Of the codes that are known here: RS274/NGC table 5.
    int group_of(double code) const {
        static const std::map<double, int> groups{
            {1, 1},   {17, 2},  {90, 3},  {94, 5},  {21, 6},    {40, 7},    {43, 8},    {80, 1},  {54, 12}, {55, 12},
            {56, 12}, {57, 12}, {58, 12}, {59, 12}, {59.1, 12}, {59.2, 12}, {59.3, 12}, {61, 13}, {64, 13}};
        const auto found = groups.find(code);
        need(found != groups.end(), "a known G code");
        // G80 ends canned cycles; it stands where no motion does.
        return code == 80 ? 100 : found->second;
    }

    void modes(const std::map<int, double>& group, const std::map<char, double>& value) {
        for (const auto& [modal, code] : group) {
            units_ = units_ || code == 21;
            absolute_ = absolute_ || code == 90;
            per_minute_ = per_minute_ || code == 94;
            if (modal == 13) {
                exact_ = code == 61;
                need(exact_ || (value.contains('P') && value.at('P') > 0), "a tolerance P with G64");
            }
        }
    }

    // M2, M6 with T, M62 and M63 with P.
    void machine(const std::map<char, double>& value) {
        const double code = value.at('M');
        if (code == 2) {
            ended_ = true;
        } else if (code == 6) {
            need(value.contains('T') && targets.empty(), "a tool, before all moves");
        } else {
            need((code == 62 || code == 63) && value.contains('P'), "M2, M6, M62 or M63");
            output(code == 62);
        }
    }

    // The output changes with the beginning of the next move: where the last one ended.
    void output(bool on) {
        need(on != arc_ && !targets.empty() && exact_end_, "an exact stop where the output changes, in turn,");
        targets.back().at.kind = on ? WaypointKind::weld_start : WaypointKind::weld_end;
        arc_ = on;
    }

    void move(const std::map<char, double>& value) {
        need(units_ && absolute_ && per_minute_, "G21, G90 and G94 first");
        for (const auto& [letter, number] : value) {
            at_[letter] = number;
        }
        need(at_['F'] > 0, "a feed");
        need(!targets.empty() || at_.size() >= 7, "all coordinates in the first move");
        Target target;
        target.at.kind = arc_ ? WaypointKind::weld : WaypointKind::air;
        target.at.p = {at_['X'], at_['Y'], at_['Z']};
        target.at.q = turned(at_['C'], at_['B'], at_['A']);
        target.at.speed_mm_s = at_['F'] / 60;
        target.passed = !exact_;
        check_turn();
        targets.push_back(target);
        exact_end_ = exact_;
    }

    // No axis may turn by half a turn or more between neighbouring poses.
    void check_turn() {
        for (const char axis : {'A', 'B', 'C'}) {
            const double now = at_[axis];
            need(!last_.contains(axis) || std::abs(now - last_[axis]) < 180, "angles that go on without a jump");
            last_[axis] = now;
        }
    }

    Scanner scan_;
    std::map<char, double> at_, last_;
    bool units_ = false, absolute_ = false, per_minute_ = false;
    bool exact_ = true, exact_end_ = false;
    bool arc_ = false, ended_ = false;
};

}  // namespace linuxcnc_reader

std::vector<Target> read_linuxcnc(const std::vector<TextFile>& files) {
    return linuxcnc_reader::Interpreter(files.at(0)).targets;
}

}  // namespace seampath::exporting
