#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include "stages/export/yaskawa_job.hpp"

/// Reads INFORM jobs as a controller would: positions of one tool, frame and configuration, instructions line by line,
/// calls of other jobs. What V= means is no part of a job: the comment that tells it is held to. Anything else is an
/// error.
namespace seampath::exporting {
namespace yaskawa_reader {

constexpr std::size_t kLongestComment = 32;

// "... V in cm/min; ..." among the comments.
double mm_s_per_unit(const std::string& comments, const Scanner& place) {
    const auto at = comments.find("V in ");
    require(at != std::string::npos, place, "a comment that tells the unit of V=");
    const std::string unit = comments.substr(at + 5, comments.find(';', at) - at - 5);
    const std::map<std::string, double> units{
        {"mm/s", 1}, {"cm/min", 10.0 / 60}, {"m/min", 1000.0 / 60}, {"inch/min", 25.4 / 60}};
    const auto found = units.find(unit);
    require(found != units.end(), place, "a unit of speed");
    return found->second;
}

// "Pulses per deg: 1000 1000 ... ." among the comments; none where there are no pulses.
std::array<double, 6> pulses_per_degree(const std::string& comments, const Scanner& place) {
    std::array<double, 6> result{};
    constexpr std::string_view kBefore = "Pulses per deg:";
    const auto at = comments.find(kBefore);
    if (at != std::string::npos) {
        std::istringstream numbers(comments.substr(at + kBefore.size()));
        for (double& number : result) {
            require(static_cast<bool>(numbers >> number) && number != 0, place, "six numbers behind Pulses per deg:");
        }
    }
    return result;
}

class Controller {
public:
    explicit Controller(const std::vector<TextFile>& files) {
        for (const TextFile& file : files) {
            jobs_.push_back(load_yaskawa(file));
        }
        const Scanner start(files.at(0), '\0');
        mm_s_per_unit_ = mm_s_per_unit(jobs_.front().comments, start);
        pulses_per_deg_ = pulses_per_degree(jobs_.front().comments, start);
        run(jobs_.front(), 0);
        require(!arc_ && !weave_, start, "arc and weave to end");
    }
    std::vector<Target> targets;

private:
    void run(const YaskawaJob& job, int depth) {
        for (Scanner scan : job.lines) {
            if (scan.accept('\'')) {
                require(scan.to_line_end().size() <= kLongestComment, scan, "a comment of at most 32 characters");
                continue;
            }
            const std::string word = scan.name();
            if (word == "MOVJ" || word == "MOVL" || word == "MOVC") {
                motion(scan, word, job);
            } else if (word == "CALL") {
                require(scan.accept("JOB:"), scan, "JOB:");
                call(scan, scan.name(), depth);
            } else {
                process(scan, word);
            }
            require(scan.at_line_end(), scan, "the end of the line");
        }
        require(circle_ == 0, job.lines.back(), "the third MOVC");
    }

    void call(Scanner& scan, const std::string& name, int depth) {
        const auto job = std::find_if(jobs_.begin(), jobs_.end(), [&](const YaskawaJob& j) { return j.name == name; });
        require(job != jobs_.end() && depth < 3, scan, "a job of these files, and not itself,");
        run(*job, depth + 1);
    }

    // ARCON ASF#(n), WVON WEV#(n), WVOF, ARCOF AEF#(n)
    void process(Scanner& scan, const std::string& word) {
        require(circle_ == 0 && !targets.empty() && stopped_, scan, "a stop, PL=0, where the arc changes");
        if (word == "ARCON") {
            require(!arc_, scan, "ARCOF first");
            number(scan, "ASF");
            targets.back().at.kind = WaypointKind::weld_start;
            arc_ = true;
        } else if (word == "ARCOF") {
            require(arc_ && !weave_, scan, "ARCON first, and WVOF,");
            number(scan, "AEF");
            targets.back().at.kind = WaypointKind::weld_end;
            arc_ = false;
        } else if (word == "WVON" || word == "WVOF") {
            require(arc_ && weave_ == (word == "WVOF"), scan, "weaving on and off in turn while the arc burns");
            weave_ = word == "WVON";
            if (weave_) {
                number(scan, "WEV");
            }
        } else {
            scan.fail("a known instruction before this place");
        }
    }

    static void number(Scanner& scan, const char* kind) {
        require(scan.name() == kind && scan.accept("#("), scan, std::string(kind) + "#(n)");
        require(whole_number(scan) >= 1, scan, "a number from 1 on");
        scan.expect(')');
    }

    void motion(Scanner& scan, const std::string& word, const YaskawaJob& job) {
        scan.expect('C');
        const double number = whole_number(scan);
        require(!targets.empty() || word == "MOVJ", scan, "a first move along the axes");
        Target target;
        if (const auto found = job.poses.find(number); found != job.poses.end()) {
            const auto [x, y, z, rx, ry, rz] = found->second;
            target.at.p = {x, y, z};
            target.at.q = turned(rz, ry, rx);
            require(targets.empty() || word != "MOVJ", scan, "pulses for a MOVJ behind the first");
        } else {
            target = by_pulses(scan, job, number);
            require(word == "MOVJ" && !arc_, scan, "MOVJ to pulses, and the arc off,");
        }
        target.at.kind = arc_ ? WaypointKind::weld : WaypointKind::air;
        target.at.speed_mm_s = speed(scan, word);
        stopped_ = word == "MOVJ";
        if (scan.accept("PL=")) {
            const double level = whole_number(scan);
            require(level <= 8, scan, "a position level from 0 to 8");
            stopped_ = level == 0;
        }
        target.passed = !stopped_;
        const bool on_the_spot = !targets.empty() && targets.back().at.p == target.at.p &&
                                 targets.back().at.q.coeffs() == target.at.q.coeffs();
        if (word == "MOVC") {
            circle(scan, target, on_the_spot);
            return;
        }
        require(circle_ == 0, scan, "the third MOVC");
        arc_before_ = false;
        if (word == "MOVL" && on_the_spot && targets.back().move == Move::circular && !spot_) {
            spot_ = true;  // parts two circles
            return;
        }
        require(!spot_, scan, "a circle behind a move on the spot");
        target.move = word == "MOVJ" ? Move::joint : Move::linear;
        targets.push_back(target);
    }

    Target by_pulses(Scanner& scan, const YaskawaJob& job, double number) const {
        const auto found = job.pulses.find(number);
        require(found != job.pulses.end(), scan, "a position of this job");
        std::array<double, 6> q_deg = found->second;
        for (std::size_t i = 0; i < q_deg.size(); ++i) {
            require(pulses_per_deg_[i] != 0, scan, "a comment that tells the pulses per deg");
            q_deg[i] /= pulses_per_deg_[i];
        }
        return axes_target(q_deg);
    }

    // The first of three is where the robot stands; a circle right behind another would be one of more points.
    void circle(Scanner& scan, Target& target, bool on_the_spot) {
        if (circle_ == 0) {
            require(on_the_spot && !arc_before_, scan,
                    "a first MOVC where the robot stands, apart from another circle,");
            spot_ = false;
        } else {
            target.move = circle_ == 1 ? Move::via : Move::circular;
            targets.push_back(target);
        }
        circle_ = (circle_ + 1) % 3;
        arc_before_ = circle_ == 0;
    }

    // Joint moves have a share of the axes' speeds.
    double speed(Scanner& scan, const std::string& word) const {
        if (word == "MOVJ") {
            require(scan.accept("VJ="), scan, "VJ=");
            const double share = scan.number();
            require(share > 0 && share <= 100, scan, "a share of 100");
            return std::numeric_limits<double>::quiet_NaN();
        }
        require(scan.accept("V="), scan, "V=");
        const double value = mm_s_per_unit_ * scan.number();
        require(value > 0 && value <= 1500.5, scan, "a speed up to 1500 mm/s");
        return value;
    }

    std::vector<YaskawaJob> jobs_;
    double mm_s_per_unit_ = 0;
    std::array<double, 6> pulses_per_deg_{};
    int circle_ = 0;           // MOVC so far, of three
    bool arc_before_ = false;  // the last move was a circle's third
    bool spot_ = false;        // it was a move on the spot
    bool stopped_ = false;
    bool arc_ = false, weave_ = false;
};

}  // namespace yaskawa_reader

std::vector<Target> read_yaskawa(const std::vector<TextFile>& files) {
    return yaskawa_reader::Controller(files).targets;
}

}  // namespace seampath::exporting
