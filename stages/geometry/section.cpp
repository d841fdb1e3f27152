#include "stages/geometry/section.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "stages/geometry/lot.hpp"

namespace seampath {
namespace {

constexpr double kGateSlope = 20 * std::numbers::pi / 180;

std::optional<SectionFrame> frame_of(const Section& section) {
    SectionFrame f;
    f.p = section.p;
    f.n[0] = section.n1;
    f.n[1] = section.n2;
    const Eigen::Vector3d axis = section.n1.cross(section.n2);
    if (axis.norm() < 1e-3) {
        return std::nullopt;
    }
    f.t = axis.normalized();
    f.d[0] = f.t.cross(section.n1);
    f.d[1] = section.n2.cross(f.t);
    return f;
}

// What two fits within a small window tell of the flanks.
using FirstLook = std::array<Flank, 2>;

// Points of both flanks within the window and no closer to the seam than its band. Without a first look at the flanks
// the gate is a wedge: it opens with the distance from the seam, so that a guess a few degrees off still sees its
// flank, but never reaches the other flank. After it each flank is carried on, and ends where it comes near to the
// other: the seam may bend within the window.
std::array<FlankPoints, 2> gather(const PointGrid& grid, const ScanScale& scale, const SectionFrame& f,
                                  const SectionWindows& windows, const FirstLook* look) {
    std::array<FlankPoints, 2> samples;
    const double sine = f.n[0].cross(f.n[1]).norm(), opening = std::numbers::pi - std::atan2(sine, f.n[0].dot(f.n[1]));
    const double slope = std::tan(std::min(0.3 * opening, kGateSlope)), base = 4 * scale.noise + scale.spacing;
    const double along = windows[0].along;
    const auto nearest = [&](std::size_t k) { return look ? -windows[k].away : windows[k].band; };
    const auto wanted = [&](std::size_t k, const Eigen::Vector3d& v, double u, double s, double z) {
        if (!look) {
            return std::abs(z) <= base + slope * u;
        }
        const double off = residual((*look)[k], u, s, z);
        if (std::abs(off) > gate((*look)[k], u, s)) {
            return false;
        }
        const Eigen::Vector3d foot = v - off * f.n[k];
        const std::size_t other = 1 - k;
        const double other_u = foot.dot(f.d[other]);
        return residual((*look)[other], other_u, s, foot.dot(f.n[other])) >=
               std::max(windows[other].band * sine, continuation_doubt((*look)[other], other_u, s));
    };
    // The box of the two flank rectangles.
    Eigen::Vector3d low = f.p, high = f.p;
    for (std::size_t k = 0; k < 2; ++k) {
        for (const double u : {nearest(k), windows[k].away}) {
            for (const double s : {-along, along}) {
                for (const double side : {-1.0, 1.0}) {
                    const double z =
                        look ? std::abs(residual((*look)[k], u, s, 0)) + gate((*look)[k], u, s) : base + slope * u;
                    const Eigen::Vector3d corner = f.p + u * f.d[k] + s * f.t + side * z * f.n[k];
                    low = low.cwiseMin(corner);
                    high = high.cwiseMax(corner);
                }
            }
        }
    }
    // The box of slanting flanks holds much besides them: no point of a cell is farther from its first than this.
    const double diagonal = std::sqrt(3.0) * grid.cell();
    const auto apart = [&](const Eigen::Vector3d& first) {
        const auto beside = [&](std::size_t k) {
            const double u = first.dot(f.d[k]);
            return u < nearest(k) - diagonal || u > windows[k].away + diagonal;
        };
        return std::abs(first.dot(f.t)) > along + diagonal || (beside(0) && beside(1));
    };
    grid.for_cells_in_box(low, high, [&](std::size_t cell) {
        if (apart(grid.points(cell).front().cast<double>() - f.p)) {
            return;
        }
        for (const Eigen::Vector3f& q : grid.points(cell)) {
            const Eigen::Vector3d v = q.cast<double>() - f.p;
            const double s = v.dot(f.t);
            if (std::abs(s) > along) {
                continue;
            }
            for (std::size_t k = 0; k < 2; ++k) {
                const double u = v.dot(f.d[k]), z = v.dot(f.n[k]);
                if (u >= nearest(k) && u <= windows[k].away && wanted(k, v, u, s, z)) {
                    samples[k].points.push_back(
                        {static_cast<float>(u), static_cast<float>(s), static_cast<float>(z), lot_of(q)});
                }
            }
        }
    });
    thin_out(samples[0]);
    thin_out(samples[1]);
    return samples;
}

// As much as bends and corners allow to be seen without knowing of them.
SectionWindows first_windows(const ScanScale& scale, const SectionWindows& windows) {
    const SectionWindow follow = following_window(scale);
    const auto first = [&](const SectionWindow& w) {
        return SectionWindow{std::min(w.along, follow.along), std::min(w.away, follow.away), w.band};
    };
    return {first(windows[0]), first(windows[1])};
}

std::optional<FirstLook> first_look(const PointGrid& grid, const ScanScale& scale, const SectionFrame& f,
                                    const SectionWindows& windows) {
    const SectionWindows near = first_windows(scale, windows);
    const auto samples = gather(grid, scale, f, near, nullptr);
    FirstLook look;
    for (std::size_t k = 0; k < 2; ++k) {
        auto flank = fit_flank(samples[k], scale, near[k]);
        if (!flank) {
            return std::nullopt;
        }
        look[k] = std::move(*flank);
    }
    return look;
}

// Distances of the point in which the flanks meet from the guess, along each of them: Newton's method in the section
// plane on u1 d1 + f1(u1) n1 = u2 d2 + f2(u2) n2. Empty when they do not meet within the limit. The quadratics do: what
// the fits know beyond them grows with the fourth power of the distance from the guess, on which the search closes in.
std::optional<Eigen::Vector2d> meet(const SectionFrame& f, const Flank (&flank)[2], double limit) {
    Eigen::Vector2d u(0, 0);
    const auto value = [&](int k) { return flank[k].fit.value(u[k] / flank[k].window.away, 0); };
    const auto slope = [&](int k) {
        const auto& c = flank[k].fit.coefficients();
        const double away = flank[k].window.away;
        return (c[1] + 2 * c[3] * u[k] / away) / away;
    };
    for (int iteration = 0; iteration < 20; ++iteration) {
        const Eigen::Vector3d gap = u[0] * f.d[0] + value(0) * f.n[0] - u[1] * f.d[1] - value(1) * f.n[1];
        const Eigen::Vector3d c0 = f.d[0] + slope(0) * f.n[0], c1 = f.d[1] + slope(1) * f.n[1];
        Eigen::Matrix2d J;
        J << f.d[0].dot(c0), -f.d[0].dot(c1), f.n[0].dot(c0), -f.n[0].dot(c1);
        const Eigen::Vector2d step = -J.partialPivLu().solve(Eigen::Vector2d(f.d[0].dot(gap), f.n[0].dot(gap)));
        if (!step.allFinite() || (u + step).cwiseAbs().maxCoeff() > limit) {
            return std::nullopt;
        }
        u += step;
        if (step.cwiseAbs().maxCoeff() < 1e-12 * limit) {
            break;
        }
    }
    return u;
}

}  // namespace

SectionWindows beside_wall(const ScanScale& scale, const SectionWindow& window, double height) {
    constexpr double kLeastBand = 1.5, kLeastNoises = 3;  // what corners blur, in point distances and in noises
    const double least = std::max(kLeastBand * scale.spacing, kLeastNoises * scale.noise);
    const double band = std::min(window.band, std::max(least, height / 5));
    return {window, {window.along, std::min(window.away, height - band), band}};
}

std::optional<SectionFit> fit_section(const PointGrid& grid, const ScanScale& scale, const Section& guess,
                                      const SectionWindows& windows) {
    const auto frame = frame_of(guess);
    if (!frame) {
        return std::nullopt;
    }
    const SectionFrame& f = *frame;
    auto look = first_look(grid, scale, f, windows);
    if (!look) {
        return std::nullopt;
    }
    const SectionWindows seen = first_windows(scale, windows);
    const auto wider = [&](std::size_t k) {
        return windows[k].along > seen[k].along || windows[k].away > seen[k].away;
    };
    if (wider(0) || wider(1)) {
        const auto samples = gather(grid, scale, f, windows, &*look);
        for (std::size_t k = 0; k < 2; ++k) {
            widen((*look)[k], samples[k], scale, windows[k]);
        }
    }
    SectionFit result;
    result.frame = f;
    for (std::size_t k = 0; k < 2; ++k) {
        result.flank[k] = std::move((*look)[k]);
        settle_flank(result.flank[k], scale);
    }
    const auto met = meet(f, result.flank, std::max(windows[0].away, windows[1].away));
    if (!met) {
        return std::nullopt;
    }
    const Eigen::Vector2d& u = *met;
    Eigen::Vector3d normal[2];
    for (int k = 0; k < 2; ++k) {
        finish_flank(result.flank[k], scale, u[k]);
        normal[k] = (f.n[k] - result.flank[k].slope * f.d[k] - result.flank[k].slope_along * f.t).normalized();
    }
    const Eigen::Vector3d offset = u[0] * f.d[0] + result.flank[0].height * f.n[0];
    const Eigen::Vector3d axis = normal[0].cross(normal[1]);
    result.section = {f.p + offset, normal[0], normal[1]};
    result.t = axis.normalized();
    result.bend = std::atan2(axis.norm(), normal[0].dot(normal[1]));
    result.shift = offset.norm();
    result.sigma = std::hypot(result.flank[0].sigma, result.flank[1].sigma) / std::max(1e-6, axis.norm());
    if (result.t.dot(f.t) < 0.5 || !result.section.p.allFinite()) {
        return std::nullopt;
    }
    return result;
}

std::optional<SectionFit> settle_section(const PointGrid& grid, const ScanScale& scale, const Section& guess,
                                         const SectionWindows& windows, int rounds) {
    auto fit = fit_section(grid, scale, guess, windows);
    const Eigen::Vector3d start = guess.p;
    for (int round = 1; round < rounds && fit; ++round) {
        const double before = fit->shift;
        // Keep to the section plane of the first guess, so that the point does not wander along the seam.
        Section next = fit->section;
        fit = fit_section(grid, scale, next, windows);
        if (fit && fit->shift < std::max(0.1 * fit->sigma, 1e-3 * scale.noise)) {
            break;
        }
        if (fit && round > 2 && fit->shift > before) {
            break;
        }
    }
    if (fit) {
        fit->shift = (fit->section.p - start).norm();
    }
    return fit;
}

}  // namespace seampath
