#include "tests/accuracy/common_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/grid.hpp"

namespace seampath {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

/// Of each view, the points that it has on one flank beside a seam.
using Counts = std::vector<double>;

std::size_t view_of(const Dataset& dataset, std::size_t point) {
    const auto after = std::upper_bound(dataset.views.begin(), dataset.views.end(), point,
                                        [](std::size_t i, const DatasetView& v) { return i < v.first_point; });
    return static_cast<std::size_t>(after - dataset.views.begin()) - 1;
}

/// Points of both flanks, 2 to 10 mm from the seam.
std::array<Counts, 2> counts_beside(const Dataset& dataset, const PointGrid& grid, const TruthSeam& seam) {
    constexpr double kNear = 2, kFar = 10, kOff = 0.3, kSlab = 1;
    constexpr std::size_t kStride = 20;  // of the truth's samples, 0.1 mm apart
    std::array<Counts, 2> counts{Counts(dataset.views.size(), 0), Counts(dataset.views.size(), 0)};
    for (std::size_t i = 0; i < seam.points.size(); i += kStride) {
        const TruthPoint& at = seam.points[i];
        const Vector3d reach = Vector3d::Constant(kFar);
        grid.for_cells_in_box(at.p - reach, at.p + reach, [&](std::size_t cell) {
            for (std::size_t k = 0; k < grid.points(cell).size(); ++k) {
                const Vector3d v = grid.points(cell)[k].cast<double>() - at.p;
                const double along = v.dot(at.tangent);
                if (std::abs(along) > kSlab) {
                    continue;
                }
                const Vector3d across = v - along * at.tangent;
                for (const std::size_t flank : {0u, 1u}) {
                    const double off = across.dot(flank == 0 ? at.n1 : at.n2), away = across.norm();
                    if (std::abs(off) < kOff && away > kNear && away < kFar) {
                        counts[flank][view_of(dataset, grid.source(grid.first_point(cell) + k))] += 1;
                    }
                }
            }
        });
    }
    return counts;
}

/// Mean of the errors of the views that see more than strays of what they see.
Affine3d mean_error(const Dataset& dataset, const Counts& counts) {
    constexpr double kLeast = 0.05;  // of what the best view sees
    const double most = *std::max_element(counts.begin(), counts.end());
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    double views = 0;
    for (std::size_t v = 0; v < counts.size(); ++v) {
        if (counts[v] > 0 && counts[v] >= kLeast * most) {
            sum += dataset.views[v].error.matrix();
            views += 1;
        }
    }
    return views > 0 ? Affine3d(sum / views) : Affine3d::Identity();
}

/// How the seam moves across itself where its flanks move by these errors.
Vector3d moved_by(const TruthPoint& at, const std::array<Affine3d, 2>& error) {
    constexpr double kMeet = 0.2;  // sine of the angle between flanks that meet
    const Vector3d by[2] = {error[0] * at.p - at.p, error[1] * at.p - at.p};
    if (at.n1.cross(at.n2).norm() < kMeet) {
        const Vector3d mean = 0.5 * (by[0] + by[1]);
        return mean - mean.dot(at.tangent) * at.tangent;
    }
    Eigen::Matrix3d rows;
    rows << at.n1.transpose(), at.n2.transpose(), at.tangent.transpose();
    return rows.partialPivLu().solve(Vector3d(at.n1.dot(by[0]), at.n2.dot(by[1]), 0));
}

}  // namespace

Truth moved_with_views(const Dataset& dataset) {
    constexpr double kCell = 2;  // mm
    std::vector<std::uint8_t> measured(dataset.points.size());
    std::transform(dataset.points.begin(), dataset.points.end(), measured.begin(),
                   [](const Eigen::Vector3f& p) { return p.allFinite(); });
    const PointGrid grid(dataset.points, kCell, measured);
    Truth moved = dataset.truth;
    for (TruthSeam& seam : moved.seams) {
        const auto counts = counts_beside(dataset, grid, seam);
        const std::array<Affine3d, 2> error{mean_error(dataset, counts[0]), mean_error(dataset, counts[1])};
        for (TruthPoint& point : seam.points) {
            point.p += moved_by(point, error);
        }
    }
    return moved;
}

double common_error(const Truth& truth, const Truth& moved) {
    double squares = 0, points = 0;
    for (std::size_t s = 0; s < truth.seams.size(); ++s) {
        for (std::size_t i = 0; i < truth.seams[s].points.size(); ++i) {
            squares += (moved.seams[s].points[i].p - truth.seams[s].points[i].p).squaredNorm();
            points += 1;
        }
    }
    return points > 0 ? std::sqrt(squares / points) : 0;
}

}  // namespace seampath
