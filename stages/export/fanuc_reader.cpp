#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "stages/export/fanuc_program.hpp"
#include "stages/geometry/arc.hpp"

/// Reads FANUC TP programs as a controller would load and run them: attributes, numbered instructions, positions of
/// group 1 in the user and tool frame that are active. Anything else is an error.
namespace seampath::exporting {
namespace fanuc_reader {

constexpr std::size_t kLongestRemark = 32;

class Controller {
public:
    explicit Controller(const std::vector<TextFile>& files) {
        for (const TextFile& file : files) {
            programs_.push_back(load_fanuc(file));
        }
        run(programs_.at(0), 0);
        require(!arc_ && !weave_, Scanner(files.at(0), '\0'), "arc and weave to end");
    }
    std::vector<Target> targets;

private:
    void run(const FanucProgram& program, int depth) {
        for (const FanucInstruction& instruction : program.instructions) {
            Scanner scan = instruction.at;
            execute(scan, program, depth);
        }
    }

    void execute(Scanner& scan, const FanucProgram& program, int depth) {
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
                std::find_if(programs_.begin(), programs_.end(), [&](const FanucProgram& p) { return p.name == name; });
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
            fanuc_index(scan);
        }
        weave_ = what == "Sine";
    }

    void motion(Scanner& scan, const std::string& word, const FanucProgram& program) {
        require(!targets.empty() || word == "J", scan, "a first move along the axes");
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
        targets.back().passed = !fine;
        if (scan.accept(':')) {
            process(scan, program, fine);
        }
    }

    void add(Scanner& scan, const FanucProgram& program, Move move) {
        require(scan.name() == "P", scan, "P");
        const auto found = program.positions.find(fanuc_index(scan));
        require(found != program.positions.end(), scan, "a position of this program");
        const FanucPosition& position = found->second;
        require(position.user_frame == user_frame_ && position.tool == tool_, scan, "the active user frame and tool");
        const bool axes = !position.target.axes.empty();
        require(axes ? move == Move::joint && !arc_ : targets.empty() || move != Move::joint, scan,
                "axes on moves along them, behind the first, and poses on others");
        if (!axes) {
            require(configuration_.empty() || position.configuration == configuration_, scan, "the same configuration");
            configuration_ = position.configuration;
        }
        Target target = position.target;
        target.move = move;
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

    void process(Scanner& scan, const FanucProgram& program, bool fine) {
        require(program.welds && fine, scan, "the welding equipment in /APPL, and FINE,");
        require(scan.name() == "Arc", scan, "Arc");
        const std::string what = scan.name();
        require(what == (arc_ ? "End" : "Start"), scan, arc_ ? "End" : "Start");
        fanuc_index(scan);
        targets.back().at.kind = arc_ ? WaypointKind::weld_end : WaypointKind::weld_start;
        arc_ = !arc_;
    }

    std::vector<FanucProgram> programs_;
    double user_frame_ = -1, tool_ = -1;
    std::string configuration_;
    bool arc_ = false, weave_ = false;
};

}  // namespace fanuc_reader

std::vector<Target> read_fanuc(const std::vector<TextFile>& files) {
    return fanuc_reader::Controller(files).targets;
}

}  // namespace seampath::exporting
