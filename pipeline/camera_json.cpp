#include "pipeline/camera_json.hpp"

#include <algorithm>
#include <cmath>

#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr double kLeastPlaneDistance = 1;  // mm from the camera; sensors have at least tens

}  // namespace

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = JsonObject::Json;

Isometry3d pose_from(const JsonObject& object, const char* key) {
    constexpr double kUnitTolerance = 1e-3;
    Isometry3d pose = Isometry3d::Identity();
    const std::vector<double> v = object.numbers(key, 7);
    if (v.empty()) {
        return pose;
    }
    const Eigen::Quaterniond q(v[3], v[4], v[5], v[6]);
    if (std::abs(q.norm() - 1) > kUnitTolerance) {
        object.complain(key, "its quaternion w, x, y, z has the length " + shortest(q.norm()) + "; 1 was needed");
        return pose;
    }
    pose.translation() = Vector3d(v[0], v[1], v[2]);
    pose.linear() = q.normalized().toRotationMatrix();
    return pose;
}

Json pose_numbers(const Isometry3d& pose) {
    const Vector3d p = pose.translation();
    const Eigen::Quaterniond q(pose.linear());
    return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

CameraModel camera_from(const Json& value, const std::string& place, std::vector<std::string>& problems) {
    constexpr double kMostPixels = 32768;
    CameraModel camera;
    const JsonObject object(value, place, problems, {"size_px", "matrix_px", "distortion"});
    const auto size = object.numbers("size_px", 2);
    const auto whole = [](double v) { return v >= 1 && v <= kMostPixels && v == std::floor(v); };
    if (!size.empty() && whole(size[0]) && whole(size[1])) {
        camera.width = static_cast<int>(size[0]);
        camera.height = static_cast<int>(size[1]);
    } else if (!size.empty()) {
        object.complain("size_px", "is " + shortest(size[0]) + " x " + shortest(size[1]) +
                                       "; whole numbers of pixels from 1 to 32768 were needed");
    }
    const Json& matrix = object.member("matrix_px");
    std::vector<double> m;
    for (std::size_t row = 0; matrix.is_array() && row < matrix.size(); ++row) {
        const auto numbers = object.numbers_of(matrix[row], "matrix_px/" + std::to_string(row), 3);
        m.insert(m.end(), numbers.begin(), numbers.end());
    }
    if (m.size() == 9 && m[0] > 0 && m[4] > 0 && m[1] == 0 && m[3] == 0 && m[6] == 0 && m[7] == 0 && m[8] == 1) {
        camera.focal_px = {m[0], m[4]};
        camera.centre_px = {m[2], m[5]};
    } else if (object.has("matrix_px")) {
        object.complain("matrix_px", "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with focal lengths above 0 was needed");
    }
    if (object.has("distortion")) {
        const auto d = object.numbers("distortion", 5);
        std::copy(d.begin(), d.end(), camera.distortion.begin());
    }
    return camera;
}

Json camera_json(const CameraModel& c) {
    return {{"size_px", {c.width, c.height}},
            {"matrix_px", {{c.focal_px.x(), 0, c.centre_px.x()}, {0, c.focal_px.y(), c.centre_px.y()}, {0, 0, 1}}},
            {"distortion", c.distortion}};
}

LaserPlane plane_from(const Json& value, const std::string& place, std::vector<std::string>& problems) {
    LaserPlane plane;
    const JsonObject object(value, place, problems, {"normal", "distance_mm"});
    const auto n = object.numbers("normal", 3);
    plane.distance_mm = object.number("distance_mm");
    if (!n.empty()) {
        const Vector3d normal(n[0], n[1], n[2]);
        if (normal.norm() < 1e-9) {
            object.complain("normal", "has no direction; a vector across the laser's plane was needed");
            return plane;
        }
        plane.normal = normal.normalized();
        plane.distance_mm /= normal.norm();
    }
    if (object.has("distance_mm") && !(std::abs(plane.distance_mm) >= kLeastPlaneDistance)) {
        object.complain("distance_mm", "the laser's plane passes the camera at " + fixed(plane.distance_mm, 3) +
                                           " mm, so that a picture shows no heights; 1 mm or more was needed; "
                                           "calibrate the laser again");
    }
    return plane;
}

Json plane_json(const LaserPlane& plane) {
    const Vector3d& n = plane.normal;
    return {{"normal", {n.x(), n.y(), n.z()}}, {"distance_mm", plane.distance_mm}};
}

}  // namespace seampath
