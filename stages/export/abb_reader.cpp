#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "stages/export/text.hpp"

/// Reads RAPID modules as a controller would: data declarations, procedures, and from main on the calls and moves.
/// Knows of the language what a program of moves may hold; anything else is an error.
namespace seampath::exporting {
namespace abb_reader {

// A literal, an aggregate in brackets or the name of data.
struct Value {
    double number = std::numeric_limits<double>::quiet_NaN();
    std::string name;
    std::vector<Value> items;
};

struct Instruction {
    std::string name;
    std::vector<Value> arguments;
    std::map<std::string, Value> options;  // \Name and \Name:=value
    Scanner place;                         // behind it, for messages
};

struct Module {
    std::map<std::string, Value> data;
    std::map<std::string, std::vector<Instruction>> procedures;
};

constexpr std::size_t kLongestName = 32;

// Names are not case-sensitive.
std::string identifier(Scanner& scan) {
    std::string name = lower(scan.name());
    if (!is_identifier(name) || name.size() > kLongestName) {
        scan.fail("an identifier of at most 32 letters, digits and underscores before this place");
    }
    return name;
}

void require_word(Scanner& scan, const std::string& word) {
    if (identifier(scan) != word) {
        scan.fail(word + " before this place");
    }
}

Value value(Scanner& scan) {
    Value result;
    if (scan.accept('[')) {
        do {
            result.items.push_back(value(scan));
        } while (scan.accept(','));
        scan.expect(']');
    } else if (scan.at_name()) {
        result.name = identifier(scan);
    } else {
        result.number = scan.number();
    }
    return result;
}

Instruction instruction(Scanner& scan, std::string name) {
    Instruction result{std::move(name), {}, {}, scan};
    bool separated = true;
    while (!scan.accept(';')) {
        if (scan.accept('\\')) {
            const std::string option = identifier(scan);
            result.options[option] = scan.accept(":=") ? value(scan) : Value{};
        } else if (separated || scan.accept(',')) {
            result.arguments.push_back(value(scan));
        } else {
            scan.fail("',', '\\' or ';'");
        }
        separated = false;
    }
    result.place = scan;
    return result;
}

std::vector<Instruction> procedure(Scanner& scan) {
    scan.expect('(');
    scan.expect(')');
    std::vector<Instruction> body;
    for (std::string word = identifier(scan); word != "endproc"; word = identifier(scan)) {
        body.push_back(instruction(scan, word));
    }
    return body;
}

Module module(const TextFile& file) {
    Scanner scan(file, '!');
    require_word(scan, "module");
    identifier(scan);
    Module result;
    for (std::string word = identifier(scan); word != "endmodule"; word = identifier(scan)) {
        if (word == "local" || word == "task") {
            word = identifier(scan);
        }
        if (word == "proc") {
            const std::string name = identifier(scan);
            require(result.procedures.emplace(name, procedure(scan)).second, scan, "each procedure once");
        } else if (word == "const" || word == "pers" || word == "var") {
            identifier(scan);  // the type; what the data is used for tells it as well
            const std::string name = identifier(scan);
            if (!scan.accept(":=")) {
                scan.fail("':='");
            }
            require(result.data.emplace(name, value(scan)).second, scan, "all data once");
            scan.expect(';');
        } else {
            scan.fail("a declaration or a procedure before this place");
        }
    }
    if (!scan.done()) {
        scan.fail("the end of the file");
    }
    return result;
}

class Controller {
public:
    explicit Controller(const std::vector<TextFile>& files) {
        for (const TextFile& file : files) {
            modules_.push_back(module(file));
        }
        const Scanner start(files.at(0), '!');
        call("main", start, 0);
        require(!welding_, start, "ArcLEnd at the end of the program");
    }
    std::vector<Target> targets;

private:
    void call(const std::string& name, const Scanner& place, int depth) {
        require(depth < 10, place, "a call that is not of itself");
        for (const Module& m : modules_) {
            if (const auto found = m.procedures.find(name); found != m.procedures.end()) {
                for (const Instruction& i : found->second) {
                    execute(i, m, depth);
                }
                return;
            }
        }
        place.fail("a procedure " + name);
    }

    void execute(const Instruction& i, const Module& m, int depth) {
        if (i.name == "confl" || i.name == "confj") {
            require(i.options.contains("off"), i.place, "\\Off");
            (i.name == "confl" ? linear_free_ : joint_free_) = true;
        } else if (i.name == "cirpathmode") {
            require(i.options.contains("objectframe"), i.place, "\\ObjectFrame");
            object_frame_ = true;
        } else if (i.name == "movel" || i.name == "movej" || i.name == "movec") {
            require(!welding_, i.place, "ArcLEnd first and not a move");
            move(i, m, 2, WaypointKind::air);
        } else if (i.name == "moveabsj") {
            require(!welding_, i.place, "ArcLEnd first and not a move");
            axes(i, m);
        } else if (i.name == "arclstart" || i.name == "arcl" || i.name == "arclend" || i.name == "arcc" ||
                   i.name == "arccend") {
            const bool start = i.name.ends_with("start"), end = i.name.ends_with("end");
            require(welding_ != start, i.place, "ArcLStart first, and once");
            move(i, m, 4, start ? WaypointKind::weld_start : end ? WaypointKind::weld_end : WaypointKind::weld);
            require(!(start || end) || i.arguments[i.arguments.size() - 2].name == "fine", i.place,
                    "zone fine where the arc starts and ends");
            welding_ = !end;
        } else {
            require(i.arguments.empty() && i.options.empty(), i.place, "a known instruction");
            call(i.name, i.place, depth + 1);
        }
    }

    // Of a circular move the point on the way, then to-point and speed; then `names` of data, the last two zone and
    // tool.
    void move(const Instruction& i, const Module& m, std::size_t names, WaypointKind kind) {
        const bool circular = i.name.starts_with("movec") || i.name.starts_with("arcc");
        const std::size_t points = circular ? 2 : 1, arguments = points + 1 + names;
        require(i.arguments.size() == arguments, i.place, std::to_string(arguments) + " arguments");
        require(i.options.contains("wobj"), i.place, "\\WObj");
        for (const auto& [option, given] : i.options) {
            require(option == "wobj" || (option == "weave" && names == 4), i.place, "no option but \\WObj and \\Weave");
            require(!given.name.empty(), i.place, "the name of data behind \\" + option);
        }
        require(linear_free_ && joint_free_, i.place, "ConfL\\Off and ConfJ\\Off, since confdata is zero,");
        require(!circular || (object_frame_ && !targets.empty()), i.place, "CirPathMode and a point to start from");
        for (std::size_t k = points + 1; k < arguments; ++k) {
            require(!i.arguments[k].name.empty(), i.place, "the name of seam, weld, zone or tool data");
        }
        const double speed = numbers(resolve(i.arguments[points], m, i.place), 4, i.place)[0];
        for (std::size_t k = 0; k < points; ++k) {
            const bool via = k + 1 < points;
            Target target;
            target.move = via ? Move::via : circular ? Move::circular : i.name == "movej" ? Move::joint : Move::linear;
            target.at.kind = via && kind == WaypointKind::weld_end ? WaypointKind::weld : kind;
            target.at.speed_mm_s = speed;
            target.passed = !via && i.arguments[arguments - 2].name != "fine";
            set_pose(target.at, resolve(i.arguments[k], m, i.place), i.place);
            targets.push_back(target);
        }
    }

    // To-joint-point, speed, zone and tool: a jointtarget is [axes deg], [external axes].
    void axes(const Instruction& i, const Module& m) {
        require(i.arguments.size() == 4 && i.options.size() == 2, i.place, "4 arguments and 2 options");
        require(i.options.contains("noeoffs") && i.options.contains("wobj") && !i.options.at("wobj").name.empty(),
                i.place, "\\NoEOffs and \\WObj");
        require(i.arguments[2].name == "fine" && !i.arguments[3].name.empty(), i.place, "zone fine and a tool");
        const Value& target = resolve(i.arguments[0], m, i.place);
        require(target.items.size() == 2, i.place, "a jointtarget of two parts");
        const std::vector<double> q = numbers(target.items[0], 6, i.place);
        no_external_axes(target.items[1], i.place);
        targets.push_back(axes_target({q[0], q[1], q[2], q[3], q[4], q[5]}));
        targets.back().at.speed_mm_s = numbers(resolve(i.arguments[1], m, i.place), 4, i.place)[0];
    }

    static void no_external_axes(const Value& axes, const Scanner& place) {
        for (const double axis : numbers(axes, 6, place)) {
            require(axis == 9e9, place, "9E9 for an external axis that is not there");
        }
    }

    static const Value& resolve(const Value& given, const Module& m, const Scanner& place) {
        if (given.name.empty()) {
            return given;
        }
        const auto found = m.data.find(given.name);
        require(found != m.data.end(), place, "data " + given.name + " declared in this module");
        return found->second;
    }

    static std::vector<double> numbers(const Value& aggregate, std::size_t count, const Scanner& place) {
        std::vector<double> result;
        for (const Value& item : aggregate.items) {
            result.push_back(item.number);
            require(std::isfinite(item.number), place, "numbers in an aggregate");
        }
        require(result.size() == count, place, std::to_string(count) + " numbers in an aggregate");
        return result;
    }

    // robtarget: [trans x, y, z mm], [rot q1..q4 = w, x, y, z], [confdata], [external axes, 9E9 where there is none]
    static void set_pose(Waypoint& w, const Value& robtarget, const Scanner& place) {
        require(robtarget.items.size() == 4, place, "a robtarget of four parts");
        const std::vector<double> trans = numbers(robtarget.items[0], 3, place);
        const std::vector<double> rot = numbers(robtarget.items[1], 4, place);
        numbers(robtarget.items[2], 4, place);
        no_external_axes(robtarget.items[3], place);
        w.p = {trans[0], trans[1], trans[2]};
        w.q = Eigen::Quaterniond(rot[0], rot[1], rot[2], rot[3]);
        require(std::abs(w.q.norm() - 1) < 1e-7, place, "a normalised quaternion");
        w.q.normalize();
    }

    std::vector<Module> modules_;
    bool welding_ = false;
    bool linear_free_ = false;
    bool joint_free_ = false;
    bool object_frame_ = false;
};

}  // namespace abb_reader

std::vector<Target> read_abb(const std::vector<TextFile>& files) {
    return abb_reader::Controller(files).targets;
}

}  // namespace seampath::exporting
