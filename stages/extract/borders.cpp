#include "stages/extract/borders.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

constexpr int kQuarterTurn = 12;     // directions of a quarter of a turn
constexpr double kSlope = 0.02;      // by which a sheet may leave the surface fitted to its middle
constexpr double kLeastFull = 0.7;   // share of the sheet's density beside a border
constexpr double kMostEmpty = 0.25;  // of it beyond
constexpr double kLeastChance = 16;  // -ln of the chance of so empty a strip: e^-16 times all strips that are tried
constexpr Eigen::Index kLeastPatchPoints = 150;

using Quadratic = Eigen::Vector<double, 6>;  // coefficients of 1, x, y, x^2, xy, y^2

/// The sheet around a surfel, over the plane of the surfel.
struct Patch {
    Eigen::Vector3d p, e1, e2, n;
    Quadratic height;     // of the sheet over (x, y)
    Eigen::ArrayXf x, y;  // of its points, within `reach` of p

    double height_at(double u, double v) const { return height.dot(Quadratic(1, u, v, u * u, u * v, v * v)); }
    Eigen::Vector3d normal_at(double u, double v) const {
        const double du = height[1] + 2 * height[3] * u + height[4] * v,
                     dv = height[2] + height[4] * u + 2 * height[5] * v;
        return (n - du * e1 - dv * e2).normalized();
    }
};

// Points by their places in the frame of a patch, mm; distance from its middle.
struct Placed {
    Eigen::ArrayXf x, y, z, far;

    template <typename Condition>
    Placed where(const Condition& keep) const {
        Placed kept{x, y, z, far};
        Eigen::Index count = 0;
        for (Eigen::Index i = 0; i < x.size(); ++i) {
            if (keep(i)) {
                kept.x[count] = x[i], kept.y[count] = y[i], kept.z[count] = z[i], kept.far[count] = far[i];
                ++count;
            }
        }
        for (Eigen::ArrayXf* column : {&kept.x, &kept.y, &kept.z, &kept.far}) {
            column->conservativeResize(count);
        }
        return kept;
    }
};

Placed placed(const PointGrid& grid, const Patch& frame, double reach) {
    std::vector<float> values[3];
    grid.for_points_in_ball(frame.p, reach, [&](const Eigen::Vector3f& q, double) {
        const Eigen::Vector3d v = q.cast<double>() - frame.p;
        values[0].push_back(static_cast<float>(v.dot(frame.e1)));
        values[1].push_back(static_cast<float>(v.dot(frame.e2)));
        values[2].push_back(static_cast<float>(v.dot(frame.n)));
    });
    const auto column = [&](std::size_t k) {
        return Eigen::Map<const Eigen::ArrayXf>(values[k].data(), static_cast<Eigen::Index>(values[k].size()));
    };
    return {column(0), column(1), column(2), (column(0).square() + column(1).square()).sqrt()};
}

// Points of `q` on the surface, which may leave it by `noise` and kSlope of their distance.
Placed on_sheet(const Placed& q, const Quadratic& height, double noise) {
    const Eigen::Vector<float, 6> h = height.cast<float>();
    const Eigen::ArrayXf off =
        (q.z - (h[0] + q.x * (h[1] + h[3] * q.x + h[4] * q.y) + q.y * (h[2] + h[5] * q.y))).abs() -
        static_cast<float>(kSlope) * q.far;
    return q.where([&](Eigen::Index i) { return off[i] <= static_cast<float>(noise); });
}

// The quadratic surface through the points; `start` where they don't determine one.
Quadratic fitted(const Placed& q, const Quadratic& start) {
    Eigen::Matrix<float, Eigen::Dynamic, 6> rows(q.x.size(), 6);
    rows << Eigen::ArrayXf::Ones(q.x.size()), q.x, q.y, q.x.square(), q.x * q.y, q.y.square();
    const Eigen::Matrix<float, 6, 6> normal = rows.transpose() * rows;
    const Eigen::Vector<float, 6> right = rows.transpose() * q.z.matrix();
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(normal.cast<double>());
    const Quadratic height = solver.solve(right.cast<double>());
    return solver.info() == Eigen::Success && height.allFinite() ? height : start;
}

// From the plane of the surfel to a surface that bends as the sheet around it does, and then as far as that holds.
Patch patch_at(const Around& around, const Surfel& surfel, double reach, double noise) {
    Patch patch;
    patch.p = surfel.p;
    patch.n = surfel.n;
    patch.e1 = surfel.n.unitOrthogonal();
    patch.e2 = surfel.n.cross(patch.e1);
    patch.height = Quadratic::Zero();
    const Placed all = placed(around.grid, patch, reach),
                 near = all.where([&](Eigen::Index i) { return all.far[i] <= static_cast<float>(reach / 2); });
    for (int round = 0; round < 2; ++round) {
        patch.height = fitted(on_sheet(near, patch.height, 3 * noise), patch.height);
    }
    Placed sheet = on_sheet(all, patch.height, 3 * noise);
    patch.x = std::move(sheet.x);
    patch.y = std::move(sheet.y);
    return patch;
}

/// Cumulated numbers of points over their distance along one direction, of those within `half` to each side of it.
class EdgeProfile {
public:
    /// u along the direction, v across it: of points within `reach` of the middle.
    EdgeProfile(const Eigen::ArrayXf& u, const Eigen::ArrayXf& v, double half, double reach)
        : reach_(reach), step_(2 * reach / kSteps) {
        const auto h = static_cast<float>(half), r = static_cast<float>(reach), per_mm = static_cast<float>(1 / step_);
        // What lies beside is put far behind the last step, and counted in a step of its own there: without a branch.
        constexpr float kBeside = kSteps, kFar = 1e9;
        const Eigen::ArrayXf bin = ((u + r) * per_mm + kFar * (v.abs() - h).max(0)).min(kBeside);
        const auto step_at = [](float b) {
            return static_cast<std::size_t>(static_cast<int>(b));
        };  // in one instruction
        // Two counts in turn: neighbours in the list often fall into one step, and would wait for each other.
        std::array<std::uint32_t, kSteps + 1> even{}, odd{};
        Eigen::Index i = 0;
        for (; i + 1 < bin.size(); i += 2) {
            ++even[step_at(bin[i])];
            ++odd[step_at(bin[i + 1])];
        }
        if (i < bin.size()) {
            ++even[step_at(bin[i])];
        }
        for (std::size_t k = 0; k < kSteps; ++k) {
            sum_[k + 1] = sum_[k] + even[k] + odd[k];
        }
        sum_[kSteps + 1] = sum_[kSteps];
    }
    /// The same, looked at from the other side.
    EdgeProfile reversed() const {
        EdgeProfile other = *this;
        for (std::size_t i = 0; i <= kSteps; ++i) {
            other.sum_[i] = sum_[kSteps] - sum_[kSteps - i];
        }
        return other;
    }
    /// Points between two distances.
    double between(double a, double b) const { return at(b) - at(a); }

private:
    static constexpr std::size_t kSteps = 200;
    double at(double u) const {
        const double x = std::clamp((u + reach_) / step_, 0.0, static_cast<double>(kSteps));
        const auto i = std::min(kSteps - 1, static_cast<std::size_t>(x));
        return sum_[i] + (x - static_cast<double>(i)) * (sum_[i + 1] - sum_[i]);
    }
    double reach_, step_;
    std::array<double, kSteps + 2> sum_{};
};

struct Found {
    double chance = 0, angle = 0, u = 0, density = 0;
};

// The emptiest strip beside a full one in one direction, when emptier than `best`.
void look_along(const EdgeProfile& profile, double angle, double spacing, double reach, Found& best) {
    const double strip = spacing, inner = 5 * spacing, length = 1.2 * reach;
    const double density = profile.between(-0.6 * reach, -0.6 * reach + 2 * inner) / (2 * inner * length);
    const double expected = density * strip * length;
    for (double u = -0.2 * reach; u + strip <= 0.75 * reach; u += 0.25 * spacing) {
        const double seen = profile.between(u, u + strip);
        if (seen > kMostEmpty * expected ||
            profile.between(u - inner - 0.5 * spacing, u - 0.5 * spacing) < kLeastFull * density * inner * length) {
            continue;
        }
        const double chance = expected - seen - (seen > 0 ? seen * std::log(expected / seen) : 0);
        if (chance > best.chance) {
            best = {chance, angle, u, density};
        }
    }
}

// In the directions of `angle` and of what is square to it.
void look_around(const Patch& patch, double angle, double spacing, double reach, Found& best) {
    const double half = 0.6 * reach;
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    const Eigen::ArrayXf u = patch.x * c + patch.y * s, v = patch.y * c - patch.x * s;
    for (const bool across : {false, true}) {
        const EdgeProfile profile = across ? EdgeProfile(v, u, half, reach) : EdgeProfile(u, v, half, reach);
        const double there = angle + (across ? std::numbers::pi / 2 : 0);
        look_along(profile, there, spacing, reach, best);
        look_along(profile.reversed(), there + std::numbers::pi, spacing, reach, best);
    }
}

Found best_border(const Patch& patch, double spacing, double reach) {
    Found best;
    constexpr double kStep = std::numbers::pi / 2 / kQuarterTurn;
    for (int k = 0; k < kQuarterTurn; ++k) {
        look_around(patch, k * kStep, spacing, reach, best);
    }
    // What is a border in a direction a few degrees off is a better one in its own.
    if (best.chance > kLeastChance) {
        const double rough = best.angle;
        for (const double part : {-0.5, -0.25, 0.25, 0.5}) {
            look_around(patch, rough + part * kStep, spacing, reach, best);
        }
    }
    return best;
}

Border border_of(const Patch& patch, const Found& found) {
    const double x = found.u * std::cos(found.angle), y = found.u * std::sin(found.angle);
    const Eigen::Vector3d n = patch.normal_at(x, y),
                          away = std::cos(found.angle) * patch.e1 + std::sin(found.angle) * patch.e2;
    return {patch.p + x * patch.e1 + y * patch.e2 + patch.height_at(x, y) * patch.n, n,
            (away - away.dot(n) * n).normalized(), found.density};
}

// One surfel of every cell of a coarser lattice: the flattest.
std::vector<std::size_t> spread_out(const Surfels& surfels, const ScaleField& field, double cell) {
    std::map<std::tuple<long, long, long>, std::size_t> chosen;
    for (std::size_t i = 0; i < surfels.at.size(); ++i) {
        const Surfel& s = surfels.at[i];
        const double flat = std::max(field.at(s.p).noise, 0.035 * surfels.radius);
        if (surfels.neighbours[i].size() < 20 || s.flatness > flat) {
            continue;
        }
        const auto key =
            std::tuple(std::lround(s.p.x() / cell), std::lround(s.p.y() / cell), std::lround(s.p.z() / cell));
        const auto [at, fresh] = chosen.try_emplace(key, i);
        if (!fresh && s.flatness < surfels.at[at->second].flatness) {
            at->second = i;
        }
    }
    std::vector<std::size_t> result;
    for (const auto& [key, i] : chosen) {
        result.push_back(i);
    }
    return result;
}

}  // namespace

std::vector<Border> find_borders(const Around& around) {
    const double reach = 2 * around.surfels.radius;
    const std::vector<std::size_t> chosen = spread_out(around.surfels, around.field, 0.5 * reach);
    std::vector<std::optional<Border>> found(chosen.size());
    parallel_for(chosen.size(), 16, [&](std::size_t k) {
        const Surfel& surfel = around.surfels.at[chosen[k]];
        const ScanScale scale = around.field.at(surfel.p);
        const Patch patch = patch_at(around, surfel, reach, std::max(scale.noise, 0.05 * scale.spacing));
        if (patch.x.size() < kLeastPatchPoints) {
            return;
        }
        const Found best = best_border(patch, scale.spacing, reach);
        if (best.chance > kLeastChance) {
            found[k] = border_of(patch, best);
        }
    });
    std::vector<Border> borders;
    for (const auto& border : found) {
        if (border) {
            borders.push_back(*border);
        }
    }
    return borders;
}

std::optional<Beyond> sheet_beyond(const Around& around, const Border& border, double reach, double lowest,
                                   double highest) {
    constexpr double kLeastDensity = 0.25;  // of the first sheet's: fewer views may see the other
    const ScanScale scale = around.field.at(border.p);
    const Eigen::Vector3d along = border.n.cross(border.out);
    const double half = around.surfels.radius, depth = 8 * scale.spacing,
                 bin = std::max(2 * scale.noise, 0.5 * scale.spacing);
    const auto bins = static_cast<std::size_t>((highest - lowest) / bin) + 1;
    struct At {
        double u, z;
    };
    std::vector<At> points;
    const Eigen::Vector3d middle = border.p + 0.5 * (reach + depth) * border.out + 0.5 * (lowest + highest) * border.n;
    const Eigen::Vector3d box = half * along.cwiseAbs() + 0.5 * (reach + depth) * border.out.cwiseAbs() +
                                0.5 * (highest - lowest) * border.n.cwiseAbs();
    around.grid.for_cells_in_box(middle - box, middle + box, [&](std::size_t cell) {
        for (const Eigen::Vector3f& q : around.grid.points(cell)) {
            const Eigen::Vector3d v = q.cast<double>() - border.p;
            const At at{v.dot(border.out), v.dot(border.n)};
            if (std::abs(v.dot(along)) < half && at.u > 0 && at.u < reach + depth && at.z > lowest && at.z < highest) {
                points.push_back(at);
            }
        }
    });
    // The height at which most points lie in one strip, which moves away from the border.
    std::optional<Beyond> best;
    for (double u = 0; u <= reach && !best; u += 2 * scale.spacing) {
        std::vector<double> count(bins, 0), height(bins, 0);
        for (const At& at : points) {
            if (at.u > u && at.u < u + depth) {
                const auto i = std::min(bins - 1, static_cast<std::size_t>((at.z - lowest) / bin));
                count[i] += 1;
                height[i] += at.z;
            }
        }
        double most = 0;
        std::size_t at_bin = 0;
        for (std::size_t i = 0; i + 1 < bins; ++i) {
            if (count[i] + count[i + 1] > most) {
                most = count[i] + count[i + 1];
                at_bin = i;
            }
        }
        if (most > kLeastDensity * border.density * depth * 2 * half) {
            best = Beyond{u, (height[at_bin] + height[at_bin + 1]) / most};
        }
    }
    if (!best) {
        return std::nullopt;
    }
    // Where it begins: as far from the strip's outer end as its points there make it.
    double inner = 0, outer = 0;
    const double from = best->gap + 0.5 * depth, to = best->gap + depth;
    for (const At& at : points) {
        const bool on = std::abs(at.z - best->height) < bin + kSlope * at.u;
        inner += on && at.u >= from && at.u < to;
        outer += on && at.u < from;
    }
    best->gap = inner > 0 ? std::max(0.0, from - outer / inner * (to - from)) : best->gap;
    return best;
}

}  // namespace seampath::detail
