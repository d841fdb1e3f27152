#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "stages/export/text.hpp"

/// Reads KRL modules as a controller would: frames from the .dat, statements of the .src line by line, calls into other
/// modules. A call of what is in none of the files strikes or ends the arc, in turn. Anything else is an error.
namespace seampath::exporting {
namespace kuka_reader {

constexpr std::size_t kLongestName = 24;

// Names are not case-sensitive.
std::string identifier(Scanner& scan) {
    std::string name = lower(scan.name());
    if (name.size() > kLongestName) {
        scan.fail("a name of at most 24 characters before this place");
    }
    return name;
}

void expect_word(Scanner& scan, const std::string& word) {
    if (identifier(scan) != word) {
        scan.fail(word + " before this place");
    }
}

// $VEL.CP, $BASE: in lower case, without the sign.
std::string variable(Scanner& scan) {
    scan.expect('$');
    std::string name = identifier(scan);
    while (scan.accept('.')) {
        name += "." + identifier(scan);
    }
    return name;
}

// Lines beginning with & come first.
void header(Scanner& scan) {
    while (scan.accept('&')) {
        const std::string word = identifier(scan);
        if (word == "access") {
            identifier(scan);
        } else if (word == "rel") {
            scan.number();
        } else if (word == "param") {
            identifier(scan);
            scan.expect('=');
            scan.to_line_end();
        } else {
            scan.fail("ACCESS, REL or PARAM before this place");
        }
        scan.end_line();
    }
}

// {X 1,Y 2,...}: six parts by their names.
std::array<double, 6> aggregate(Scanner& scan, const std::array<const char*, 6>& names) {
    scan.expect('{');
    std::map<std::string, double> parts;
    do {
        const std::string name = identifier(scan);
        if (!parts.emplace(name, scan.number()).second) {
            scan.fail("each part once before this place");
        }
    } while (scan.accept(','));
    scan.expect('}');
    if (parts.size() != 6) {
        scan.fail("six parts before this place");
    }
    std::array<double, 6> result{};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto found = parts.find(names[i]);
        if (found == parts.end()) {
            scan.fail(std::string("part ") + names[i] + " before this place");
        }
        result[i] = found->second;
    }
    return result;
}

// {X 1,Y 2,Z 3,A 4,B 5,C 6} is Rz(A) Ry(B) Rx(C).
Target frame(Scanner& scan) {
    const auto [x, y, z, a, b, c] = aggregate(scan, {"x", "y", "z", "a", "b", "c"});
    Waypoint w;
    w.p = {x, y, z};
    if (!(std::abs(a) <= 180 && std::abs(b) <= 90 && std::abs(c) <= 180)) {
        scan.fail("angles within 180, 90 and 180 deg before this place");
    }
    w.q = turned(a, b, c);
    return {w};
}

using Frames = std::map<std::string, Target>;

// DEFDAT name, declarations of a line each, ENDDAT.
Frames data_list(const TextFile& file, const std::string& module) {
    require_crlf_ascii(file);
    Scanner scan(file, ';', Scanner::Lines::kept);
    header(scan);
    expect_word(scan, "defdat");
    expect_word(scan, module);
    scan.end_line();
    Frames frames;
    for (std::string word = identifier(scan); word != "enddat"; word = identifier(scan)) {
        const std::string type = word == "decl" ? identifier(scan) : "";
        if (type != "frame" && type != "e6axis") {
            scan.fail("DECL FRAME or DECL E6AXIS before this place");
        }
        const std::string name = identifier(scan);
        scan.expect('=');
        const Target target =
            type == "frame" ? frame(scan) : axes_target(aggregate(scan, {"a1", "a2", "a3", "a4", "a5", "a6"}));
        require(frames.emplace(name, target).second, scan, "each point once");
        scan.end_line();
    }
    scan.end_line();
    if (!scan.done()) {
        scan.fail("the end of the file");
    }
    return frames;
}

struct Module {
    const TextFile* source = nullptr;
    Frames frames;
};

class Controller {
public:
    explicit Controller(const std::vector<TextFile>& files) {
        for (const TextFile& file : files) {
            const auto dot = file.name.rfind('.');
            const std::string name = lower(file.name.substr(0, dot));
            if (dot != std::string::npos && file.name.substr(dot) == ".dat") {
                modules_[name].frames = data_list(file, name);
            } else {
                require_crlf_ascii(file);
                modules_[name].source = &file;
                main_ = main_.empty() ? name : main_;
            }
        }
        const Scanner start(files.at(0), ';');
        run(main_, start, 0);
        require(arc_ == Arc::off, start, "the arc to end");
    }
    std::vector<Target> targets;

private:
    enum class Arc { off, on };

    void run(const std::string& name, const Scanner& place, int depth) {
        require(depth < 3, place, "a call that is not of itself");
        const Module& module = modules_.at(name);
        require(module.source != nullptr, place, "a .src of " + name);
        Scanner scan(*module.source, ';', Scanner::Lines::kept);
        header(scan);
        expect_word(scan, "def");
        expect_word(scan, name);
        scan.expect('(');
        scan.expect(')');
        scan.end_line();
        while (statement(scan, module, depth)) {
            scan.end_line();
        }
        scan.end_line();
        require(scan.done(), scan, "the end of the file");
        require(!spline_, scan, "ENDSPLINE");
    }

    // False at END.
    bool statement(Scanner& scan, const Module& module, int depth) {
        if (!scan.at_name()) {
            assignment(scan);
            return true;
        }
        const std::string word = identifier(scan);
        require(!spline_ || word == "slin" || word == "scirc" || word == "endspline", scan,
                "nothing but spline segments in a spline block");
        if (word == "end") {
            return false;
        }
        if (word == "bas") {
            basics(scan);
        } else if (word == "ptp" || word == "lin" || word == "circ" || word == "slin" || word == "scirc") {
            motion(scan, word, module);
        } else if (word == "spline") {
            spline_ = true;
            spline_speed_ = with_speed(scan, speed_);
        } else if (word == "endspline") {
            require(spline_, scan, "SPLINE");
            spline_ = false;
            exact_ = true;
        } else if (word == "wait") {
            expect_word(scan, "sec");
            require(scan.number() >= 0, scan, "a time");
            waited_ = true;
        } else {
            call(scan, word, depth);
        }
        return true;
    }

    void basics(Scanner& scan) {
        scan.expect('(');
        scan.expect('#');
        const std::string what = identifier(scan);
        scan.expect(',');
        const double value = scan.number();
        scan.expect(')');
        require((what == "initmov" && value == 0) || (what == "vel_ptp" && value > 0 && value <= 100), scan,
                "#INITMOV,0 or #VEL_PTP and a share of 100");
        (what == "initmov" ? initialised_ : axis_speed_) = true;
    }

    void assignment(Scanner& scan) {
        const std::string name = variable(scan);
        scan.expect('=');
        if (name == "vel.cp") {
            speed_ = positive(scan);
        } else if (name == "apo.cdis") {
            require(scan.number() >= 0, scan, "a distance");
            approximation_ = true;
        } else if (name == "tool" || name == "load" || name == "base") {
            place_of(scan, name);
            (name == "tool" ? tool_ : name == "load" ? load_ : base_) = true;
        } else if (name == "ori_type" || name == "circ_type") {
            scan.expect('#');
            expect_word(scan, name == "ori_type" ? "var" : "base");
            (name == "ori_type" ? even_ : even_on_arcs_) = true;
        } else {
            scan.fail("a known variable before this place");
        }
    }

    static void place_of(Scanner& scan, const std::string& name) {
        if (name == "base" && scan.accept('$')) {
            expect_word(scan, "nullframe");
            return;
        }
        expect_word(scan, name + "_data");
        scan.expect('[');
        const double n = scan.number();
        require(n >= 1 && n == std::floor(n), scan, "a number of data");
        scan.expect(']');
    }

    static double positive(Scanner& scan) {
        const double value = scan.number();
        require(value > 0, scan, "a speed above 0");
        return value;
    }

    // WITH $VEL.CP=0.0085
    static double with_speed(Scanner& scan, double otherwise) {
        if (scan.at_line_end()) {
            return otherwise;
        }
        expect_word(scan, "with");
        require(variable(scan) == "vel.cp", scan, "$VEL.CP");
        scan.expect('=');
        return positive(scan);
    }

    void motion(Scanner& scan, const std::string& word, const Module& module) {
        require(initialised_ && tool_ && load_ && base_, scan, "BAS(#INITMOV,0), $TOOL, $LOAD and $BASE first");
        require((word[0] == 's') == spline_, scan, "SPLINE where spline segments stand, and only there,");
        require(!targets.empty() || word == "ptp", scan, "a first move along the axes");
        const bool circular = word == "circ" || word == "scirc";
        if (circular) {
            require(even_ && even_on_arcs_, scan, "$ORI_TYPE and $CIRC_TYPE first");
            add(scan, module, Move::via);
            scan.expect(',');
        }
        add(scan, module, word == "ptp" ? Move::joint : circular ? Move::circular : Move::linear);
        double speed = spline_ ? with_speed(scan, spline_speed_) : speed_;
        exact_ = !spline_;
        waited_ = false;
        if (word == "ptp") {
            require(axis_speed_, scan, "BAS(#VEL_PTP,...) first");
            speed = std::numeric_limits<double>::quiet_NaN();
        } else {
            require(speed > 0, scan, "$VEL.CP first");
        }
        if (!spline_ && word != "ptp" && !scan.at_line_end()) {
            expect_word(scan, "c_dis");
            require(approximation_, scan, "$APO.CDIS first");
            exact_ = false;
            targets.back().passed = true;
        }
        targets.back().at.speed_mm_s = 1000 * speed;
        if (circular) {
            targets[targets.size() - 2].at.speed_mm_s = 1000 * speed;
        }
    }

    void add(Scanner& scan, const Module& module, Move move) {
        const auto found = module.frames.find(identifier(scan));
        require(found != module.frames.end(), scan, "a frame of the .dat");
        const bool axes = !found->second.axes.empty();
        require(!axes || move == Move::joint, scan, "PTP to angles of axes");
        require(axes || targets.empty() || move != Move::joint, scan, "angles of axes for a PTP behind the first");
        require(!axes || arc_ == Arc::off, scan, "the arc off on a move along the axes");
        targets.push_back(found->second);
        targets.back().move = move;
        targets.back().at.kind = arc_ == Arc::on ? WaypointKind::weld : WaypointKind::air;
    }

    void call(Scanner& scan, const std::string& name, int depth) {
        scan.expect('(');
        scan.expect(')');
        if (modules_.contains(name)) {
            run(name, scan, depth + 1);
            return;
        }
        require(!targets.empty() && exact_ && waited_, scan, "an exact stop and a wait where the arc changes");
        const bool on = arc_ == Arc::off;
        std::string& known = on ? on_ : off_;
        known = known.empty() ? name : known;
        require(known == name && on_ != off_, scan, "the same two sub-programs in turn");
        targets.back().at.kind = on ? WaypointKind::weld_start : WaypointKind::weld_end;
        arc_ = on ? Arc::on : Arc::off;
    }

    std::map<std::string, Module> modules_;
    std::string main_, on_, off_;
    Arc arc_ = Arc::off;
    double speed_ = 0, spline_speed_ = 0;  // m/s
    bool initialised_ = false, axis_speed_ = false, tool_ = false, load_ = false, base_ = false, approximation_ = false;
    bool even_ = false, even_on_arcs_ = false, spline_ = false, exact_ = false, waited_ = false;
};

}  // namespace kuka_reader

std::vector<Target> read_kuka(const std::vector<TextFile>& files) {
    return kuka_reader::Controller(files).targets;
}

}  // namespace seampath::exporting
