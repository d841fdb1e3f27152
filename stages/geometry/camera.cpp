#include "stages/geometry/camera.hpp"

#include <cmath>

#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// The distorted point and its derivatives.
struct Distorted {
    Vector2d p;
    Matrix2d slope;
};

Distorted distorted(const std::array<double, 5>& d, const Vector2d& u) {
    const auto [k1, k2, p1, p2, k3] = d;
    const double x = u.x(), y = u.y(), r2 = x * x + y * y;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double per_r2 = k1 + r2 * (2 * k2 + r2 * 3 * k3);  // d radial / d r^2
    Distorted result;
    result.p = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)};
    const double mixed = 2 * x * y * per_r2 + 2 * p1 * x + 2 * p2 * y;
    result.slope << radial + 2 * x * x * per_r2 + 2 * p1 * y + 6 * p2 * x, mixed,  //
        mixed, radial + 2 * y * y * per_r2 + 2 * p2 * x + 6 * p1 * y;
    return result;
}

}  // namespace

Vector2d pixel_of(const CameraModel& camera, const Vector3d& p_in_camera) {
    const Vector2d p = distorted(camera.distortion, p_in_camera.head<2>() / p_in_camera.z()).p;
    return p.cwiseProduct(camera.focal_px) + camera.centre_px;
}

std::optional<Vector3d> direction_of(const CameraModel& camera, const Vector2d& pixel) {
    constexpr int kRounds = 20;
    constexpr double kExact = 1e-12;
    const Vector2d seen = (pixel - camera.centre_px).cwiseQuotient(camera.focal_px);
    Vector2d u = seen;
    for (int i = 0; i < kRounds; ++i) {
        const Distorted at = distorted(camera.distortion, u);
        const double det = at.slope(0, 0) * at.slope(1, 1) - at.slope(0, 1) * at.slope(1, 0);
        if (!(det > 0)) {
            return std::nullopt;  // the lens would show the same direction twice
        }
        const Vector2d off = seen - at.p;
        const Vector2d step(at.slope(1, 1) * off.x() - at.slope(0, 1) * off.y(),
                            at.slope(0, 0) * off.y() - at.slope(1, 0) * off.x());
        u += step / det;
        if (off.norm() < kExact) {
            return Vector3d(u.x(), u.y(), 1);
        }
    }
    return std::nullopt;
}

Vector3d point_on_plane(const CameraModel& camera, const Eigen::Isometry3d& camera_from_plane, const Vector2d& pixel) {
    constexpr double kLeastSine = 0.087;  // of 5 degrees
    const std::string place = "pixel (" + fixed(pixel.x(), 0) + ", " + fixed(pixel.y(), 0) + ")";
    const auto direction = direction_of(camera, pixel);
    if (!direction) {
        throw InputError("photo: the lens model has no direction for " + place +
                         "; one that holds over the whole picture was needed; calibrate the camera again");
    }
    const Vector3d normal = camera_from_plane.linear().col(2), origin = camera_from_plane.translation();
    const double towards = normal.dot(*direction), distance = normal.dot(origin);
    if (std::abs(towards) < kLeastSine * direction->norm()) {
        throw InputError("photo: at " + place + " the plane is seen edge-on, at " +
                         fixed(std::asin(std::abs(towards) / direction->norm()) * 57.29577951308232, 1) +
                         " deg; 5 deg or more were needed; photograph the joint from above");
    }
    if (distance / towards <= 0) {
        throw InputError("photo: at " + place + " the plane is not before the camera; check camera_from_plane");
    }
    return camera_from_plane.inverse() * (distance / towards * *direction);
}

bool is_seen_from_above(const Eigen::Isometry3d& camera_from_plane) {
    return camera_from_plane.linear().col(2).dot(camera_from_plane.translation()) < 0;
}

}  // namespace seampath
