#include <array>

#include "stages/calibrate/calibrate.hpp"
#include "stages/calibrate/frame_quality.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

FrameRow row_of(const FramePoint& point, const Vector3d& normal) {
    return {normal, normal.dot(point.nominal), point.measured, std::sqrt(point.covariance.trace() / 3)};
}

}  // namespace

std::vector<FrameFeature> three_point_features(const std::vector<std::string>& names,
                                               const std::vector<FramePoint>& points) {
    if (points.size() < 3) {
        throw InputError("calibrate: " + std::to_string(points.size()) +
                         " points; three were needed (origin, along X, in the plane of X and Y), and more to check");
    }
    const Vector3d along = points[1].nominal - points[0].nominal,
                   up = along.cross(points[2].nominal - points[0].nominal);
    if (!(up.norm() > 1e-6 * along.squaredNorm()) || !(along.norm() > 0)) {
        throw InputError("calibrate: the nominal points " + names[0] + ", " + names[1] + " and " + names[2] +
                         " lie on one line; three that span a plane were needed");
    }
    const Vector3d X = along.normalized(), Z = up.normalized(), Y = Z.cross(X);
    std::vector<FrameFeature> features{{names[0], 0, false, {points[0]}, {}},
                                       {names[1], 1, false, {}, {row_of(points[1], Y), row_of(points[1], Z)}},
                                       {names[2], 2, false, {}, {row_of(points[2], Z)}}};
    for (std::size_t i = 3; i < points.size(); ++i) {
        features.push_back({names[i], 0, true, {points[i]}, {}});
    }
    return features;
}

FrameResult calibrate_planes(const std::vector<DatumPlane>& planes, const std::vector<WorkPoint>& work_points,
                             const FrameOptions& options) {
    constexpr std::array<std::size_t, 3> kNeeded{3, 2, 1};
    if (planes.size() != kNeeded.size()) {
        throw InputError("calibrate: " + std::to_string(planes.size()) +
                         " datum planes; three in the order of their precedence were needed");
    }
    if (!(std::abs(planes[0].normal.dot(planes[1].normal.cross(planes[2].normal))) > 0.1)) {
        throw InputError("calibrate: the datum planes " + planes[0].name + ", " + planes[1].name + " and " +
                         planes[2].name + " do not stand across each other; planes that meet in a corner were needed");
    }
    std::vector<FrameFeature> features;
    std::vector<Vector3d> nominal, measured;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const DatumPlane& plane = planes[i];
        if (plane.touched.size() < kNeeded[i]) {
            throw InputError("calibrate: datum plane " + plane.name + " has " + std::to_string(plane.touched.size()) +
                             " points; at least " + std::to_string(kNeeded[i]) + " were needed");
        }
        FrameFeature feature{plane.name, static_cast<int>(i), false, {}, {}};
        for (const TouchedPoint& touched : plane.touched) {
            feature.rows.push_back({plane.normal, plane.offset_mm, touched.measured, touched.sigma_mm});
            nominal.push_back(touched.nominal);
            measured.push_back(touched.measured);
        }
        features.push_back(std::move(feature));
    }
    return calibrate_frame(features, work_points, options, rigid_through(nominal, measured));
}

}  // namespace seampath
