#include <algorithm>
#include <string>
#include <utility>

#include "stages/export/text.hpp"

/// waypoints.json: a head with frame, units and quaternion order, then the waypoints with the columns of waypoints.csv.
/// Numbers are in their shortest exact form, so nothing is rounded.
namespace seampath::exporting {
namespace json_format {

std::string pair(std::string_view key, const std::string& value) {
    return "\"" + std::string(key) + "\":" + value;
}
std::string pair(std::string_view key, double value) {
    return pair(key, shortest(value));
}
std::string quote(std::string_view text) {
    return "\"" + std::string(text) + "\"";
}

std::string object(const Waypoint& w) {
    return "{" + pair("seam", std::to_string(w.seam)) + "," + pair("index", std::to_string(w.index)) + "," +
           pair("kind", quote(name(w.kind))) + "," + pair("station_mm", w.station_mm) + "," + pair("x", w.p.x()) + "," +
           pair("y", w.p.y()) + "," + pair("z", w.p.z()) + "," + pair("qw", w.q.w()) + "," + pair("qx", w.q.x()) + "," +
           pair("qy", w.q.y()) + "," + pair("qz", w.q.z()) + "," + pair("speed_mm_s", w.speed_mm_s) + "," +
           pair("time_s", w.time_s) + "," + pair("sigma_mm", w.sigma_mm) + "}";
}

// As much of JSON (RFC 8259) as the file needs: objects, arrays, numbers, and strings without escapes.
struct Value {
    double number = 0;
    std::string text;
    std::vector<Value> items;        // of an array or an object
    std::vector<std::string> names;  // of an object's items
};

Value value(Scanner& scan) {
    Value result;
    if (scan.accept('{')) {
        for (bool more = !scan.accept('}'); more;) {
            result.names.push_back(scan.quoted());
            scan.expect(':');
            result.items.push_back(value(scan));
            more = scan.accept(',');
            if (!more) {
                scan.expect('}');
            }
        }
    } else if (scan.accept('[')) {
        for (bool more = !scan.accept(']'); more;) {
            result.items.push_back(value(scan));
            more = scan.accept(',');
            if (!more) {
                scan.expect(']');
            }
        }
    } else if (scan.at_quote()) {
        result.text = scan.quoted();
    } else {
        result.number = scan.number();
    }
    return result;
}

class Reader {
public:
    explicit Reader(const Scanner& scan) : scan_(scan) {}

    const Value& member(const Value& object, std::string_view key) const {
        const auto name = std::find(object.names.begin(), object.names.end(), key);
        if (name == object.names.end()) {
            scan_.fail("a member \"" + std::string(key) + "\" before this place");
        }
        return object.items[static_cast<std::size_t>(name - object.names.begin())];
    }
    double number(const Value& object, std::string_view key) const { return member(object, key).number; }
    void require(const Value& object, std::string_view key, std::string_view text) const {
        if (member(object, key).text != text) {
            scan_.fail("\"" + std::string(key) + "\" being " + std::string(text) + " before this place");
        }
    }
    Waypoint waypoint(const Value& object) const {
        Waypoint w;
        w.seam = static_cast<int>(number(object, "seam"));
        w.index = static_cast<int>(number(object, "index"));
        const auto kind = std::find(kWaypointKindNames.begin(), kWaypointKindNames.end(), member(object, "kind").text);
        if (kind == kWaypointKindNames.end()) {
            scan_.fail("a known \"kind\" before this place");
        }
        w.kind = static_cast<WaypointKind>(kind - kWaypointKindNames.begin());
        w.station_mm = number(object, "station_mm");
        w.p = {number(object, "x"), number(object, "y"), number(object, "z")};
        w.q =
            Eigen::Quaterniond(number(object, "qw"), number(object, "qx"), number(object, "qy"), number(object, "qz"));
        w.speed_mm_s = number(object, "speed_mm_s");
        w.time_s = number(object, "time_s");
        w.sigma_mm = number(object, "sigma_mm");
        return w;
    }

private:
    const Scanner& scan_;
};

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    const Plan& in_base = program.plan;
    std::string text = "{\n";
    text += pair("format", quote("seampath waypoints")) + ",\n";
    text += pair("frame", quote("robot base")) + ",\n";
    text += pair("base_from_scan", "[" + list(options.base_from_scan, ",") + "]") + ",\n";
    for (const auto& [key, sigma] : {std::pair{"base_from_scan_sigma_mm", options.base_from_scan_sigma_mm},
                                     std::pair{"base_from_scan_sigma_deg", options.base_from_scan_sigma_deg}}) {
        text += sigma ? pair(key, *sigma) + ",\n" : "";
    }
    text += pair("units", "{" + pair("length", quote("mm")) + "," + pair("speed", quote("mm/s")) + "," +
                              pair("time", quote("s")) + "}") +
            ",\n";
    text += pair("quaternion_order", quote("qw,qx,qy,qz")) + ",\n";
    text += pair("tool", quote("+Z along the torch into the joint, +X along travel")) + ",\n";
    text += pair("max_chord_error_mm", in_base.max_chord_error_mm) + ",\n";
    text += pair("duration_s", in_base.duration_s) + ",\n";
    text += pair("waypoints", "[\n");
    for (const Target& target : program.targets) {
        text += object(target.at) + (&target == &program.targets.back() ? "\n" : ",\n");
    }
    return {{"waypoints.json", text + "]\n}\n"}};
}

std::vector<Target> read(const std::vector<TextFile>& files) {
    Scanner scan(files.at(0), '\0');
    const Value root = value(scan);
    if (!scan.done()) {
        scan.fail("the end of the file");
    }
    const Reader reader(scan);
    reader.require(root, "format", "seampath waypoints");
    reader.require(root, "frame", "robot base");
    reader.require(root, "quaternion_order", "qw,qx,qy,qz");
    const Value& units = reader.member(root, "units");
    reader.require(units, "length", "mm");
    reader.require(units, "speed", "mm/s");
    reader.require(units, "time", "s");
    std::vector<Target> targets;
    for (const Value& object : reader.member(root, "waypoints").items) {
        targets.push_back({reader.waypoint(object)});
    }
    return targets;
}

}  // namespace json_format

constinit const Format kJson{"json",
                             0,
                             kAnywhere,
                             0,
                             false,
                             false,
                             Axes::none,
                             true,
                             tells_everything,
                             no_problems,
                             json_format::write,
                             json_format::read};

}  // namespace seampath::exporting
