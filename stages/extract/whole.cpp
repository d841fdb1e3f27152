#include "stages/extract/whole.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "stages/extract/joint.hpp"
#include "stages/extract/pool.hpp"
#include "stages/extract/registration.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/surface_fit.hpp"

namespace seampath::detail {
namespace {

constexpr double kLeastTaken = 0.85;     // share of a flank's points that one surface must explain
constexpr double kMostScale = 1.3;       // of its residuals, in those of the windows' own surfaces
constexpr double kMedianSquare = 0.455;  // median of the square of a normal variable
constexpr double kRipple = 0.25;         // of its noise, rms, by which a scanner bends smooth surfaces
constexpr double kStandsOut = 16;        // squared: a place this many variances off the surface is of another one
constexpr double kAstray = 9;            // squared, of a window's surface off the whole one, in variances of both

/// Normal equations of a polynomial of the residuals over the distance from the seam.
struct BendProfile {
    static constexpr int kTerms = 3;
    using Vector = Eigen::Matrix<double, kTerms, 1>;
    using Matrix = Eigen::Matrix<double, kTerms, kTerms>;

    Matrix A = Matrix::Zero();
    Vector b = Vector::Zero();

    static Vector row(double u) { return {1, u, u * u}; }
    void add(double u, double r, double w) {
        A += w * row(u) * row(u).transpose();
        b += w * r * row(u);
    }
    BendProfile& operator+=(const BendProfile& o) {
        A += o.A, b += o.b;
        return *this;
    }
};

/// How the flank bends off the surface across the seam, alike along all of it: by how much at the seam, mm.
struct Bend {
    BendProfile::Vector c = BendProfile::Vector::Zero();
    double variance = 0;  ///< of c[0], mm^2
};

// The quadratic term is shrunk by its share of noise, which blocks of points may share; the others follow it.
Bend bend_of(const Pool& pool, const SurfaceFit& surface, double unit_u) {
    BendProfile all;
    std::vector<BendProfile::Vector> influence;
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        all.add(pool.u[i] / unit_u, surface.distance(pool.points[i]), surface.weight(pool.points[i]));
    }
    const BendProfile::Matrix cofactors = all.A.ldlt().solve(BendProfile::Matrix::Identity());
    const BendProfile::Vector c = cofactors * all.b;
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        const BendProfile::Vector row = BendProfile::row(pool.u[i] / unit_u);
        if (pool.station_block[i] >= influence.size()) {
            influence.resize(pool.station_block[i] + 1, BendProfile::Vector::Zero());
        }
        influence[pool.station_block[i]] +=
            surface.weight(pool.points[i]) * (surface.distance(pool.points[i]) - row.dot(c)) * row;
    }
    double variance = 0;
    for (const auto& g : influence) {
        variance += std::pow(cofactors.row(2).dot(g), 2);
    }
    const auto blocks = static_cast<double>(influence.size());
    variance =
        variance * blocks / std::max(1.0, blocks - 3) + std::pow(kRipple * surface.scale() * 6 * std::sqrt(5.0), 2);
    const double prior = std::max(0.0, c[2] * c[2] - variance), share = prior / std::max(1e-300, prior + variance);
    Bend bend;
    bend.c[2] = share * c[2];
    const Eigen::Vector2d lead = all.A.topLeftCorner<2, 2>().ldlt().solve(all.A.topRightCorner<2, 1>());
    bend.c.head<2>() = c.head<2>() + lead * (c[2] - bend.c[2]);
    bend.variance = lead[0] * lead[0] * share * variance;
    return bend;
}

/// What a place departs from the surface, at the seam, mm, by the points about it.
struct Departure {
    double value = 0, variance = 0;
};

// Straight lines through what is left of the residuals, over the distance from the seam, each of the places nearby.
std::vector<std::optional<Departure>> departures(const std::vector<TrackPoint>& way, const Pool& pool,
                                                 const SurfaceFit& surface, const Bend& bend, double unit_u) {
    std::vector<BendProfile> at(way.size());
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        const double u = pool.u[i] / unit_u;
        at[pool.place[i]].add(u, surface.distance(pool.points[i]) - BendProfile::row(u).dot(bend.c),
                              surface.weight(pool.points[i]));
    }
    const double variance = surface.scale() * surface.scale() * pool.correlation;
    std::vector<std::optional<Departure>> found(way.size());
    for (std::size_t i = 0; i < way.size(); ++i) {
        BendProfile sum;
        for (std::size_t j = i > pool.reach ? i - pool.reach : 0; j < std::min(way.size(), i + pool.reach + 1); ++j) {
            sum += at[j];
        }
        const Eigen::Matrix2d A = sum.A.topLeftCorner<2, 2>();
        if (A(0, 0) > 10 && A.determinant() > 1e-6 * A(0, 0) * A(1, 1)) {
            const Eigen::Matrix2d cofactors = A.inverse();
            found[i] = {cofactors.row(0).dot(sum.b.head<2>()), variance * cofactors(0, 0)};
        }
    }
    return found;
}

/// A flank as one surface: where it lies at each place, off the fitted shape, and how sure that is.
struct WholeFlank {
    SurfaceFit surface;
    std::vector<Departure> at;  ///< what is kept of the departures, and the variance of all
    std::vector<double> share;  ///< 0..1, how far each place goes by this surface and not by its own window
    std::vector<double> shift;  ///< variance that shifts of the views make, per variance of them
    double variance = 0;        ///< typical, of the place of the seam across the flank, mm^2
};

// How much of the modelled variance the departures show as noise: by second differences of windows side by side, which
// do not see waves longer than they. What the scan shows from window to window is its surface, whoever bent it.
double noise_share(const std::vector<std::optional<Departure>>& found, std::size_t lag) {
    constexpr double kLeast = 0.02, kMost = 4;
    constexpr std::size_t kEnough = 4;
    std::vector<double> ratio;
    for (std::size_t i = lag; i + lag < found.size(); ++i) {
        const auto &a = found[i - lag], &b = found[i], &c = found[i + lag];
        if (a && b && c) {
            const double difference = a->value - 2 * b->value + c->value;
            ratio.push_back(difference * difference / (a->variance + 4 * b->variance + c->variance));
        }
    }
    return ratio.size() < kEnough ? 1 : std::clamp(quantile(ratio, 0.5) / kMedianSquare, kLeast, kMost);
}

WholeFlank shrunk(const std::vector<TrackPoint>& way, int k, const Pool& pool, const SurfaceFit& surface) {
    std::vector<double> sorted = pool.u;
    const double unit_u = quantile(sorted, 0.9);
    const Bend bend = bend_of(pool, surface, unit_u);
    auto found = departures(way, pool, surface, bend, unit_u);
    const double noise = noise_share(found, 2 * pool.reach + 1);
    std::vector<double> squares, variances;
    for (auto& d : found) {
        if (d) {
            d->variance *= noise;
            squares.push_back(d->value * d->value);
            variances.push_back(d->variance);
        }
    }
    // A median of few independent values is unsure itself: what it exceeds noise by must exceed that, too.
    const double independent = static_cast<double>(way.size()) / static_cast<double>(2 * pool.reach + 1);
    const double by_noise = quantile(variances, 0.5) * (1 + 1.5 / std::sqrt(independent));
    const double prior = std::max(0.0, quantile(squares, 0.5) / kMedianSquare - by_noise);
    WholeFlank whole{surface, std::vector<Departure>(way.size(), {bend.c[0], prior}), {}, {}, 0};
    std::vector<double> total;
    for (std::size_t i = 0; i < way.size(); ++i) {
        if (found[i]) {
            const auto [value, variance] = *found[i];
            const bool stands_out = value * value > kStandsOut * (prior + variance);
            const double share = stands_out ? 1 : prior / (prior + variance);
            whole.at[i] = {bend.c[0] + share * value, share * variance};
        }
        const double sigma = surface.sigma(way[i].section.p);
        whole.at[i].variance += sigma * sigma + bend.variance;
        // Both come from the same points, so that the surer one is taken and not a mean of the two; no jump between
        // places. A window far off saw something else: points that depart together stand out of the surface itself.
        const double own = std::pow(way[i].flank_sigma[k], 2),
                     off = surface.distance(way[i].section.p) - whole.at[i].value;
        const bool astray = way[i].modelled || off * off > kAstray * (own + whole.at[i].variance);
        whole.share.push_back(astray ? 1 : own * own / (own * own + std::pow(whole.at[i].variance, 2)));
        total.push_back(whole.share[i] * whole.at[i].variance + (1 - whole.share[i]) * own);
    }
    whole.variance = quantile(total, 0.5);
    return whole;
}

// Whether the windows' own surfaces lie off this one by more than both are unsure of.
bool contradicted(const std::vector<TrackPoint>& way, int k, const WholeFlank& whole) {
    constexpr double kMost = 2;  // robust 1-sigma of the differences, in their own sigmas
    std::vector<double> squares;
    for (std::size_t i = 0; i < way.size(); ++i) {
        if (!way[i].modelled) {
            const double off = whole.surface.distance(way[i].section.p) - whole.at[i].value;
            squares.push_back(off * off / (std::pow(way[i].flank_sigma[k], 2) + whole.at[i].variance));
        }
    }
    return quantile(squares, 0.5) > kMost * kMost * kMedianSquare;
}

/// The surface nearest to all of a flank's points, and the flank as that surface where it explains them.
struct FlankFit {
    Pool pool;
    std::optional<SurfaceFit> nearest;
    std::optional<WholeFlank> whole;
};

FlankFit fit_flank(const Tracker& tracker, const std::vector<TrackPoint>& way, int k, double least_scale) {
    FlankFit best{pool_of(tracker, way, k), {}, {}};
    const Pool& pool = best.pool;
    if (pool.points.size() < 100) {
        return best;
    }
    for (const auto& surface : {fit_plane(pool.points, pool.block, pool.normals.front(), least_scale),
                                fit_cylinder(pool.points, pool.block, pool.places, pool.normals, least_scale)}) {
        if (!surface) {
            continue;
        }
        if (!best.whole && (!best.nearest || surface->scale() < best.nearest->scale())) {
            best.nearest = surface;
        }
        if (surface->share_taken() < kLeastTaken || surface->scale() > kMostScale * pool.scale) {
            continue;
        }
        WholeFlank whole = shrunk(way, k, pool, *surface);
        if ((!best.whole || whole.variance < best.whole->variance) && !contradicted(way, k, whole)) {
            best.nearest = surface;
            best.whole = std::move(whole);
        }
    }
    if (best.whole) {
        const ShiftOfSurface shift(best.whole->surface, pool);
        for (const TrackPoint& place : way) {
            best.whole->shift.push_back(shift.at(place.section.p));
        }
    }
    return best;
}

// Moves the place, within its section plane, to where both flanks meet.
void settle(TrackPoint& place, std::size_t i, const std::array<std::optional<WholeFlank>, 2>& whole) {
    const Eigen::Vector3d start = place.section.p, own[2] = {place.section.n1, place.section.n2};
    Eigen::Vector3d n[2] = {own[0], own[1]}, p = start;
    for (int round = 0; round < 8; ++round) {
        Eigen::Vector2d off;
        for (int k = 0; k < 2; ++k) {
            off[k] = own[k].dot(p - start);
            if (whole[k]) {
                const double share = whole[k]->share[i];
                n[k] = (share * whole[k]->surface.normal(p) + (1 - share) * own[k]).normalized();
                off[k] += share * (whole[k]->surface.distance(p) - whole[k]->at[i].value - off[k]);
            }
        }
        Eigen::Matrix3d A;
        A << n[0].transpose(), n[1].transpose(), place.t.transpose();
        const Eigen::Vector3d step = A.partialPivLu().solve(Eigen::Vector3d(-off[0], -off[1], place.t.dot(start - p)));
        p += step;
        if (step.norm() < 1e-10) {
            break;
        }
    }
    const Eigen::Vector3d axis = n[0].cross(n[1]);
    place.section = {p, n[0], n[1]};
    place.t = axis.normalized();
    place.bend = std::atan2(axis.norm(), n[0].dot(n[1]));
}

// Variance of the place across flank k: what noise leaves and, which no fit sees, what the views' shifts do.
double variance_across(const TrackPoint& place, std::size_t i, int k, const std::optional<WholeFlank>& whole,
                       double window_shift, double registration) {
    const double share = whole ? whole->share[i] : 0, shifts = registration * registration;
    const double own = std::pow(place.flank_sigma[k], 2) + shifts * window_shift;
    return (1 - share) * own + (whole ? share * (whole->at[i].variance + shifts * whole->shift[i]) : 0);
}

}  // namespace

SeamSurfaces settle_on_whole_flanks(const Tracker& tracker, double registration, std::vector<TrackPoint>& way) {
    const double least_scale = 0.3 * noise_of(tracker.scale_at(way[way.size() / 2].section));
    const std::array<FlankFit, 2> fits{fit_flank(tracker, way, 0, least_scale),
                                       fit_flank(tracker, way, 1, least_scale)};
    const std::array<std::optional<WholeFlank>, 2> whole{fits[0].whole, fits[1].whole};
    const std::vector<double> shift[2] = {shift_of_windows(tracker, way, 0), shift_of_windows(tracker, way, 1)};
    for (std::size_t i = 0; i < way.size(); ++i) {
        if (way[i].modelled && !(whole[0] && whole[1])) {
            continue;
        }
        settle(way[i], i, whole);
        double variance = 0;
        for (int k = 0; k < 2; ++k) {
            variance += variance_across(way[i], i, k, whole[k], shift[k][i], registration);
        }
        way[i].sigma = std::sqrt(variance) / std::max(1e-6, std::sin(way[i].bend));
    }
    const auto pooled = [](const FlankFit& fit) {
        return PooledFlank{&fit.pool, fit.nearest ? &*fit.nearest : nullptr, fit.whole.has_value()};
    };
    return joint_surfaces({pooled(fits[0]), pooled(fits[1])}, registration, least_scale);
}

}  // namespace seampath::detail
