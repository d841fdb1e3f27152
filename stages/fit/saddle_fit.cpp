#include "stages/fit/saddle_fit.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

enum Quantity { kBranchRadius, kHeaderRadius, kAngle, kOffset, kQuantities };
constexpr std::array<const char*, kQuantities> kNames{"branch radius", "header radius", "angle", "offset"};

constexpr double kCertain = 4;      // sigmas
constexpr double kParallel = 1e-3;  // rad: axes closer than that have no place where they are closest
constexpr int kMostRounds = 30;

using Quantities = Eigen::Matrix<double, kQuantities, 1>;
using Step = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 11, 1>;
using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 11, 11>;
using Jacobian = Eigen::Matrix<double, kQuantities, Eigen::Dynamic, 0, kQuantities, 11>;
using Nominals = std::array<std::optional<Measured>, kQuantities>;

const Vector3d* axis_of(const SurfaceFit::Shape& shape) {
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
        return &cylinder->axis;
    }
    const auto* cone = std::get_if<Cone>(&shape);
    return cone != nullptr ? &cone->axis : nullptr;
}

/// A branch, its axis out of the header, and a header, as steps from where they were fitted.
class Pair {
public:
    Pair(const SurfaceFit& branch, const SurfaceFit& header, const Eigen::MatrixXd& between)
        : branch_(branch), header_(header), between_(between) {
        const Vector3d out =
            std::visit([&](const auto& s) { return outward_normal(s, branch.origin()); }, header.shape());
        const Vector3d axis = std::get<Cylinder>(branch.shape()).axis;
        outwards_ = out.dot(axis) < 0 ? -1 : 1;
        const Quantities start = at(Step::Zero(parameters()));
        offset_sign_ = start[kOffset] < 0 ? -1 : 1;
        angle_sign_ = start[kAngle] > std::numbers::pi / 2 ? -1 : 1;
        if (std::holds_alternative<Plane>(header.shape())) {
            const Vector3d lean = across(axis, std::get<Plane>(header.shape()).normal);
            side_ = lean.norm() > 0 ? Vector3d(outwards_ * lean.normalized()) : axis.unitOrthogonal();
        }
        if (const auto* sphere = std::get_if<Sphere>(&header.shape())) {
            const Vector3d off = across(sphere->centre - std::get<Cylinder>(branch.shape()).point, axis);
            side_ = off.norm() > 0 ? off.normalized() : axis.unitOrthogonal();
        }
    }

    Eigen::Index parameters() const { return branch_.parameters() + header_.parameters(); }

    Covariance covariance() const {
        Covariance c = Covariance::Zero(parameters(), parameters());
        c.topLeftCorner(branch_.parameters(), branch_.parameters()) = branch_.covariance();
        c.bottomRightCorner(header_.parameters(), header_.parameters()) = header_.covariance();
        if (between_.size() > 0) {
            c.topRightCorner(branch_.parameters(), header_.parameters()) = between_;
            c.bottomLeftCorner(header_.parameters(), branch_.parameters()) = between_.transpose();
        }
        return c;
    }

    Cylinder branch(const Step& x) const {
        auto cylinder = std::get<Cylinder>(branch_.moved(x.head(branch_.parameters())));
        cylinder.axis *= outwards_;
        return cylinder;
    }

    SurfaceFit::Shape header(const Step& x) const { return header_.moved(x.tail(header_.parameters())); }

    bool has(int quantity) const {
        const auto& shape = header_.shape();
        switch (quantity) {
            case kHeaderRadius:
                return std::holds_alternative<Cylinder>(shape) || std::holds_alternative<Sphere>(shape);
            case kAngle:
                return !std::holds_alternative<Sphere>(shape);
            case kOffset:
                return !std::holds_alternative<Plane>(shape);
            default:
                return true;
        }
    }

    // Smooth in the steps: an offset goes through 0, and an angle through 90 deg, without a kink. 0 for what the header
    // does not have.
    Quantities at(const Step& x) const {
        const Cylinder b = branch(x);
        const SurfaceFit::Shape shape = header(x);
        Quantities v = Quantities::Zero();
        v[kBranchRadius] = b.radius;
        if (const auto* plane = std::get_if<Plane>(&shape)) {
            v[kAngle] =
                std::numbers::pi / 2 - std::atan2(across(b.axis, plane->normal).dot(side_), b.axis.dot(plane->normal));
        } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
            v[kHeaderRadius] = sphere->radius;
            v[kOffset] = across(sphere->centre - b.point, b.axis).dot(side_);
        } else {
            const Vector3d& axis = *axis_of(shape);
            const auto* cylinder = std::get_if<Cylinder>(&shape);
            const Vector3d point = cylinder != nullptr ? cylinder->point : std::get<Cone>(shape).apex;
            const Vector3d square = b.axis.cross(axis);
            v[kHeaderRadius] = cylinder != nullptr ? cylinder->radius : 0;
            v[kAngle] = std::atan2(square.norm(), angle_sign_ * b.axis.dot(axis));
            v[kOffset] = offset_sign_ * (point - b.point).dot(square.normalized());
        }
        return v;
    }

    // By central differences.
    Jacobian derivatives(const Step& x) const {
        constexpr double kStep = 1e-3;  // mm
        Jacobian j(+kQuantities, parameters());
        for (Eigen::Index i = 0; i < parameters(); ++i) {
            Step ahead = x, behind = x;
            ahead[i] += kStep;
            behind[i] -= kStep;
            j.col(i) = (at(ahead) - at(behind)) / (2 * kStep);
        }
        return j;
    }

    // An angle beyond 90 deg is as good a name of the same pair.
    void prefer(double angle) {
        if (axis_of(header_.shape()) != nullptr && angle > std::numbers::pi / 2) {
            angle_sign_ = -angle_sign_;
        }
    }

private:
    const SurfaceFit& branch_;
    const SurfaceFit& header_;
    const Eigen::MatrixXd& between_;
    double outwards_ = 1, angle_sign_ = 1, offset_sign_ = 1;
    Vector3d side_{0, 0, 0};  ///< to which a branch leans on a plane, or a sphere's centre lies off the axis
};

/// The most likely step, and what is then known.
struct Posterior {
    Step step;
    Covariance covariance;
    double chi2 = 0;
    int nominals = 0;
};

Posterior update(const Pair& pair, const Nominals& nominals) {
    Posterior posterior{Step::Zero(pair.parameters()), pair.covariance(), 0, 0};
    std::array<int, kQuantities> given{};
    Eigen::Index n = 0;
    for (int q = 0; q < kQuantities; ++q) {
        if (nominals[q] && pair.has(q)) {
            given[n++] = q;
        }
    }
    if (n == 0) {
        return posterior;
    }
    const Covariance prior = pair.covariance();
    for (int round = 0; round < kMostRounds; ++round) {
        const Quantities at = pair.at(posterior.step);
        const Jacobian all = pair.derivatives(posterior.step);
        Eigen::MatrixXd H(n, pair.parameters());
        Eigen::VectorXd off(n), variance(n);
        for (Eigen::Index k = 0; k < n; ++k) {
            H.row(k) = all.row(given[k]);
            off[k] = nominals[given[k]]->value - at[given[k]];
            variance[k] = std::pow(nominals[given[k]]->sigma, 2);
        }
        off += H * posterior.step;
        const Eigen::LDLT<Eigen::MatrixXd> innovation(H * prior * H.transpose() +
                                                      Eigen::MatrixXd(variance.asDiagonal()));
        const Eigen::MatrixXd gain = innovation.solve(H * prior).transpose();
        const Step step = gain * off;
        const double moves = (step - posterior.step).norm();
        posterior = {step, prior - gain * H * prior, off.dot(innovation.solve(off)), static_cast<int>(n)};
        if (moves < 1e-9) {
            break;
        }
    }
    return posterior;
}

Nominals checked(const SaddleNominals& given) {
    Nominals nominals{given.branch_radius_mm, given.header_radius_mm, given.angle_rad, given.offset_mm};
    for (int q = 0; q < kQuantities; ++q) {
        if (nominals[q] && !(std::isfinite(nominals[q]->value) && nominals[q]->sigma > 0)) {
            throw InputError(std::string("saddle: the nominal ") + kNames[q] + " is " + shortest(nominals[q]->value) +
                             " with a sigma of " + shortest(nominals[q]->sigma) +
                             "; a finite number with a sigma above 0 is needed");
        }
    }
    return nominals;
}

// Why the branch's wall is not sure to meet the header all round: for two cylinders and for a sphere, whose wall the
// generator line furthest out passes at r + offset from the middle.
std::optional<std::string> too_wide(const Quantities& at, const Jacobian& by, const Covariance& covariance) {
    const double sign = at[kOffset] < 0 ? -1 : 1;
    const double margin = at[kHeaderRadius] - at[kBranchRadius] - sign * at[kOffset];
    const Eigen::RowVectorXd row = by.row(kHeaderRadius) - by.row(kBranchRadius) - sign * by.row(kOffset);
    const double sigma = std::sqrt(std::max(0.0, (row * covariance * row.transpose()).value()));
    if (margin > kCertain * sigma) {
        return std::nullopt;
    }
    const std::string left = "header radius less branch radius less offset is " + fixed(margin, 3) +
                             " mm with a sigma of " + fixed(sigma, 3) + " mm";
    return margin < -kCertain * sigma
               ? "partial penetration: " + left + ", so the branch's wall passes beside the header"
               : "the branch is as wide as the header: " + left +
                     ", so where its wall only touches the header the curve has a corner, "
                     "or a gap";
}

}  // namespace

std::variant<SaddleFit, NoSaddle> fit_saddle(const SurfaceFit& branch, const SurfaceFit& header,
                                             const SaddleNominals& given, const Eigen::MatrixXd& between) {
    const Nominals nominals = checked(given);
    if (!std::holds_alternative<Cylinder>(branch.shape())) {
        return NoSaddle{"the branch is no cylinder"};
    }
    ensure(between.size() == 0 || (between.rows() == branch.parameters() && between.cols() == header.parameters()),
           "a covariance of the branch's parameters by the header's");
    Pair pair(branch, header, between);
    if (given.angle_rad) {
        pair.prefer(given.angle_rad->value);
    }
    const Posterior posterior = update(pair, nominals);
    const Quantities at = pair.at(posterior.step);
    if (pair.has(kAngle) && std::abs(std::sin(at[kAngle])) < kParallel) {
        return NoSaddle{"the branch runs along the header"};
    }
    const Jacobian by = pair.derivatives(posterior.step);
    if (pair.has(kHeaderRadius)) {
        if (auto reason = too_wide(at, by, posterior.covariance)) {
            return NoSaddle{std::move(*reason)};
        }
    }
    const auto measured = [&](int q) {
        const double variance = (by.row(q) * posterior.covariance * by.row(q).transpose()).value();
        return Measured{q == kOffset ? std::abs(at[q]) : at[q], std::sqrt(std::max(0.0, variance))};
    };
    const auto measured_if = [&](int q) { return pair.has(q) ? std::optional(measured(q)) : std::nullopt; };
    const Cylinder wall = pair.branch(posterior.step);
    const SurfaceFit::Shape shape = pair.header(posterior.step);
    const Header base = std::visit([](const auto& s) -> Header { return s; }, shape);
    const Vector3d zero = axis_of(shape) != nullptr ? *axis_of(shape) : wall.axis.unitOrthogonal();
    try {
        return SaddleFit{SaddleCurve(wall, zero, base),
                         shape,
                         across(zero, wall.axis).normalized(),
                         measured(kBranchRadius),
                         measured_if(kHeaderRadius),
                         measured_if(kAngle),
                         measured_if(kOffset),
                         posterior.chi2,
                         posterior.nominals};
    } catch (const InputError& e) {
        return NoSaddle{e.what()};
    }
}

double branch_angle(const SaddleFit& saddle, const Vector3d& p) {
    const Cylinder& branch = saddle.curve.branch();
    const Vector3d v = p - branch.point;
    return std::atan2(v.dot(saddle.zero.cross(branch.axis)), v.dot(saddle.zero));
}

}  // namespace seampath
