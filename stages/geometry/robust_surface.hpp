#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/surface_parameters.hpp"

/// The solver behind surface_fit.hpp, for one kind of surface.
namespace seampath::detail {

inline constexpr double kTukey = 4.685;
inline constexpr double kMadToSigma = 1.4826;
inline constexpr int kMostRounds = 60;
inline constexpr double kSettled = 1e-6;  // of its own sigma: what a further step may move
inline constexpr double kFlat = 1e4;      // of the points' extent: a surface about a centre further off is a plane

inline double tukey_weight(double x) {
    return std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
}

inline double tukey_slope(double x) {
    return std::abs(x) < 1 ? (1 - x * x) * (1 - 5 * x * x) : 0;
}

inline Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> points) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& p : points) {
        sum += p;
    }
    return sum / static_cast<double>(points.size());
}

inline Eigen::Matrix3d scatter_of(std::span<const Eigen::Vector3d> v, const Eigen::Vector3d& about) {
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& x : v) {
        scatter += (x - about) * (x - about).transpose();
    }
    return scatter / static_cast<double>(v.size());
}

inline const Eigen::Vector3d& middle(const Plane& s) {
    return s.point;
}
inline const Eigen::Vector3d& middle(const Cylinder& s) {
    return s.point;
}
inline const Eigen::Vector3d& middle(const Cone& s) {
    return s.apex;
}
inline const Eigen::Vector3d& middle(const Sphere& s) {
    return s.centre;
}

inline bool is_sound(const Plane&) {
    return true;
}
inline bool is_sound(const Cylinder& s) {
    return s.radius > 0;
}
inline bool is_sound(const Cone& s) {
    return s.half_angle > 0 && s.half_angle < std::numbers::pi / 2;
}
inline bool is_sound(const Sphere& s) {
    return s.radius > 0;
}

/// Gauss-Newton with Tukey's weights.
template <class S>
class RobustSurface {
public:
    using Row = decltype(row(std::declval<S>(), std::declval<SurfaceFrame>(), Eigen::Vector3d()).by);
    static constexpr int kParameters = Row::RowsAtCompileTime;
    using Matrix = Eigen::Matrix<double, kParameters, kParameters>;

    RobustSurface(const S& start, std::span<const Eigen::Vector3d> points, double least_scale)
        : shape(start), points_(points), least_scale_(least_scale) {}

    S shape;
    SurfaceFrame frame;
    double scale = 0;
    double share_taken = 0;
    Matrix covariance;

    /// False when the points do not determine the surface. `block`: one number a point, from 0 on.
    bool fit(std::span<const std::uint32_t> block) {
        ensure(block.size() == points_.size(), "one block a point");
        if (points_.size() < 4 * static_cast<std::size_t>(kParameters)) {
            return false;
        }
        const Eigen::Vector3d origin = mean_of(points_);
        const double length = std::sqrt(scatter_of(points_, origin).trace());
        if (!(length > 1e-10 * origin.norm()) || !std::isfinite(length)) {
            return false;
        }
        frame = frame_of(shape, origin, length);
        magnitude_.resize(points_.size());
        for (int round = 0; round < kMostRounds; ++round) {
            measure_scale();
            const Outcome outcome = gauss_newton();
            if (outcome == Outcome::settled) {
                find_covariance(block);
            }
            if (outcome != Outcome::moved) {
                return outcome == Outcome::settled;
            }
        }
        return false;
    }

private:
    enum class Outcome { moved, settled, lost };

    /// Sums over the points: of w r r', with its slope over its weight a Newton matrix; of -w d r.
    struct Sums {
        Matrix wrr = Matrix::Zero();
        Row right = Row::Zero();
        double weight = 0, slope = 0;
        // Of noise alone it is 0.83; where the start is still off it says nothing, and a step must not become too long.
        double steepness(double least) const { return std::max(least, slope / weight); }
    };

    double rounding() const {
        return 8 * std::numeric_limits<double>::epsilon() *
               (frame.origin.norm() + frame.length + (frame.origin - middle(shape)).norm());
    }

    void measure_scale() {
        for (std::size_t i = 0; i < points_.size(); ++i) {
            magnitude_[i] = std::abs(signed_distance(shape, points_[i]));
        }
        const auto n = static_cast<double>(points_.size());
        scale = std::max(
            {least_scale_, rounding(), kMadToSigma * quantile(magnitude_, 0.5) * std::sqrt(n / (n - kParameters))});
    }

    Sums sums() const {
        Sums s;
        for (const auto& p : points_) {
            const auto r = row(shape, frame, p);
            const double x = r.distance / (kTukey * scale), w = tukey_weight(x);
            if (w > 0) {
                for (int j = 0; j < kParameters; ++j) {
                    s.wrr.col(j).tail(kParameters - j) += w * r.by[j] * r.by.tail(kParameters - j);
                }
                s.right -= w * r.distance * r.by;
                s.weight += w;
                s.slope += tukey_slope(x);
            }
        }
        s.wrr = Matrix(s.wrr.template selfadjointView<Eigen::Lower>());
        return s;
    }

    Outcome gauss_newton() {
        const Sums s = sums();
        const Eigen::LDLT<Matrix> ldlt(s.wrr);
        const auto pivots = ldlt.vectorD();
        if (ldlt.info() != Eigen::Success || !(pivots.minCoeff() > 1e-13 * pivots.maxCoeff())) {
            return Outcome::lost;
        }
        Row step = ldlt.solve(s.right) / s.steepness(0.7);
        const double reach = frame.length + (frame.origin - middle(shape)).norm();
        if (!step.allFinite() || reach > kFlat * frame.length) {
            return Outcome::lost;
        }
        step *= std::min(1.0, 0.5 * reach / step.cwiseAbs().maxCoeff());  // a radius of twice its size steps to 0
        shape = moved(shape, frame, step);
        if (!is_sound(shape)) {
            return Outcome::lost;
        }
        frame = frame_of(shape, frame.origin, frame.length);
        // How far the step moves the surface, rms over the points; over sqrt(weight) a sigma of it.
        const double moves = std::sqrt(step.dot(s.wrr * step) / s.weight);
        const bool settled = moves <= std::max(kSettled * scale / std::sqrt(s.weight), rounding());
        return settled ? Outcome::settled : Outcome::moved;
    }

    /// What the points of a block add to the normal matrix and to its right side.
    struct Block {
        Matrix wrr = Matrix::Zero();
        Row right = Row::Zero();
    };

    // Covariance of an M-estimator (Huber 1981) by blocks, so that errors which the points of a block share count as
    // often as they are shared: by how much the surface moves when a block is left out (the jackknife, as CR3 in Bell &
    // McCaffrey 2002). It is up to a tenth too large where few blocks have much leverage, which makes up for how
    // unsure it is there. Few blocks tell little of a matrix: theirs is mixed with the one for independent errors,
    // made as large as they say, which counts as much as the fewest blocks that tell any.
    void find_covariance(std::span<const std::uint32_t> block) {
        constexpr int n = kParameters;
        const Sums s = sums();
        const double steepness = s.steepness(0.1);
        std::vector<Block> blocks;
        double taken = 0, squares = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const auto r = row(shape, frame, points_[i]);
            const double w = tukey_weight(r.distance / (kTukey * scale)), psi = w * r.distance;
            if (w > 0) {
                if (block[i] >= blocks.size()) {
                    blocks.resize(block[i] + 1);
                }
                blocks[block[i]].wrr += w * r.by * r.by.transpose();
                blocks[block[i]].right -= psi * r.by;
                squares += psi * psi;
                taken += 1;
            }
        }
        share_taken = taken / static_cast<double>(points_.size());
        constexpr double kMuch = 1.001;  // bounds what a block can do without which nothing is determined
        Matrix shared = Matrix::Zero();
        double count = 0;
        for (const Block& b : blocks) {
            const Row moves = Matrix(kMuch * s.wrr - b.wrr).ldlt().solve(b.right) / steepness;
            shared += moves * moves.transpose();
            count += b.right.squaredNorm() > 0;
        }
        const Matrix inverse = s.wrr.ldlt().solve(Matrix::Identity());
        const double independent = squares / s.weight * taken / (taken - n) / (steepness * steepness);
        covariance = independent * inverse;
        if (count > n + 1) {
            shared *= (count - 1) / count;
            const double factor = std::max(independent, (s.wrr * shared).trace() / n);
            covariance = (count * shared + (n + 1) * factor * inverse) / (count + n + 1);
        }
    }

    std::span<const Eigen::Vector3d> points_;
    double least_scale_;
    std::vector<double> magnitude_;
};

}  // namespace seampath::detail
