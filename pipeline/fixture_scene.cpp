#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "pipeline/fixture_page.hpp"
#include "pipeline/report_thin.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kHolds95 = 2.7955;   // 1-sigma to what holds 95 % of a Gaussian in space
constexpr double kDrawnReach = 0.14;  // of the scene's radius, for the longest of arrows and half axes
constexpr double kScanReach = 1.6;    // of the radius about the features: more of the scan is not shown

// The largest of 1, 2 or 5 times a power of ten that keeps `longest` within `reach`; 1 when nothing is longer than 0.
double times_for(double longest, double reach) {
    if (!(longest > 0)) {
        return 1;
    }
    const double wanted = reach / longest, power = std::pow(10, std::floor(std::log10(wanted)));
    return power * (wanted / power >= 5 ? 5 : wanted / power >= 2 ? 2 : 1);
}

Scan in_part_frame(const Scan& scan, const Isometry3d& base_from_part, const Vector3d& centre, double reach) {
    const Isometry3d back = base_from_part.inverse();
    Scan moved;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Vector3d p = back * scan.position(i);
        if ((p - centre).norm() < reach) {
            moved.points.push_back(p.cast<float>());
        }
    }
    return moved;
}

Matrix3d half_axes_of(const Matrix3d& covariance) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(covariance);
    return kHolds95 * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

void set_frame(const FrameResult& r, ViewScene& scene) {
    Eigen::AlignedBox3d box;
    for (const FeatureResult& f : r.features) {
        box.extend(f.place);
    }
    for (const WorkPointResult& w : r.work_points) {
        box.extend(w.p);
    }
    if (!box.isEmpty()) {
        scene.centre = box.center();
        scene.radius_mm = std::max(box.diagonal().norm() / 2, 1.0);
    }
    // From above a corner of the part's own axes.
    scene.camera.toward = Vector3d(0.45, -0.75, 0.5).normalized();
    scene.camera.up = (Vector3d::UnitZ() - scene.camera.toward.z() * scene.camera.toward).normalized();
}

}  // namespace

FixtureScene fixture_scene(const FixtureCalibration& c) {
    const FrameResult& r = c.frame;
    FixtureScene result;
    ViewScene& scene = result.scene;
    set_frame(r, scene);
    if (c.scan) {
        scene.clouds = thin_scan(in_part_frame(*c.scan, r.base_from_part, scene.centre, kScanReach * scene.radius_mm),
                                 {}, scene.centre);
    }
    const double reach = kDrawnReach * scene.radius_mm;
    double shift = 0, spread = 0;
    for (const FeatureResult& f : r.features) {
        shift = std::max(shift, f.shift_mm.norm());
    }
    std::vector<Matrix3d> axes;
    for (const WorkPointResult& w : r.work_points) {
        const Matrix3d R = r.base_from_part.linear();
        axes.push_back(half_axes_of(R.transpose() * w.covariance * R));
        spread = std::max(spread, axes.back().colwise().norm().maxCoeff());
    }
    result.arrows_times = times_for(shift, reach);
    result.ellipsoids_times = times_for(spread, reach);
    for (const FeatureResult& f : r.features) {
        const bool moved = std::find(r.moved.begin(), r.moved.end(), f.name) != r.moved.end();
        scene.marks.push_back(
            {f.name + " · residual " + fixed(f.residual_mm, 4) + " mm, " + fixed(f.residual_sigma, 1) + " σ",
             f.place - scene.centre, result.arrows_times * f.shift_mm, !moved});
    }
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const WorkPointResult& w = r.work_points[i];
        // What is flat or a line still has a body to look at.
        const double least = 2e-3 * scene.radius_mm;
        Matrix3d drawn = result.ellipsoids_times * axes[i];
        for (Eigen::Index k = 0; k < 3; ++k) {
            const double length = drawn.col(k).norm();
            const Vector3d along = length > 0 ? Vector3d(drawn.col(k) / length) : Vector3d(Vector3d::Unit(k));
            drawn.col(k) = std::max(length, least) * along;
        }
        scene.ellipsoids.push_back({w.name + " · 95 % within " + fixed(w.expanded_mm, 4) + " mm", w.p - scene.centre,
                                    drawn, w.expanded_mm <= c.nominal.frame.limit_mm});
    }
    return result;
}

}  // namespace seampath
