#include "stages/extract/view_shifts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "stages/geometry/parallel.hpp"

namespace seampath::detail {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kStretch = 6;  // places: long against what neighbours share, short against a seam's bends

Index index(std::size_t i) {
    return static_cast<Index>(i);
}

const Vector3d& normal_of(const TrackPoint& place, std::size_t k) {
    return k == 0 ? place.section.n1 : place.section.n2;
}

double log_determinant(const Eigen::LDLT<MatrixXd>& ldlt) {
    return ldlt.vectorD().array().log().sum();
}

// Of a flank, the views that show it: what others send there are its edges, and strays.
std::vector<bool> views_that_show(const std::vector<TrackPoint>& places, std::size_t k, std::size_t views) {
    constexpr double kLeastShare = 0.03;  // of the points of the view that shows most
    std::vector<double> count(views, 0);
    for (const TrackPoint& place : places) {
        for (const SlabPoint& point : place.slab[k]) {
            count[point.view - 1] += 1;
        }
    }
    const double most = *std::max_element(count.begin(), count.end());
    std::vector<bool> shows;
    for (const double n : count) {
        shows.push_back(n > kLeastShare * most);
    }
    return shows;
}

// A polynomial over the distance from the seam.
Vector3d row_of(double u) {
    return {1, u, u * u};
}

/// Of the points of one flank on one stretch: the views' normal equations, where the surface under the points, which is
/// free, has been eliminated.
class Stretch {
public:
    explicit Stretch(Index views)
        : count_(VectorXd::Zero(views)),
          off_(VectorXd::Zero(views)),
          by_view_(Matrix3Xd::Zero(3, views)),
          normal_(Matrix3Xd::Zero(3, views)) {}

    void add(const SlabPoint& point, double unit_u, const Vector3d& n) {
        const Vector3d row = row_of(point.u / unit_u);
        const Index v = index(point.view) - 1;
        count_[v] += 1;
        off_[v] += point.off;
        by_view_.col(v) += row;
        normal_.col(v) += n;
        surface_ += row * row.transpose();
        surface_off_ += point.off * row;
    }
    const VectorXd& count() const { return count_; }
    /// M of the equations M x = y of what the views lie off each other.
    bool eliminate(MatrixXd& M, VectorXd& y) const {
        const Eigen::LDLT<Eigen::Matrix3d> ldlt(surface_);
        if (!(ldlt.vectorD().minCoeff() > 1e-9 * ldlt.vectorD().maxCoeff())) {
            return false;
        }
        M = MatrixXd(count_.asDiagonal()) - by_view_.transpose() * ldlt.solve(by_view_);
        y = off_ - by_view_.transpose() * ldlt.solve(surface_off_);
        return true;
    }
    /// What shifts by axis do along the normal.
    MatrixXd along_normal() const {
        MatrixXd H = MatrixXd::Zero(count_.size(), 3 * count_.size());
        for (Index v = 0; v < count_.size(); ++v) {
            H.block<1, 3>(v, 3 * v) = normal_.col(v).transpose() / std::max(1.0, count_[v]);
        }
        return H;
    }

private:
    VectorXd count_, off_;
    Matrix3Xd by_view_, normal_;
    Eigen::Matrix3d surface_ = Eigen::Matrix3d::Zero();
    Vector3d surface_off_ = Vector3d::Zero();
};

/// Over points: how often, and the powers of their distances u from the seam.
struct PowerSums {
    Eigen::Matrix<double, 5, 1> all = Eigen::Matrix<double, 5, 1>::Zero();
    Matrix3Xd by_view;

    explicit PowerSums(Index views) : by_view(Matrix3Xd::Zero(3, views)) {}
    void add(double u, Index view) {
        const double square = u * u;
        all += Eigen::Matrix<double, 5, 1>{1, u, square, square * u, square * square};
        by_view.col(view) += Vector3d(1, u, square);
    }
    /// Of a parabola through the points, at the seam; of their mean, where no distances tell one.
    ViewShares shares(double unit_u, const Vector3d& n) const {
        const Index views = by_view.cols();
        ViewShares shares{VectorXd::Zero(3 * views), VectorXd::Zero(views)};
        if (!(all[0] > 0)) {
            return shares;
        }
        const Vector3d unit = row_of(1 / unit_u);
        Eigen::Matrix3d normal;
        normal << all[0], all[1], all[2], all[1], all[2], all[3], all[2], all[3], all[4];
        normal = unit.asDiagonal() * normal * unit.asDiagonal();
        const Eigen::LDLT<Eigen::Matrix3d> ldlt(normal);
        const bool bent = ldlt.vectorD().minCoeff() > 1e-9 * ldlt.vectorD().maxCoeff();
        const Vector3d at_seam = bent ? Vector3d(ldlt.solve(Vector3d::UnitX())) : Vector3d(1 / all[0], 0, 0);
        shares.by_normal = by_view.transpose() * unit.cwiseProduct(at_seam);
        for (Index v = 0; v < views; ++v) {
            shares.by_axis.segment<3>(3 * v) = shares.by_normal[v] * n;
        }
        return shares;
    }
};

}  // namespace

/// Sums over the stretches of one flank of their equations M x = y, with H the normals that lead from shifts to x.
struct ViewShifts::Flank {
    MatrixXd M, M_H, H_M_H;
    VectorXd y, H_y;
    VectorXd weight;     ///< of each view's points, in their variance
    double squares = 0;  ///< of what the views explain of the points' distances
    double freedom = 0;

    Flank() = default;
    Flank(const MeasuredWay& way, std::size_t k);
    void add(const Stretch& stretch, double variance);
};

ViewShifts::Flank::Flank(const MeasuredWay& way, std::size_t k) {
    const Index views = index(way.tracker.view_starts.size());
    M = MatrixXd::Zero(views, views);
    M_H = MatrixXd::Zero(views, 3 * views);
    H_M_H = MatrixXd::Zero(3 * views, 3 * views);
    y = VectorXd::Zero(views);
    weight = VectorXd::Zero(views);
    H_y = VectorXd::Zero(3 * views);
    const std::vector<TrackPoint>& places = *way.places;
    const std::vector<bool> shows = views_that_show(places, k, way.tracker.view_starts.size());
    for (std::size_t begin = 0; begin < places.size(); begin += kStretch) {
        Stretch stretch(views);
        for (std::size_t i = begin; i < std::min(places.size(), begin + kStretch); ++i) {
            for (const SlabPoint& point : places[i].slab[k]) {
                if (shows[point.view - 1]) {
                    stretch.add(point, places[begin].along, normal_of(places[i], k));
                }
            }
        }
        const double correlation = way.tracker.scale_at(places[begin].section).correlation;
        add(stretch, std::pow(places[begin].flank_scale[k], 2) * correlation);
    }
}

void ViewShifts::Flank::add(const Stretch& stretch, double variance) {
    MatrixXd m;
    VectorXd right;
    if (!(variance > 0) || !stretch.eliminate(m, right)) {
        return;
    }
    const MatrixXd H = stretch.along_normal(), m_H = m * H / variance;
    M += m / variance;
    M_H += m_H;
    H_M_H += H.transpose() * m_H;
    y += right / variance;
    weight += stretch.count() / variance;
    H_y += H.transpose() * right / variance;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(m);
    for (Index v = 0; v < m.rows(); ++v) {
        if (eigen.eigenvalues()[v] > 1e-6 * eigen.eigenvalues()[m.rows() - 1]) {
            squares += std::pow(eigen.eigenvectors().col(v).dot(right), 2) / eigen.eigenvalues()[v] / variance;
            freedom += 1;
        }
    }
}

ViewShifts::ViewShifts(std::span<const MeasuredWay> ways, double registration)
    : views_(ways.front().tracker.view_starts.size()) {
    if (views_ < 2 || !(registration > 0)) {
        return;
    }
    std::vector<Flank> flanks(2 * ways.size());
    parallel_for(flanks.size(), 1, [&](std::size_t k) { flanks[k] = Flank(ways[k / 2], k % 2); });
    struct {
        double likelihood = -std::numeric_limits<double>::infinity(), noise = 1, bias = 0;
    } best;
    const double variance = registration * registration;
    for (const double noise : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) {
        for (const double bias : {0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0}) {
            if (const double likelihood = settle(flanks, variance, noise, bias); likelihood > best.likelihood) {
                best = {likelihood, noise, bias};
            }
        }
    }
    settle(flanks, variance, best.noise, best.bias);
}

// Biases are eliminated flank by flank. Returns the logarithm of the likelihood, but for a constant.
double ViewShifts::settle(const std::vector<Flank>& flanks, double shift_variance, double noise, double bias) {
    const Index n = index(views_), all = 3 * n;
    MatrixXd A = MatrixXd::Zero(all, all);
    VectorXd right = VectorXd::Zero(all);
    double logarithms = 0, squares = 0;
    bias_.clear();
    for (const Flank& flank : flanks) {
        const MatrixXd M = flank.M / noise, C = flank.M_H / noise;
        const VectorXd c = flank.y / noise;
        const VectorXd S = (flank.weight.array() > 0).select((bias / flank.weight.array()).sqrt(), 0);
        const Eigen::LDLT<MatrixXd> ldlt(MatrixXd::Identity(n, n) + S.asDiagonal() * M * S.asDiagonal());
        const MatrixXd G = S.asDiagonal() * ldlt.solve(MatrixXd(S.asDiagonal()));
        A += flank.H_M_H / noise - C.transpose() * G * C;
        right += flank.H_y / noise - C.transpose() * (G * c);
        logarithms += log_determinant(ldlt) + flank.freedom * std::log(noise);
        squares += flank.squares / noise - c.dot(G * c);
        bias_.push_back({G * c, G, G * C});
    }
    const Eigen::LDLT<MatrixXd> ldlt(MatrixXd::Identity(all, all) + shift_variance * A);
    shift_covariance_ = shift_variance * ldlt.solve(MatrixXd::Identity(all, all));
    shift_ = shift_covariance_ * right;
    for (Bias& of_flank : bias_) {
        of_flank.value -= of_flank.by_shift * shift_;
    }
    return -0.5 * (logarithms + log_determinant(ldlt) + squares - right.dot(shift_));
}

Vector3d ViewShifts::of(std::size_t flank, std::size_t view, const Vector3d& n) const {
    if (bias_.empty()) {
        return Vector3d::Zero();
    }
    return shift_.segment<3>(index(3 * view)) + bias_[flank].value[index(view)] * n;
}

double ViewShifts::of(std::size_t flank, const ViewShares& shares) const {
    return bias_.empty() ? 0 : shares.by_axis.dot(shift_) + shares.by_normal.dot(bias_[flank].value);
}

ViewShifts::Unknown ViewShifts::unknown(std::size_t flank, const ViewShares& shares) const {
    if (bias_.empty()) {
        return {VectorXd::Zero(3 * index(views_)), 0};
    }
    const Bias& bias = bias_[flank];
    const VectorXd a = shares.by_axis - bias.by_shift.transpose() * shares.by_normal;
    return {a, a.dot(shift_covariance_ * a) + shares.by_normal.dot(bias.covariance * shares.by_normal)};
}

double ViewShifts::covariance(const Unknown& one, const Unknown& other) const {
    return bias_.empty() ? 0 : one.by_shift.dot(shift_covariance_ * other.by_shift);
}

std::vector<ViewShares> shares_of_windows(const Tracker& tracker, const std::vector<TrackPoint>& way, std::size_t k) {
    const auto views = index(tracker.view_starts.size());
    const bool level = k == 1 && tracker.wall;
    std::vector<PowerSums> at(way.size(), PowerSums(views));
    for (std::size_t i = 0; i < way.size(); ++i) {
        for (const SlabPoint& point : way[i].slab[k]) {
            at[i].add(level ? 0 : point.u, index(point.view) - 1);
        }
    }
    std::vector<ViewShares> shares;
    for (std::size_t i = 0; i < way.size(); ++i) {
        const auto reach = static_cast<std::size_t>(std::lround(way[i].along / tracker.step));
        PowerSums window(views);
        for (std::size_t j = i > reach ? i - reach : 0; j < std::min(way.size(), i + reach + 1); ++j) {
            window.all += at[j].all;
            window.by_view += at[j].by_view;
        }
        shares.push_back(window.shares(way[i].along, normal_of(way[i], k)));
    }
    return shares;
}

void take_back(const Tracker& tracker, const ViewShifts& shifts, std::size_t first, std::vector<TrackPoint>& way) {
    std::vector<std::array<double, 2>> moved(way.size());  // each place, across both flanks
    for (const std::size_t k : {0u, 1u}) {
        const std::vector<ViewShares> shares = shares_of_windows(tracker, way, k);
        for (std::size_t i = 0; i < way.size(); ++i) {
            moved[i][k] = shifts.of(first + k, shares[i]);
        }
    }
    for (std::size_t i = 0; i < way.size(); ++i) {
        TrackPoint& at = way[i];
        for (const std::size_t k : {0u, 1u}) {
            const Vector3d& n = normal_of(at, k);
            for (SlabPoint& point : at.slab[k]) {
                const Vector3d shift = shifts.of(first + k, point.view - 1, n);
                point.p -= shift.cast<float>();
                point.off -= static_cast<float>(shift.dot(n) - moved[i][k]);
            }
        }
        Eigen::Matrix3d rows;
        rows << at.section.n1.transpose(), at.section.n2.transpose(), at.t.transpose();
        at.section.p -= rows.partialPivLu().solve(Vector3d(moved[i][0], moved[i][1], 0));
    }
}

}  // namespace seampath::detail
