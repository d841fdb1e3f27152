#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "stages/export/text.hpp"

/// Reads noether's YAML as its serialization does: paths of segments of poses, each member there. A path is a weld.
namespace seampath::exporting {
namespace noether_reader {

Target pose(Scanner& scan) {
    scan.expect('{');
    std::map<std::string, double> member;
    do {
        const std::string name = scan.name();
        scan.expect(':');
        if (!member.emplace(name, scan.decimal()).second) {
            scan.fail("each member once before this place");
        }
    } while (scan.accept(','));
    scan.expect('}');
    for (const char* name : {"x", "y", "z", "qw", "qx", "qy", "qz"}) {
        if (member.size() != 7 || !member.contains(name)) {
            scan.fail("members x, y, z, qw, qx, qy and qz before this place");
        }
    }
    Target target;
    target.at.p = 1000 * Eigen::Vector3d(member["x"], member["y"], member["z"]);
    target.at.q = Eigen::Quaterniond(member["qw"], member["qx"], member["qy"], member["qz"]);
    if (std::abs(target.at.q.norm() - 1) > 1e-9) {
        scan.fail("a unit quaternion before this place");
    }
    target.at.q.normalize();
    target.at.speed_mm_s = std::numeric_limits<double>::quiet_NaN();
    return target;
}

}  // namespace noether_reader

std::vector<Target> read_noether(const std::vector<TextFile>& files) {
    using namespace noether_reader;
    Scanner scan(files.at(0), '#');
    std::vector<Target> targets;
    scan.expect('[');
    do {
        scan.expect('[');
        scan.expect('[');
        const std::size_t first = targets.size();
        do {
            targets.push_back(pose(scan));
        } while (scan.accept(','));
        if (targets.size() < first + 2) {
            scan.fail("two poses or more before this place");
        }
        targets[first].at.kind = WaypointKind::weld_start;
        targets.back().at.kind = WaypointKind::weld_end;
        scan.expect(']');
        scan.expect(']');
    } while (scan.accept(','));
    scan.expect(']');
    if (!scan.done()) {
        scan.fail("the end of the file");
    }
    return targets;
}

}  // namespace seampath::exporting
