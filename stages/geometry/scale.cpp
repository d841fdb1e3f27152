#include "stages/geometry/scale.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "stages/geometry/bulk.hpp"
#include "stages/geometry/grid.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr std::size_t kPlaces = 400;  // the median of so many is stable to a few per cent
constexpr std::size_t kNeighbours = 16;

// Distance of the k-th neighbour; the ball grows until it holds enough points.
double neighbour_distance(const PointGrid& grid, const Eigen::Vector3d& p, double limit) {
    std::vector<double> d2;
    for (double radius = grid.cell() / 4; radius <= limit; radius *= 2) {
        d2.clear();
        grid.for_points_in_ball(p, radius, [&](const Eigen::Vector3f&, double squared) { d2.push_back(squared); });
        if (d2.size() > kNeighbours) {
            std::nth_element(d2.begin(), d2.begin() + kNeighbours, d2.end());
            return std::sqrt(d2[kNeighbours]);
        }
    }
    return limit;
}

// A quadric over the best-fit plane of a ball.
struct Patch {
    bool valid = false;
    double scale = 0;        // robust 1-sigma of the residuals
    double correlation = 0;  // variance of block means over that of means of independent residuals; 0: too few blocks
};

// From second differences of the means of neighbouring blocks: they do not see trends, so that a surface that is not
// quite quadratic does not pass for correlated noise.
double block_correlation(const QuadraticFit& fit) {
    constexpr std::size_t kBlocks = 7;  // across the ball: wider than the correlation reaches, enough to average
    constexpr double kLeast = 5;        // residuals in a block
    std::array<std::array<double, kBlocks>, kBlocks> sum{}, count{};
    double within = 0, taken = 0;
    for (std::size_t i = 0; i < fit.size(); ++i) {
        if (fit.weight(i) > 0) {
            const auto column = [](double x) {
                return static_cast<std::size_t>(std::clamp((x + 1) / 2 * kBlocks, 0.0, kBlocks - 0.5));
            };
            sum[column(fit.u(i))][column(fit.s(i))] += fit.residual(i);
            count[column(fit.u(i))][column(fit.s(i))] += 1;
            within += fit.residual(i) * fit.residual(i);
            taken += 1;
        }
    }
    double found = 0, independent = 0;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t da, std::size_t db) {
        const double n[3] = {count[a][b], count[a + da][b + db], count[a + 2 * da][b + 2 * db]};
        if (std::min({n[0], n[1], n[2]}) >= kLeast) {
            const double difference =
                sum[a][b] / n[0] - 2 * sum[a + da][b + db] / n[1] + sum[a + 2 * da][b + 2 * db] / n[2];
            found += difference * difference;
            independent += within / taken * (1 / n[0] + 4 / n[1] + 1 / n[2]);
        }
    };
    for (std::size_t a = 0; a < kBlocks; ++a) {
        for (std::size_t b = 0; b + 2 < kBlocks; ++b) {
            add(a, b, 0, 1);
            add(b, a, 1, 0);
        }
    }
    return independent > 0 ? found / independent : 0;
}

// The points of the ball, relative to its centre; some more than `most` when there are more.
std::vector<Eigen::Vector3d> points_in_ball(const PointGrid& grid, const Eigen::Vector3d& p, double radius,
                                            std::size_t most) {
    std::vector<Eigen::Vector3d> q;
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius);
    grid.for_cells_in_box(p - reach, p + reach, [&](std::size_t cell) {
        if (q.size() <= most) {
            for (const Eigen::Vector3f& x : grid.points(cell)) {
                const Eigen::Vector3d d = x.cast<double>() - p;
                if (d.squaredNorm() <= radius * radius) {
                    q.push_back(d);
                }
            }
        }
    });
    return q;
}

// Over a ball of `width` point distances. A place that lies off the surfaces is as far from its neighbours as from much
// else, and tells nothing.
Patch fit_patch(const PointGrid& grid, const Eigen::Vector3d& p, double spacing, double width) {
    constexpr double kMost = 8;  // of the points that one surface has there; three meet in a corner
    const double radius = width * spacing;
    const auto most = static_cast<std::size_t>(kMost * std::numbers::pi * width * width);
    const std::vector<Eigen::Vector3d> q = points_in_ball(grid, p, radius, most);
    if (q.size() < 20 || q.size() > most) {
        return {};
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& x : q) {
        mean += x;
    }
    mean /= static_cast<double>(q.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& x : q) {
        scatter += (x - mean) * (x - mean).transpose();
    }
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
    QuadraticFit fit;
    fit.begin(q.size());
    for (const auto& x : q) {
        const Eigen::Vector3d local = axes.transpose() * (x - mean) / radius;
        fit.add(local[1], local[2], local[0] * radius);
    }
    if (!fit.solve(0)) {
        return {};
    }
    return {true, fit.scale(), block_correlation(fit)};
}

std::vector<Patch> fit_patches(const PointGrid& grid, const std::vector<Eigen::Vector3d>& places,
                               const std::vector<double>& spacing, double width) {
    std::vector<Patch> patches(places.size());
    parallel_for(places.size(), 4, [&](std::size_t k) { patches[k] = fit_patch(grid, places[k], spacing[k], width); });
    return patches;
}

// Of the patches' residual scales, each divided by its unit. Places on edges are rough for another reason: look below
// the median.
double typical_scale(const std::vector<Patch>& patches, const std::vector<double>& unit) {
    std::vector<double> scales;
    for (std::size_t k = 0; k < patches.size(); ++k) {
        if (patches[k].valid) {
            scales.push_back(patches[k].scale / unit[k]);
        }
    }
    return quantile(scales, 0.4);
}

// Wide balls show noise that neighbours share over more than its own range. Only the smooth ones count; what they see
// as noise is less biased than what a small ball leaves, too.
void refine_by_wide_balls(ScanScale& overall, const std::vector<Patch>& wide) {
    const std::vector<double> one(wide.size(), 1);
    const double smooth = 1.3 * typical_scale(wide, one);
    std::vector<double> scales, correlations;
    for (const Patch& patch : wide) {
        if (patch.valid && patch.scale <= smooth && patch.correlation > 0) {
            scales.push_back(patch.scale);
            correlations.push_back(patch.correlation);
        }
    }
    // On a part with no smooth place of that size the smaller balls have to do.
    const double wide_noise = quantile(scales, 0.5);
    if (!scales.empty() && wide_noise < 2 * overall.noise) {
        overall.noise = std::max(overall.noise, wide_noise);
        overall.correlation = std::clamp(quantile(correlations, 0.5), 1.0, 60.0);
    }
}

// Each place by what its nearest ones say together: single patches hang on a hundred points, some of them across an
// edge.
std::vector<ScanScale> smoothed(const ScaleField& field, const std::vector<double>& spacing,
                                const std::vector<Patch>& patches, double noise_factor) {
    constexpr std::size_t kNearest = 13;
    std::vector<ScanScale> local(field.place.size(), field.overall);
    parallel_for(local.size(), 16, [&](std::size_t k) {
        std::vector<std::pair<double, std::size_t>> near;
        for (std::size_t j = 0; j < field.place.size(); ++j) {
            near.emplace_back((field.place[j] - field.place[k]).squaredNorm(), j);
        }
        const std::size_t count = std::min(kNearest, near.size());
        std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
        std::vector<double> spacings, scales;
        for (std::size_t i = 0; i < count; ++i) {
            spacings.push_back(spacing[near[i].second]);
            if (patches[near[i].second].valid) {
                scales.push_back(patches[near[i].second].scale);
            }
        }
        local[k].spacing = quantile(spacings, 0.5);
        if (!scales.empty()) {
            local[k].noise = noise_factor * quantile(scales, 0.4);
        }
    });
    return local;
}

}  // namespace

ScanScale ScaleField::at(const Eigen::Vector3d& p) const {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < place.size(); ++k) {
        const double squared = (place[k] - p).squaredNorm();
        if (squared < least) {
            least = squared;
            nearest = k;
        }
    }
    return place.empty() ? overall : local[nearest];
}

ScaleField estimate_scale(std::span<const Eigen::Vector3f> points) {
    ScaleField field;
    ScanScale& overall = field.overall;
    const double extent = points.size() < 50 ? 0 : bulk_of(points).extent;
    if (extent <= 0) {
        return field;
    }
    const PointGrid grid(points, extent / 128, without_strays(points));
    std::vector<Eigen::Vector3d>& places = field.place;
    for (std::size_t k = 0; k < kPlaces; ++k) {
        // Through the points in the order of space, so that the choice does not hang on the order of the file.
        places.push_back(grid.mean((2 * k + 1) * grid.cells() / (2 * kPlaces)));
    }
    std::vector<double> spacing(places.size());
    parallel_for(places.size(), 16, [&](std::size_t k) {
        spacing[k] = neighbour_distance(grid, places[k], extent) * std::sqrt(std::numbers::pi / kNeighbours);
    });
    std::vector<double> sorted = spacing;
    overall.spacing = quantile(sorted, 0.5);
    if (overall.spacing <= 0) {
        return field;
    }
    // Balls as wide as six point distances, each by its own; where noise exceeds the spacing a wider one is needed to
    // see a surface.
    for (double& h : spacing) {
        h = std::max(h, 1e-3 * overall.spacing);
    }
    double widths = 6, ratio = 0;
    std::vector<Patch> patches;
    for (int round = 0; round < 4; ++round) {
        patches = fit_patches(grid, places, spacing, widths);
        ratio = typical_scale(patches, spacing);
        if (6 * ratio <= widths) {
            break;
        }
        widths = 8 * ratio;
    }
    const std::vector<double> one(places.size(), 1);
    const double small_ball_noise = overall.noise = typical_scale(patches, one);
    std::vector<Eigen::Vector3d> fewer;
    std::vector<double> fewer_spacing;
    for (std::size_t k = 0; k < places.size(); k += 2) {
        fewer.push_back(places[k]);
        fewer_spacing.push_back(spacing[k]);
    }
    refine_by_wide_balls(overall, fit_patches(grid, fewer, fewer_spacing, 4.5 * widths));
    field.local = smoothed(field, spacing, patches, small_ball_noise > 0 ? overall.noise / small_ball_noise : 1);
    return field;
}

}  // namespace seampath
