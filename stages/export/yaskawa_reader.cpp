#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "stages/export/text.hpp"

/// Reads INFORM jobs as a controller would: positions of one tool, frame and configuration, instructions line by line,
/// calls of other jobs. What V= means is no part of a job: the comment that tells it is held to. Anything else is an
/// error.
namespace seampath::exporting {
namespace {

constexpr std::size_t kLongestName = 32;
constexpr std::size_t kLongestComment = 32;

double whole(Scanner& scan) {
    const double n = scan.number();
    require(n >= 0 && n == std::floor(n), scan, "a whole number");
    return n;
}

struct Pose {
    Eigen::Vector3d p;
    Eigen::Quaterniond q;
};

struct Job {
    std::string name, frame, comments;
    std::map<double, Pose> positions;
    std::vector<Scanner> lines;
};

// A line that begins so; what follows is left.
void heading(Scanner& scan, const char* text) {
    require(scan.accept(text), scan, text);
}

void heading_line(Scanner& scan, const char* text) {
    heading(scan, text);
    scan.end_line();
}

Pose pose(Scanner& scan) {
    std::array<double, 6> n{};
    for (std::size_t i = 0; i < 6; ++i) {
        if (i > 0) {
            scan.expect(',');
        }
        n[i] = scan.number();
        require(i < 3 || std::abs(n[i]) <= 180, scan, "an angle within 180 deg");
    }
    return {{n[0], n[1], n[2]}, turned(n[5], n[4], n[3])};
}

// What the positions are in, then the positions.
void positions(Scanner& scan, Job& job, double count) {
    if (scan.accept("///USER")) {
        job.frame = "USER " + plain(whole(scan));
        scan.end_line();
    } else {
        job.frame = "BASE";
    }
    heading(scan, "///TOOL");
    whole(scan);
    scan.end_line();
    heading(scan, "///POSTYPE");
    require(scan.name() == job.frame.substr(0, 4), scan, job.frame.substr(0, 4));
    scan.end_line();
    heading_line(scan, "///RECTAN");
    heading(scan, "///RCONF");
    int numbers = 0;
    do {
        require(whole(scan) <= 1, scan, "0 or 1");
        ++numbers;
    } while (scan.accept(','));
    require(numbers >= 6 && numbers <= 24, scan, "6 to 24 numbers");
    scan.end_line();
    for (double i = 0; i < count; ++i) {
        scan.expect('C');
        require(whole(scan) == i, scan, "the next position");
        scan.expect('=');
        job.positions[i] = pose(scan);
        scan.end_line();
    }
}

Job load(const TextFile& file) {
    require_crlf_ascii(file);
    Scanner scan(file, '\0', Scanner::Lines::kept);
    Job job;
    heading_line(scan, "/JOB");
    heading(scan, "//NAME");
    job.name = scan.name();
    require(job.name.size() <= kLongestName && file.name == job.name + ".jbi", scan,
            "the file's name, of at most 32 characters");
    scan.end_line();
    heading_line(scan, "//POS");
    heading(scan, "///NPOS");
    const double count = whole(scan);
    for (int i = 0; i < 5; ++i) {
        scan.expect(',');
        require(whole(scan) == 0, scan, "no other positions");
    }
    scan.end_line();
    if (count > 0) {
        positions(scan, job, count);
    }
    heading_line(scan, "//INST");
    heading(scan, "///DATE");
    scan.to_line_end();
    scan.end_line();
    heading(scan, "///COMM");
    require(scan.to_line_end().size() <= kLongestComment + 1, scan, "a comment of at most 32 characters");
    scan.end_line();
    heading_line(scan, "///ATTR SC,RW,RJ");
    heading(scan, "////FRAME");
    const std::string frame = scan.to_line_end();
    require(count == 0 || frame == " " + job.frame, scan, "the frame of the positions");
    scan.end_line();
    heading_line(scan, "///GROUP1 RB1");
    heading_line(scan, "NOP");
    while (!scan.accept("END")) {
        require(!scan.done(), scan, "END");
        job.lines.push_back(scan);
        const std::string line = scan.to_line_end();
        job.comments += line.starts_with("'") ? line.substr(1) + " " : "";
        scan.end_line();
    }
    scan.end_line();
    require(scan.done(), scan, "the end of the file");
    return job;
}

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

class Controller {
public:
    explicit Controller(const std::vector<TextFile>& files) {
        for (const TextFile& file : files) {
            jobs_.push_back(load(file));
        }
        const Scanner start(files.at(0), '\0');
        mm_s_per_unit_ = mm_s_per_unit(jobs_.front().comments, start);
        run(jobs_.front(), 0);
        require(!arc_ && !weave_, start, "arc and weave to end");
    }
    std::vector<Target> targets;

private:
    void run(const Job& job, int depth) {
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
        const auto job = std::find_if(jobs_.begin(), jobs_.end(), [&](const Job& j) { return j.name == name; });
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
        require(whole(scan) >= 1, scan, "a number from 1 on");
        scan.expect(')');
    }

    void motion(Scanner& scan, const std::string& word, const Job& job) {
        scan.expect('C');
        const auto found = job.positions.find(whole(scan));
        require(found != job.positions.end(), scan, "a position of this job");
        require(targets.empty() == (word == "MOVJ"), scan, "a first move along the axes, and no other,");
        Target target;
        target.at.p = found->second.p;
        target.at.q = found->second.q;
        target.at.kind = arc_ ? WaypointKind::weld : WaypointKind::air;
        target.at.speed_mm_s = speed(scan, word);
        stopped_ = word == "MOVJ";
        if (scan.accept("PL=")) {
            const double level = whole(scan);
            require(level <= 8, scan, "a position level from 0 to 8");
            stopped_ = level == 0;
        }
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

    std::vector<Job> jobs_;
    double mm_s_per_unit_ = 0;
    int circle_ = 0;           // MOVC so far, of three
    bool arc_before_ = false;  // the last move was a circle's third
    bool spot_ = false;        // it was a move on the spot
    bool stopped_ = false;
    bool arc_ = false, weave_ = false;
};

}  // namespace

std::vector<Target> read_yaskawa(const std::vector<TextFile>& files) {
    return Controller(files).targets;
}

}  // namespace seampath::exporting
