#include "pipeline/report_thin.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace seampath {
namespace {

constexpr std::size_t kNearBudget = 120'000, kFarBudget = 80'000;

/// The neighbourhood of a seam that is shown densely: this share of the seams' extent, within these bounds.
constexpr double kNearShare = 0.06, kNearLeastMm = 4, kNearMostMm = 40;

/// Cells for the normals hold about so many points each; a normal takes those within one cell size, some three times
/// that.
constexpr double kPointsPerCell = 7;

using Key = std::uint64_t;

/// Cells of a regular grid, numbered; 21 bits an axis.
struct Grid {
    Eigen::Vector3f low{0, 0, 0};
    float size = 1;

    Eigen::Vector3i cell(const Eigen::Vector3f& p) const {
        return ((p - low) / size).array().floor().max(0.F).min(2e6F).cast<int>();
    }
    static Key key(const Eigen::Vector3i& c) {
        return static_cast<Key>(c.x() + 1) << 42 | static_cast<Key>(c.y() + 1) << 21 | static_cast<Key>(c.z() + 1);
    }
};

void sort_unique(std::vector<Key>& keys) {
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

template <class Function>
void for_cells_around(const Eigen::Vector3i& cell, Function&& function) {
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                function(Grid::key(cell + Eigen::Vector3i(x, y, z)));
            }
        }
    }
}

/// The cells around the seams: a scan point is near when its cell is among them. Steps along a seam are shorter than a
/// cell.
struct Corridor {
    Grid grid;
    std::vector<Key> cells;
    Eigen::AlignedBox3f box;

    bool holds(const Eigen::Vector3f& p) const {
        return box.contains(p) && std::binary_search(cells.begin(), cells.end(), Grid::key(grid.cell(p)));
    }
};

Corridor corridor_of(const std::vector<Seam>& seams, const Eigen::Vector3d& origin) {
    Corridor corridor;
    for (const Seam& seam : seams) {
        for (const SeamPoint& point : seam.points) {
            corridor.box.extend((point.p - origin).cast<float>());
        }
    }
    if (corridor.box.isEmpty()) {
        return corridor;
    }
    const double extent = static_cast<double>(corridor.box.diagonal().norm());
    corridor.grid.size = static_cast<float>(std::clamp(kNearShare * extent, kNearLeastMm, kNearMostMm));
    const Eigen::Vector3f margin = Eigen::Vector3f::Constant(2 * corridor.grid.size);
    corridor.box.extend(corridor.box.min() - margin).extend(corridor.box.max() + margin);
    corridor.grid.low = corridor.box.min();
    for (const Seam& seam : seams) {
        for (std::size_t i = 0; i < seam.points.size(); ++i) {
            const Eigen::Vector3d a = seam.points[i].p, b = seam.points[std::min(i + 1, seam.points.size() - 1)].p;
            const int steps = 1 + static_cast<int>((b - a).norm() / static_cast<double>(corridor.grid.size));
            for (int s = 0; s < steps; ++s) {
                const Eigen::Vector3d p = a + (b - a) * s / steps;
                for_cells_around(corridor.grid.cell((p - origin).cast<float>()),
                                 [&](Key key) { corridor.cells.push_back(key); });
            }
        }
        sort_unique(corridor.cells);
    }
    return corridor;
}

/// splitmix64 (Steele, Lea, Flood 2014): an even spread of the index over 64 bits.
std::uint64_t mixed(std::uint64_t i) {
    i += 0x9e3779b97f4a7c15;
    i = (i ^ (i >> 30)) * 0xbf58476d1ce4e5b9;
    i = (i ^ (i >> 27)) * 0x94d049bb133111eb;
    return i ^ (i >> 31);
}

/// Points whose mixed index is at most this are kept. The budget is met by chance, so it is aimed at from 2 % below: at
/// these numbers more than six standard deviations.
std::uint64_t threshold(std::size_t budget, std::size_t count) {
    if (count <= budget) {
        return std::numeric_limits<std::uint64_t>::max();
    }
    return static_cast<std::uint64_t>(0.98 * static_cast<double>(budget) / static_cast<double>(count) * 0x1p64);
}

/// Points sorted by cell; `cells[k]` begins at `start[k]` of `order`.
struct Cells {
    std::vector<Key> cells;
    std::vector<std::uint32_t> start;
    std::vector<std::uint32_t> order;
};

Cells sorted_cells(const std::vector<Eigen::Vector3f>& points, const Grid& grid) {
    std::vector<std::pair<Key, std::uint32_t>> keyed(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        keyed[i] = {Grid::key(grid.cell(points[i])), i};
    }
    std::sort(keyed.begin(), keyed.end());
    Cells sorted;
    for (std::uint32_t i = 0; i < keyed.size(); ++i) {
        if (i == 0 || keyed[i].first != keyed[i - 1].first) {
            sorted.cells.push_back(keyed[i].first);
            sorted.start.push_back(i);
        }
        sorted.order.push_back(keyed[i].second);
    }
    sorted.start.push_back(static_cast<std::uint32_t>(keyed.size()));
    return sorted;
}

/// A grid whose occupied cells hold about kPointsPerCell points. Halving the cells of a surface quarters their content,
/// so three corrections are plenty.
Grid grid_for(const std::vector<Eigen::Vector3f>& points) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& p : points) {
        box.extend(p);
    }
    Grid grid{box.min(), std::max(1e-3F, box.diagonal().norm() / 100)};
    for (int pass = 0; pass < 3; ++pass) {
        std::vector<Key> keys(points.size());
        std::transform(points.begin(), points.end(), keys.begin(),
                       [&](const auto& p) { return Grid::key(grid.cell(p)); });
        sort_unique(keys);
        const double filled = static_cast<double>(points.size()) / static_cast<double>(keys.size());
        grid.size *= static_cast<float>(std::sqrt(kPointsPerCell / filled));
    }
    return grid;
}

/// Direction of least spread of the neighbours within `reach`; zero when there are too few.
Eigen::Vector3f normal_at(const Eigen::Vector3f& p, const std::vector<Eigen::Vector3f>& neighbours, float reach) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
    int count = 0;
    for (const Eigen::Vector3f& q : neighbours) {
        const Eigen::Vector3f d = q - p;
        if (d.squaredNorm() < reach * reach) {
            sum += d;
            squares += d * d.transpose();
            ++count;
        }
    }
    if (count < 5) {
        return Eigen::Vector3f::Zero();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
    solver.computeDirect(squares - sum * sum.transpose() / static_cast<float>(count));
    return solver.eigenvectors().col(0);
}

void add_normals(ViewCloud& cloud) {
    if (cloud.points.empty()) {
        return;
    }
    const Grid grid = grid_for(cloud.points);
    const Cells sorted = sorted_cells(cloud.points, grid);
    cloud.spacing_mm = grid.size / static_cast<float>(std::sqrt(kPointsPerCell));
    cloud.normals.assign(cloud.points.size(), Eigen::Vector3f::Zero());
    std::vector<Eigen::Vector3f> neighbours;
    for (std::size_t k = 0; k < sorted.cells.size(); ++k) {
        neighbours.clear();
        for_cells_around(grid.cell(cloud.points[sorted.order[sorted.start[k]]]), [&](Key key) {
            const auto found = std::lower_bound(sorted.cells.begin(), sorted.cells.end(), key);
            if (found == sorted.cells.end() || *found != key) {
                return;
            }
            const auto cell = static_cast<std::size_t>(found - sorted.cells.begin());
            for (std::uint32_t i = sorted.start[cell]; i < sorted.start[cell + 1]; ++i) {
                neighbours.push_back(cloud.points[sorted.order[i]]);
            }
        });
        for (std::uint32_t i = sorted.start[k]; i < sorted.start[k + 1]; ++i) {
            cloud.normals[sorted.order[i]] = normal_at(cloud.points[sorted.order[i]], neighbours, grid.size);
        }
    }
}

}  // namespace

std::array<ViewCloud, 2> thin_scan(const Scan& scan, const std::vector<Seam>& seams, const Eigen::Vector3d& centre) {
    const Corridor corridor = corridor_of(seams, scan.origin_mm);
    std::vector<bool> near(scan.points.size());
    std::transform(scan.points.begin(), scan.points.end(), near.begin(),
                   [&](const auto& p) { return corridor.holds(p); });
    const auto near_count = static_cast<std::size_t>(std::count(near.begin(), near.end(), true));
    const std::size_t far_count = near.size() - near_count;
    // What one part leaves of its budget, the other takes.
    const std::size_t budget = kNearBudget + kFarBudget;
    const std::size_t far_budget = std::max(kFarBudget, budget - std::min(budget, near_count));
    const std::size_t near_budget = std::max(kNearBudget, budget - std::min(budget, far_count));
    const std::uint64_t keep_near = threshold(near_budget, near_count), keep_far = threshold(far_budget, far_count);

    std::array<ViewCloud, 2> clouds;
    const Eigen::Vector3d shift = scan.origin_mm - centre;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        if (mixed(i) <= (near[i] ? keep_near : keep_far)) {
            clouds[near[i] ? 0 : 1].points.emplace_back((scan.points[i].cast<double>() + shift).cast<float>());
        }
    }
    for (ViewCloud& cloud : clouds) {
        add_normals(cloud);
    }
    return clouds;
}

}  // namespace seampath
