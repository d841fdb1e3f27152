#include "stages/geometry/surface_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr double kTukey = 4.685;
constexpr double kMadToSigma = 1.4826;
constexpr int kMostRounds = 60;
constexpr double kSettled = 1e-9;  // of the scale: what a further step may move
constexpr double kLeastTurn =
    0.02;  // rad, rms, of normals about their mean: below it a cylinder is no more than a plane

double tukey_weight(double x) {
    return std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
}

double tukey_slope(double x) {
    return std::abs(x) < 1 ? (1 - x * x) * (1 - 5 * x * x) : 0;
}

Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> points) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& p : points) {
        sum += p;
    }
    return sum / static_cast<double>(points.size());
}

Eigen::Matrix3d scatter_of(std::span<const Eigen::Vector3d> v, const Eigen::Vector3d& about) {
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& x : v) {
        scatter += (x - about) * (x - about).transpose();
    }
    return scatter / static_cast<double>(v.size());
}

// Circle x^2 + y^2 + a x + b y + c = 0 through points in the plane of e (Kasa): a beginning, biased but close.
std::optional<Cylinder> circle_along(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& axis) {
    const Eigen::Vector3d e0 = axis.unitOrthogonal(), e1 = axis.cross(e0), centroid = mean_of(points);
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const auto& p : points) {
        const Eigen::Vector3d row((p - centroid).dot(e0), (p - centroid).dot(e1), 1);
        A += row * row.transpose();
        right -= row * row.head<2>().squaredNorm();
    }
    const Eigen::Vector3d c = A.ldlt().solve(right);
    const double squared = c.head<2>().squaredNorm() / 4 - c[2];
    if (!(squared > 0) || !std::isfinite(squared)) {
        return std::nullopt;
    }
    return Cylinder{centroid - 0.5 * (c[0] * e0 + c[1] * e1), axis, std::sqrt(squared)};
}

}  // namespace

double SurfaceFit::distance(const Eigen::Vector3d& p) const {
    return side_ * std::visit([&](const auto& s) { return signed_distance(s, p); }, shape_);
}

Eigen::Vector3d SurfaceFit::normal(const Eigen::Vector3d& p) const {
    return side_ * std::visit([&](const auto& s) { return outward_normal(s, p); }, shape_);
}

void SurfaceFit::set_frame(const Eigen::Vector3d& origin) {
    origin_ = origin;
    const Eigen::Vector3d direction =
        std::holds_alternative<Plane>(shape_) ? std::get<Plane>(shape_).normal : std::get<Cylinder>(shape_).axis;
    e_[0] = direction.unitOrthogonal();
    e_[1] = direction.cross(e_[0]);
    if (auto* plane = std::get_if<Plane>(&shape_)) {
        plane->point = origin - (origin - plane->point).dot(plane->normal) * plane->normal;
    } else {
        auto& cylinder = std::get<Cylinder>(shape_);
        cylinder.point += (origin - cylinder.point).dot(cylinder.axis) * cylinder.axis;
    }
}

// Derivative of the (unsigned side's) distance by the parameters. Plane: offset along the normal, two tilts about the
// origin. Cylinder: two shifts of the axis, two tilts of it about the origin, the radius. Tilts are lengths over
// length_.
SurfaceFit::Row SurfaceFit::row(const Eigen::Vector3d& p) const {
    Row r = Row::Zero();
    const Eigen::Vector3d v = p - origin_;
    if (std::holds_alternative<Plane>(shape_)) {
        r.head<3>() << -1, v.dot(e_[0]) / length_, v.dot(e_[1]) / length_;
        return r;
    }
    const auto& cylinder = std::get<Cylinder>(shape_);
    const Eigen::Vector3d n = outward_normal(cylinder, p);
    const double a = -n.dot(e_[0]), b = -n.dot(e_[1]), h = v.dot(cylinder.axis) / length_;
    r << a, b, a * h, b * h, -1;
    return r;
}

void SurfaceFit::move(const Row& step) {
    if (auto* plane = std::get_if<Plane>(&shape_)) {
        plane->point += step[0] * plane->normal;
        plane->normal = (plane->normal + (step[1] * e_[0] + step[2] * e_[1]) / length_).normalized();
    } else {
        auto& cylinder = std::get<Cylinder>(shape_);
        cylinder.point += step[0] * e_[0] + step[1] * e_[1];
        cylinder.axis = (cylinder.axis + (step[2] * e_[0] + step[3] * e_[1]) / length_).normalized();
        cylinder.radius += step[4];
    }
    set_frame(origin_);
}

double SurfaceFit::weight(const Eigen::Vector3d& p) const {
    return scale_ > 0 ? tukey_weight(distance(p) / (kTukey * scale_)) : 1;
}

void SurfaceFit::measure_scale(std::span<const Eigen::Vector3d> points, double least_scale) {
    std::vector<double> magnitude;
    magnitude.reserve(points.size());
    for (const auto& p : points) {
        magnitude.push_back(std::abs(distance(p)));
    }
    const double n = static_cast<double>(points.size());
    scale_ = std::max(least_scale, kMadToSigma * quantile(magnitude, 0.5) * std::sqrt(n / (n - parameters())));
}

bool SurfaceFit::gauss_newton(std::span<const Eigen::Vector3d> points, double& largest_step) {
    const int n = parameters();
    Matrix normal = Matrix::Zero();
    Row right = Row::Zero();
    for (const auto& p : points) {
        const double d = side_ * distance(p), w = scale_ > 0 ? tukey_weight(d / (kTukey * scale_)) : 1;
        if (w > 0) {
            const Row r = row(p);
            normal.selfadjointView<Eigen::Lower>().rankUpdate(r, w);
            right -= w * d * r;
        }
    }
    const Eigen::MatrixXd A = Matrix(normal.selfadjointView<Eigen::Lower>()).topLeftCorner(n, n);
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(A);
    const auto pivots = ldlt.vectorD();
    if (ldlt.info() != Eigen::Success || !(pivots.minCoeff() > 1e-13 * pivots.maxCoeff())) {
        return false;
    }
    Row step = Row::Zero();
    step.head(n) = ldlt.solve(right.head(n));
    largest_step = step.cwiseAbs().maxCoeff();
    if (!step.allFinite() || largest_step > 10 * length_) {
        return false;
    }
    move(step);
    return parameters() == 3 || std::get<Cylinder>(shape_).radius > 0;
}

// Covariance of an M-estimator (Huber 1981): bread from the slope of the influence function, filling from the sums of
// influences over blocks, so that errors which the points of a block share count as often as they are shared.
void SurfaceFit::finish(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block) {
    const int n = parameters();
    Matrix bread = Matrix::Zero();
    std::vector<Row> sums;
    double taken = 0, squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double d = side_ * distance(points[i]), x = scale_ > 0 ? d / (kTukey * scale_) : 0;
        const double w = tukey_weight(x);
        if (w == 0) {
            continue;
        }
        const Row r = row(points[i]);
        bread.selfadjointView<Eigen::Lower>().rankUpdate(r, tukey_slope(x));
        if (block[i] >= sums.size()) {
            sums.resize(block[i] + 1, Row::Zero());
        }
        sums[block[i]] += w * d * r;
        squares += w * d * w * d;
        taken += 1;
    }
    share_taken_ = taken / static_cast<double>(points.size());
    const Eigen::MatrixXd A = Matrix(bread.selfadjointView<Eigen::Lower>()).topLeftCorner(n, n);
    cofactors_.setZero();
    cofactors_.topLeftCorner(n, n) = A.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    double shared = 0, blocks = 0;
    for (const Row& sum : sums) {
        shared += sum.dot(cofactors_ * sum);
        blocks += sum.squaredNorm() > 0;
    }
    const double independent = squares / std::max(1.0, taken);
    // The fit takes n degrees of freedom from the sums.
    const double factor = blocks > n + 1 ? shared / n * blocks / (blocks - n) : independent;
    unit_ = std::sqrt(std::max(independent, factor));
}

double SurfaceFit::sigma(const Eigen::Vector3d& p) const {
    const Row r = row(p);
    return unit_ * std::sqrt(std::max(0.0, r.dot(cofactors_ * r)));
}

bool SurfaceFit::fit(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                     double least_scale) {
    if (points.size() < 4 * static_cast<std::size_t>(parameters())) {
        return false;
    }
    const Eigen::Vector3d centroid = mean_of(points);
    length_ = std::sqrt(scatter_of(points, centroid).trace());
    if (!(length_ > 0)) {
        return false;
    }
    set_frame(centroid);
    for (int round = 0; round < kMostRounds; ++round) {
        measure_scale(points, least_scale);
        double largest_step = 0;
        if (!gauss_newton(points, largest_step)) {
            return false;
        }
        if (largest_step <= kSettled * std::max(scale_, 1e-6 * length_)) {
            finish(points, block);
            return true;
        }
    }
    return false;
}

std::optional<SurfaceFit> fit_plane(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                                    const Eigen::Vector3d& outward, double least_scale) {
    if (points.size() < 12) {
        return std::nullopt;
    }
    const Eigen::Vector3d centroid = mean_of(points);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter_of(points, centroid));
    const Eigen::Vector3d n = solver.eigenvectors().col(0);
    SurfaceFit result(Plane{centroid, n.dot(outward) < 0 ? Eigen::Vector3d(-n) : n}, false);
    return result.fit(points, block, least_scale) ? std::optional(result) : std::nullopt;
}

std::optional<SurfaceFit> fit_cylinder(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                                       std::span<const Eigen::Vector3d> places,
                                       std::span<const Eigen::Vector3d> normals, double least_scale) {
    if (points.size() < 20) {
        return std::nullopt;
    }
    const Eigen::Vector3d mean = mean_of(normals);
    if (scatter_of(normals, mean).trace() < kLeastTurn * kLeastTurn) {
        return std::nullopt;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter_of(normals, Eigen::Vector3d::Zero()));
    const auto cylinder = circle_along(points, solver.eigenvectors().col(0));
    if (!cylinder) {
        return std::nullopt;
    }
    double outwards = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        outwards += outward_normal(*cylinder, places[i]).dot(normals[i]);
    }
    SurfaceFit result(*cylinder, outwards < 0);
    return result.fit(points, block, least_scale) ? std::optional(result) : std::nullopt;
}

}  // namespace seampath
