#include <cmath>
#include <numbers>

#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/stripe/stripe.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::optional<Vector3d> point_in_plane(const CameraModel& camera, const LaserPlane& plane, const Vector2d& pixel) {
    const auto direction = direction_of(camera, pixel);
    const double depth = direction ? plane.distance_mm / plane.normal.dot(*direction) : 0;
    return depth > 0 && std::isfinite(depth) ? std::optional<Vector3d>(depth * *direction) : std::nullopt;
}

/// Of what the profile's own points say.
ProfileScale scale_of(const Profile& profile, const Stripe& stripe) {
    constexpr double kFwhm = 2.355;  // of a Gaussian, over its 1-sigma
    constexpr double kBand = 1.5;    // widths of the stripe
    std::vector<double> sigmas = profile.sigma_mm, widths, steps;
    for (const StripePoint& point : stripe.points) {
        widths.push_back(point.width_px);
    }
    for (std::size_t i = 0; i + 1 < profile.points.size(); ++i) {
        steps.push_back((profile.points[i + 1] - profile.points[i]).norm() /
                        std::max(1, profile.column[i + 1] - profile.column[i]));
    }
    const double width = quantile(widths, 0.5);
    // The Gaussian that the ridge was sought with spreads each pixel's noise along the stripe.
    return {quantile(sigmas, 0.5), std::max(1.0, std::sqrt(4 * std::numbers::pi) * width / kFwhm),
            kBand * width * quantile(steps, 0.5)};
}

/// Axes in the laser's plane: x to the right in the picture, y towards the camera.
struct PlaneAxes {
    Vector3d origin, x, y;
};

PlaneAxes axes_of(const Profile& profile, const LaserPlane& plane) {
    PlaneAxes axes;
    axes.origin = profile.points[profile.points.size() / 2];
    const Vector3d to_camera = -axes.origin;
    axes.y = (to_camera - plane.normal.dot(to_camera) * plane.normal).normalized();
    axes.x = axes.y.cross(plane.normal);
    axes.x *= axes.x.dot(profile.points.back() - profile.points.front()) < 0 ? -1 : 1;
    return axes;
}

std::vector<Vector2d> points_in(const PlaneAxes& axes, const Profile& profile) {
    std::vector<Vector2d> points;
    for (const Vector3d& p : profile.points) {
        points.emplace_back(axes.x.dot(p - axes.origin), axes.y.dot(p - axes.origin));
    }
    return points;
}

/// Middle of the points' box, to whole millimetres so that taking it off is exact.
Vector3d origin_of(const std::vector<Vector3d>& points) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : points) {
        box.extend(p);
    }
    return box.center().array().round();
}

}  // namespace

Profile triangulate(const Stripe& stripe, const CameraModel& camera, const LaserPlane& plane) {
    Profile profile;
    for (const StripePoint& point : stripe.points) {
        const auto p = point_in_plane(camera, plane, point.p);
        const auto above = point_in_plane(camera, plane, point.p - 0.5 * point.normal);
        const auto below = point_in_plane(camera, plane, point.p + 0.5 * point.normal);
        const int column = static_cast<int>(std::lround(point.p.x()));
        if (p && above && below && (profile.column.empty() || column > profile.column.back())) {
            profile.points.push_back(*p);
            profile.sigma_mm.push_back((*below - *above).norm() * point.sigma_px);
            profile.column.push_back(column);
        }
    }
    if (profile.points.size() > 1) {
        profile.scale = scale_of(profile, stripe);
    }
    return profile;
}

std::optional<ProfileSeamPoint> find_seam_point(const Profile& profile, const LaserPlane& plane, JointKind kind) {
    if (profile.points.size() < 2) {
        return std::nullopt;
    }
    const PlaneAxes axes = axes_of(profile, plane);
    const std::vector<Vector2d> points = points_in(axes, profile);
    const auto feature = find_feature({points, profile.sigma_mm}, profile.scale, kind);
    return feature ? std::optional(ProfileSeamPoint{axes.origin + feature->p.x() * axes.x + feature->p.y() * axes.y,
                                                    feature->sigma})
                   : std::nullopt;
}

StripeScan scan_of_profiles(std::span<const Profile> profiles, std::span<const Eigen::Isometry3d> base_from_camera,
                            int columns) {
    ensure(profiles.size() == base_from_camera.size(), "a pose a profile");
    StripeScan result;
    Scan& scan = result.scan;
    std::vector<Vector3d> points;
    Vector3d sensor(0, 0, 0);
    for (std::size_t i = 0; i < profiles.size(); ++i) {
        for (std::size_t k = 0; k < profiles[i].points.size(); ++k) {
            points.push_back(base_from_camera[i] * profiles[i].points[k]);
            result.sigma_mm.push_back(static_cast<float>(profiles[i].sigma_mm[k]));
            const int column = std::min(profiles[i].column[k], columns - 1);
            scan.pixel.push_back(static_cast<std::uint32_t>(i) * static_cast<std::uint32_t>(columns) +
                                 static_cast<std::uint32_t>(column));
        }
        sensor += base_from_camera[i].translation() / static_cast<double>(profiles.size());
    }
    scan.origin_mm = origin_of(points);
    for (const Vector3d& p : points) {
        scan.points.push_back((p - scan.origin_mm).cast<float>());
    }
    scan.width = static_cast<std::uint32_t>(columns);
    scan.height = static_cast<std::uint32_t>(profiles.size());
    scan.sensor_mm = sensor;
    scan.points_in_file = points.size();
    return result;
}

}  // namespace seampath
