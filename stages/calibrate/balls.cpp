#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/calibrate/calibrate.hpp"
#include "stages/error.hpp"
#include "stages/geometry/grid.hpp"
#include "stages/geometry/least_squares.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMadToSigma = 1.4826;
constexpr double kTukey = 4.685;
// A patch as wide as this share of the radius tells a ball from its surroundings and still lies on its cap.
constexpr double kPatch = 0.7;
// What a patch's own radius may be off, as a share: noise bends a patch.
constexpr double kRadiusShare = 0.25;
constexpr double kRadiusShareWhole = 0.05;  // the same of all points of the ball together
constexpr std::size_t kFewest = 30;         // points of a patch
// A cap of less than this, as the share of the sphere that its cells cover, is no ball one can trust.
constexpr double kLeastCover = 0.12;

// Points within `reach` of p.
std::vector<Vector3d> around(const PointGrid& grid, const Vector3d& p, double reach) {
    std::vector<Vector3d> points;
    grid.for_points_in_ball(p, reach, [&](const Eigen::Vector3f& q, double) { points.push_back(q.cast<double>()); });
    return points;
}

// Points off a sphere by at most `thickness`.
std::vector<Vector3d> on_shell(const PointGrid& grid, const Vector3d& centre, double radius, double thickness) {
    std::vector<Vector3d> points = around(grid, centre, radius + thickness);
    std::erase_if(points, [&](const Vector3d& p) { return (p - centre).norm() < radius - thickness; });
    return points;
}

double robust_scale(const std::vector<Vector3d>& points, const Vector3d& centre, double radius) {
    std::vector<double> d;
    for (const auto& p : points) {
        d.push_back(std::abs((p - centre).norm() - radius));
    }
    return kMadToSigma * quantile(d, 0.5);
}

// Tukey's weights about a sphere of known radius; false when the points do not hold the centre. At the end H is the
// weighted normal matrix.
bool settle(const std::vector<Vector3d>& points, double radius, double scale, Vector3d& centre, Matrix3d& H) {
    for (int round = 0; round < 50; ++round) {
        H.setZero();
        Vector3d g = Vector3d::Zero();
        for (const auto& p : points) {
            const Vector3d w = p - centre;
            const double d = w.norm() - radius, x = d / (kTukey * scale);
            if (std::abs(x) < 1 && w.norm() > 0) {
                const Vector3d n = w.normalized();
                const double weight = (1 - x * x) * (1 - x * x);
                H += weight * n * n.transpose();
                g += weight * d * n;
            }
        }
        const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(H);
        if (!(eigen.eigenvalues()[0] > 1e-4 * eigen.eigenvalues()[2])) {
            return false;
        }
        const Vector3d step = H.ldlt().solve(g);
        centre += step;
        if (step.norm() < 1e-10 * radius) {
            return true;
        }
    }
    return true;
}

// Share of the sphere that its points cover, by cells of about equal area.
double cover(const std::vector<Vector3d>& points, const Vector3d& centre) {
    constexpr std::size_t kRings = 8, kSectors = 16;
    std::array<bool, kRings * kSectors> seen{};
    for (const auto& p : points) {
        const Vector3d n = (p - centre).normalized();
        const auto ring = std::min(kRings - 1, static_cast<std::size_t>((n.z() + 1) / 2 * kRings));
        const double turn = std::atan2(n.y(), n.x()) / (2 * std::acos(-1.0)) + 0.5;
        const auto sector = std::min(kSectors - 1, static_cast<std::size_t>(turn * kSectors));
        seen[ring * kSectors + sector] = true;
    }
    return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / static_cast<double>(seen.size());
}

// Neighbours that share an error count for less than as many independent points. Cells a quarter of the radius wide:
// the sum of residuals of each against what independent ones would have.
double correlation_of(const std::vector<Vector3d>& points, const Vector3d& centre, double radius, double scale) {
    std::vector<Eigen::Vector3f> cells;
    for (const auto& p : points) {
        cells.push_back((p - centre).cast<float>());
    }
    const PointGrid grid(cells, radius / 4);
    double sums = 0, squares = 0, blocks = 0;
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
        double sum = 0, own = 0;
        for (const auto& p : grid.points(cell)) {
            const double d = p.cast<double>().norm() - radius;
            if (std::abs(d) < kTukey * scale) {
                sum += d;
                own += d * d;
            }
        }
        if (grid.points(cell).size() >= 4) {
            sums += sum * sum;
            squares += own;
            blocks += 1;
        }
    }
    if (blocks < 5 || !(squares > 0)) {
        return 1;
    }
    // What chance does not do once in a thousand.
    return sums / squares > 1 + 3.3 * std::sqrt(2 / blocks) ? sums / squares : 1;
}

// A ball about where a patch's sphere is, or none. `inside` says how many points float within it.
std::optional<FoundBall> ball_at(const PointGrid& grid, Vector3d centre, double radius) {
    double thickness = 0.25 * radius;
    Matrix3d H;
    std::vector<Vector3d> shell;
    double scale = 0;
    for (int round = 0; round < 4; ++round) {
        shell = on_shell(grid, centre, radius, thickness);
        if (shell.size() < kFewest) {
            return std::nullopt;
        }
        scale = std::max(robust_scale(shell, centre, radius), 1e-6 * radius);
        if (!settle(shell, radius, scale, centre, H)) {
            return std::nullopt;
        }
        scale = std::max(robust_scale(shell, centre, radius), 1e-6 * radius);
        thickness = std::clamp(6 * scale, 0.005 * radius, 0.25 * radius);
    }
    const std::vector<Vector3d> near = on_shell(grid, centre, radius, std::min(thickness, kTukey * scale));
    if (near.size() < kFewest || scale > 0.1 * radius || cover(near, centre) < kLeastCover) {
        return std::nullopt;
    }
    // A body of another shape has points within the sphere, or has them past its border on every side.
    const auto within = around(grid, centre, radius - thickness).size();
    if (within > near.size() / 20) {
        return std::nullopt;
    }
    FoundBall ball{centre, Matrix3d::Zero(), scale, 0, static_cast<int>(near.size())};
    try {
        ball.free_radius_mm = associated_sphere(near, "ball").shape.radius;
    } catch (const InputError&) {
        return std::nullopt;
    }
    if (std::abs(ball.free_radius_mm / radius - 1) > kRadiusShareWhole) {
        return std::nullopt;
    }
    // Variance of an M-estimate with Tukey's weights: 1 / 0.95 of least squares, whose normal matrix is that of all
    // points; the weights' mean is 0.79 for Gaussian noise.
    double squares = 0, slope = 0, count = 0;
    for (const auto& p : shell) {
        const double d = (p - centre).norm() - radius, x = d / (kTukey * scale);
        if (std::abs(x) < 1) {
            const double w = (1 - x * x) * (1 - x * x);
            squares += w * w * d * d;
            slope += (1 - x * x) * (1 - 5 * x * x);
            count += 1;
        }
    }
    Matrix3d N = Matrix3d::Zero();
    for (const auto& p : near) {
        const Vector3d n = (p - centre).normalized();
        N += n * n.transpose();
    }
    const double variance = squares / count / std::pow(slope / count, 2);
    ball.covariance = correlation_of(near, centre, radius, scale) * variance * N.inverse();
    return ball;
}

struct Seed {
    Vector3d centre;
    double off = 0;  // of the radius, as a share
};

// Mean squares of a patch across it and along it are in this ratio for a ball, by a factor of three: of a disc of
// radius a on a ball of radius R they are a^4 / (48 R^2) and a^2 / 4. Spares the fit to every patch of a table.
bool bends_like_a_ball(const std::vector<Vector3d>& patch) {
    Vector3d mean = Vector3d::Zero();
    for (const auto& p : patch) {
        mean += p / static_cast<double>(patch.size());
    }
    Matrix3d scatter = Matrix3d::Zero();
    for (const auto& p : patch) {
        scatter += (p - mean) * (p - mean).transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(scatter);
    constexpr double kRatio = kPatch * kPatch / 12;
    const double ratio = eigen.eigenvalues()[0] / eigen.eigenvalues()[1];
    return ratio > kRatio / 3 && ratio < kRatio * 3;
}

// The sphere through the patch about a point, when it has about the right radius and bends both ways.
std::optional<Seed> seed_at(const PointGrid& grid, const Vector3d& p, double radius) {
    const std::vector<Vector3d> patch = around(grid, p, kPatch * radius);
    if (patch.size() < kFewest || !bends_like_a_ball(patch)) {
        return std::nullopt;
    }
    try {
        const auto fit = associated_sphere(patch, "patch");
        const double off = std::abs(fit.shape.radius / radius - 1);
        if (off > kRadiusShare || fit.rms > 0.1 * radius) {
            return std::nullopt;
        }
        return Seed{fit.shape.centre, off};
    } catch (const InputError&) {
        return std::nullopt;
    }
}

}  // namespace

std::vector<FoundBall> find_balls(const Scan& scan, double radius_mm) {
    if (!(radius_mm > 0)) {
        throw InputError("calibrate: a ball of radius " + std::to_string(radius_mm) +
                         " mm; a radius above 0 was needed");
    }
    // Sums hang on the order of the points; this one is the same for every order they came in.
    std::vector<Eigen::Vector3f> points = scan.points;
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    });
    const PointGrid grid(points, 0.5 * radius_mm);
    std::vector<std::optional<Seed>> seeds(grid.cells());
    parallel_for(grid.cells(), 16, [&](std::size_t cell) {
        if (grid.points(cell).size() >= 4) {
            seeds[cell] = seed_at(grid, grid.mean(cell), radius_mm);
        }
    });
    std::erase_if(seeds, [](const auto& seed) { return !seed; });
    std::vector<std::optional<FoundBall>> balls(seeds.size());
    parallel_for(seeds.size(), 4, [&](std::size_t i) { balls[i] = ball_at(grid, seeds[i]->centre, radius_mm); });
    std::vector<FoundBall> candidates;
    for (const auto& ball : balls) {
        if (ball) {
            candidates.push_back(*ball);
        }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const FoundBall& a, const FoundBall& b) { return a.points > b.points; });
    std::vector<FoundBall> found;
    for (const FoundBall& ball : candidates) {
        const bool known = std::any_of(found.begin(), found.end(), [&](const FoundBall& other) {
            return (other.centre - ball.centre).norm() < radius_mm;
        });
        if (!known) {
            found.push_back(ball);
        }
    }
    for (FoundBall& ball : found) {
        ball.centre += scan.origin_mm;
    }
    return found;
}

}  // namespace seampath
