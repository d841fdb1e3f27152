#include "stages/extract/joint.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "stages/geometry/flank_surface.hpp"

namespace seampath::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

using Shifts = std::map<std::uint32_t, Vector3d>;  ///< of the views, mm

/// A flank whose points have been moved back by their views' shifts, as far as these are known.
struct JointFlank {
    std::vector<Vector3d> points;
    std::optional<SurfaceFit> surface;
    double variance = 0;  ///< of a point, for the purpose of a fit over all of them, mm^2
};

// A point's distance d from the surface after a step x of its parameters, moved back by the shift b of its view, is
// d + row.x - n.b. Sums over the points, in their variances, of the squares of that.
struct View {
    MatrixXd row_n;  ///< of all parameters by the shift's axes
    Eigen::Matrix3d n_n = Eigen::Matrix3d::Zero();
    Vector3d d_n = Vector3d::Zero();
};
struct Sums {
    MatrixXd row_row;
    VectorXd row_d;
    std::map<std::uint32_t, View> view;
};

int parameters(const JointFlank& flank) {
    return flank.surface ? flank.surface->parameters() : 0;
}

// Noise as large as the blocks of points say it is.
double variance_of(const SurfaceFit& surface, const std::vector<Vector3d>& points) {
    SurfaceFit::Matrix normal = SurfaceFit::Matrix::Zero(surface.parameters(), surface.parameters());
    for (const Vector3d& p : points) {
        const SurfaceFit::Vector row = surface.row(p);
        normal += surface.weight(p) * row * row.transpose();
    }
    return (normal * surface.covariance()).trace() / surface.parameters();
}

Sums sums_of(const std::array<JointFlank, 2>& flanks, const std::array<PooledFlank, 2>& pooled) {
    const int all = parameters(flanks[0]) + parameters(flanks[1]);
    Sums sums{MatrixXd::Zero(all, all), VectorXd::Zero(all), {}};
    int first = 0;
    for (const std::size_t k : {0u, 1u}) {
        const int n = parameters(flanks[k]);
        for (std::size_t i = 0; n > 0 && i < flanks[k].points.size(); ++i) {
            const Vector3d& p = flanks[k].points[i];
            const SurfaceFit& surface = *flanks[k].surface;
            const double w = surface.weight(p) / flanks[k].variance, side = surface.bore() ? -1 : 1;
            if (w > 0) {
                const SurfaceFit::Vector row = surface.row(p);
                const Vector3d normal = side * surface.normal(p);
                const double d = side * surface.distance(p);
                View& view = sums.view.try_emplace(pooled[k].pool->view[i], View{MatrixXd::Zero(all, 3)}).first->second;
                sums.row_row.block(first, first, n, n) += w * row * row.transpose();
                sums.row_d.segment(first, n) += w * d * row;
                view.row_n.middleRows(first, n) += w * row * normal.transpose();
                view.n_n += w * normal * normal.transpose();
                view.d_n += w * d * normal;
            }
        }
        first += n;
    }
    return sums;
}

/// The most likely step of all parameters, their covariance, and the shifts that go with it, `known` ones included.
struct Solution {
    VectorXd step;
    MatrixXd covariance;
    Shifts shifts;
};

// Shifts are eliminated view by view.
Solution solve(const Sums& sums, double registration, const Shifts& known) {
    const double prior = 1 / (registration * registration);
    MatrixXd A = sums.row_row;
    VectorXd right = -sums.row_d;
    const auto shift_equation = [&](std::uint32_t id, const View& view) {
        const auto found = known.find(id);
        const Vector3d given = found == known.end() ? Vector3d::Zero() : found->second;
        return std::pair(Eigen::Matrix3d(view.n_n + prior * Eigen::Matrix3d::Identity()).ldlt(),
                         Vector3d(view.d_n - prior * given));
    };
    for (const auto& [id, view] : sums.view) {
        const auto [D, q] = shift_equation(id, view);
        A -= view.row_n * D.solve(view.row_n.transpose());
        right += view.row_n * D.solve(q);
    }
    const Eigen::LDLT<MatrixXd> ldlt(A);
    Solution solution{ldlt.solve(right), ldlt.solve(MatrixXd::Identity(A.rows(), A.rows())), known};
    for (const auto& [id, view] : sums.view) {
        const auto [D, q] = shift_equation(id, view);
        const Vector3d more = D.solve(q + view.row_n.transpose() * solution.step);
        solution.shifts.try_emplace(id, Vector3d::Zero()).first->second += more;
    }
    return solution;
}

std::optional<SurfaceFit> refitted(const SurfaceFit& surface, const std::vector<Vector3d>& points,
                                   const FlankPool& pool, double least_scale) {
    return std::holds_alternative<Plane>(surface.shape())
               ? fit_plane(points, pool.block, pool.normals.front(), least_scale)
               : fit_cylinder(points, pool.block, pool.places, pool.normals, least_scale);
}

// The flanks with their views moved back: their noise is then noise alone.
std::array<JointFlank, 2> moved_back(const std::array<PooledFlank, 2>& pooled, const Shifts& shifts,
                                     double least_scale) {
    std::array<JointFlank, 2> flanks;
    for (const std::size_t k : {0u, 1u}) {
        if (pooled[k].surface == nullptr) {
            continue;
        }
        const FlankPool& pool = *pooled[k].pool;
        for (std::size_t i = 0; i < pool.points.size(); ++i) {
            const auto shift = shifts.find(pool.view[i]);
            flanks[k].points.push_back(shift == shifts.end() ? pool.points[i]
                                                             : Vector3d(pool.points[i] - shift->second));
        }
        flanks[k].surface = *pooled[k].surface;
        if (!shifts.empty()) {
            if (auto again = refitted(*pooled[k].surface, flanks[k].points, pool, least_scale)) {
                flanks[k].surface = std::move(again);
            }
        }
        flanks[k].variance = variance_of(*flanks[k].surface, flanks[k].points);
    }
    return flanks;
}

}  // namespace

SeamSurfaces joint_surfaces(const std::array<PooledFlank, 2>& pooled, double registration, double least_scale) {
    std::array<JointFlank, 2> flanks = moved_back(pooled, {}, least_scale);
    const int n[2] = {parameters(flanks[0]), parameters(flanks[1])}, all = n[0] + n[1];
    VectorXd step = VectorXd::Zero(all);
    MatrixXd covariance = MatrixXd::Zero(all, all);
    if (registration > 0 && all > 0) {
        Solution solution = solve(sums_of(flanks, pooled), registration, {});
        // A surface that does not explain its points would pass what it is off for shifts.
        if (pooled[0].explains && pooled[1].explains) {
            flanks = moved_back(pooled, solution.shifts, least_scale);
            solution = solve(sums_of(flanks, pooled), registration, solution.shifts);
        }
        step = solution.step;
        covariance = solution.covariance;
    } else {
        for (const int k : {0, 1}) {
            if (n[k] > 0) {
                covariance.block(k == 0 ? 0 : n[0], k == 0 ? 0 : n[0], n[k], n[k]) =
                    flanks[static_cast<std::size_t>(k)].surface->covariance();
            }
        }
    }
    SeamSurfaces surfaces;
    for (const std::size_t k : {0u, 1u}) {
        if (flanks[k].surface) {
            const int first = k == 0 ? 0 : n[0];
            const SurfaceFit& fit = *flanks[k].surface;
            const SurfaceFit moved(fit.moved(step.segment(first, n[k])), fit.bore(), fit.frame(), fit.covariance(),
                                   fit.scale(), fit.share_taken());
            auto& plain = k == 0 ? surfaces.first : surfaces.second;
            plain = flank_surface(moved, covariance.block(first, first, n[k], n[k]));
            plain->explains = pooled[k].explains;
        }
    }
    if (n[0] > 0 && n[1] > 0) {
        surfaces.covariance_between = rows_of(covariance.topRightCorner(n[0], n[1]));
    }
    return surfaces;
}

}  // namespace seampath::detail
