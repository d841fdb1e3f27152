#include "tools/pose_table.hpp"

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/geometry/rigid.hpp"
#include "stages/text.hpp"
#include "tools/table.hpp"

namespace seampath {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Names = std::vector<std::string>;

/// Columns of the header by name.
class PoseColumns {
public:
    PoseColumns(const Table& table, std::string file) : header_(table.header), file_(std::move(file)) {}

    bool has(const Names& names) const {
        return std::all_of(names.begin(), names.end(), [&](const auto& name) { return find(name) < header_.size(); });
    }
    std::vector<double> of(const std::vector<double>& row, const Names& names) const {
        std::vector<double> values;
        for (const auto& name : names) {
            values.push_back(row[find(name)]);
        }
        return values;
    }
    [[noreturn]] void refuse(const std::string& what) const { throw InputError("tcp: " + file_ + ": " + what); }

    std::size_t find(const std::string& name) const {
        return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), name) - header_.begin());
    }

private:
    const Names& header_;
    std::string file_;
};

const Names kMillimetres{"x_mm", "y_mm", "z_mm"}, kMetres{"x_m", "y_m", "z_m"};
const Names kQuaternion{"qw", "qx", "qy", "qz"}, kVector{"rx_rad", "ry_rad", "rz_rad"};
const Names kKuka{"a_deg", "b_deg", "c_deg"}, kFanuc{"w_deg", "p_deg", "r_deg"};

Quaterniond rotation_of(const PoseColumns& header, const std::vector<double>& row, std::size_t line) {
    constexpr double kUnitTolerance = 1e-3;
    if (header.has(kQuaternion)) {
        const auto v = header.of(row, kQuaternion);
        const Quaterniond q(v[0], v[1], v[2], v[3]);
        if (std::abs(q.norm() - 1) > kUnitTolerance) {
            header.refuse("line " + std::to_string(line) + ": the quaternion qw, qx, qy, qz has the length " +
                          shortest(q.norm()) + "; 1 was needed");
        }
        return q.normalized();
    }
    if (header.has(kVector)) {
        const auto v = header.of(row, kVector);
        return turn_by(Vector3d(v[0], v[1], v[2]));
    }
    const auto v = header.of(row, header.has(kKuka) ? kKuka : kFanuc);
    return header.has(kKuka) ? from_euler_zyx(kDegree * v[0], kDegree * v[1], kDegree * v[2])
                             : from_euler_zyx(kDegree * v[2], kDegree * v[1], kDegree * v[0]);
}

}  // namespace

RobotMeasurement read_pose_table(const std::filesystem::path& file) {
    const Table table = read_table(file);
    const PoseColumns header(table, file.string());
    const int rotations = header.has(kQuaternion) + header.has(kVector) + header.has(kKuka) + header.has(kFanuc);
    if (header.has(kMillimetres) == header.has(kMetres) || rotations != 1) {
        header.refuse(
            "its header does not say what the poses are; x_mm,y_mm,z_mm or x_m,y_m,z_m and one of qw,qx,qy,qz, "
            "rx_rad,ry_rad,rz_rad, a_deg,b_deg,c_deg (KUKA) or w_deg,p_deg,r_deg (FANUC) were needed");
    }
    RobotMeasurement m;
    m.name = file.stem().string();
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        FlangePose pose{"pose " + std::to_string(i + 1), Eigen::Isometry3d::Identity()};
        const bool metres = header.has(kMetres);
        const auto p = header.of(table.rows[i], metres ? kMetres : kMillimetres);
        pose.base_from_flange.translation() = (metres ? 1000 : 1) * Vector3d(p[0], p[1], p[2]);
        pose.base_from_flange.linear() = rotation_of(header, table.rows[i], table.lines[i]).toRotationMatrix();
        m.tips.push_back(pose);
    }
    return m;
}

}  // namespace seampath
