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

constexpr int kDirections = 48;
constexpr double kSlope = 0.02;      // by which a sheet may leave the plane of its neighbourhood
constexpr double kLeastFull = 0.7;   // share of the sheet's density beside a border
constexpr double kMostEmpty = 0.25;  // of it beyond
constexpr double kLeastChance = 16;  // -ln of the chance of so empty a strip: e^-16 times all strips that are tried
constexpr std::size_t kLeastPoints = 150;

struct PlanePoint {
    double x, y;
};

/// The neighbourhood of a surfel as a plane.
struct Patch {
    Eigen::Vector3d p, e1, e2, n;
    std::vector<PlanePoint> points;  // of the sheet, within `reach` of p
};

Patch patch_at(const Around& around, const Surfel& surfel, double reach, double noise) {
    Patch patch;
    patch.p = surfel.p;
    patch.n = surfel.n;
    patch.e1 = surfel.n.unitOrthogonal();
    patch.e2 = surfel.n.cross(patch.e1);
    around.grid.for_points_in_ball(surfel.p, reach, [&](const Eigen::Vector3f& q, double) {
        const Eigen::Vector3d v = q.cast<double>() - patch.p;
        const PlanePoint at{v.dot(patch.e1), v.dot(patch.e2)};
        if (std::abs(v.dot(patch.n)) <= 3 * noise + kSlope * std::hypot(at.x, at.y)) {
            patch.points.push_back(at);
        }
    });
    return patch;
}

/// Cumulated numbers of points over the distance along one direction, in strips `half` to each side of the middle.
class Profile {
public:
    Profile(const Patch& patch, double angle, double half, double reach) : reach_(reach), step_(2 * reach / kSteps) {
        const double c = std::cos(angle), s = std::sin(angle);
        for (const PlanePoint& q : patch.points) {
            const double u = c * q.x + s * q.y, v = c * q.y - s * q.x;
            if (std::abs(v) <= half && std::abs(u) < reach) {
                sum_[1 + static_cast<std::size_t>((u + reach) / step_)] += 1;
            }
        }
        for (std::size_t i = 1; i < sum_.size(); ++i) {
            sum_[i] += sum_[i - 1];
        }
    }
    /// Points between two distances.
    double between(double a, double b) const { return at(b) - at(a); }

private:
    static constexpr std::size_t kSteps = 160;
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

// The emptiest strip beside a full one.
Found best_border(const Patch& patch, double spacing, double reach) {
    const double half = 0.6 * reach, strip = spacing, inner = 5 * spacing, length = 2 * half;
    Found best;
    for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * std::numbers::pi * k / kDirections;
        const Profile profile(patch, angle, half, 0.8 * reach);
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
    return best;
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
    const std::vector<std::size_t> chosen = spread_out(around.surfels, around.field, around.surfels.radius);
    std::vector<std::optional<Border>> found(chosen.size());
    parallel_for(chosen.size(), 16, [&](std::size_t k) {
        const Surfel& surfel = around.surfels.at[chosen[k]];
        const ScanScale scale = around.field.at(surfel.p);
        const Patch patch = patch_at(around, surfel, reach, std::max(scale.noise, 0.05 * scale.spacing));
        if (patch.points.size() < kLeastPoints) {
            return;
        }
        const Found best = best_border(patch, scale.spacing, reach);
        if (best.chance > kLeastChance) {
            const Eigen::Vector3d out = std::cos(best.angle) * patch.e1 + std::sin(best.angle) * patch.e2;
            found[k] = {patch.p + best.u * out, patch.n, out, best.density};
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
