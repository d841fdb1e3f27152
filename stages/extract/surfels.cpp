#include "stages/extract/surfels.hpp"

#include <cmath>
#include <numeric>

#include <Eigen/Dense>

#include "stages/extract/consistent.hpp"
#include "stages/extract/main_plane.hpp"
#include "stages/geometry/parallel.hpp"

namespace seampath::detail {
namespace {

constexpr std::size_t kLeastNeighbours = 6;
constexpr double kClear = 0.15;  // share of deciding rays that leaves no doubt; strays over a table decide fewer
constexpr double kHint = 0.02;   // share that still tells something
constexpr double kTouch = 1.8;   // cells; means of cells that share a corner are mostly nearer

void fit_surfel(Surfel& surfel, std::span<const std::uint32_t> neighbours, const std::vector<Surfel>& all) {
    if (neighbours.size() < kLeastNeighbours) {
        return;
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const std::uint32_t j : neighbours) {
        mean += all[j].p;
    }
    mean /= static_cast<double>(neighbours.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const std::uint32_t j : neighbours) {
        const Eigen::Vector3d d = all[j].p - mean;
        scatter += d * d.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(scatter);
    surfel.n = solver.eigenvectors().col(0);
    surfel.flatness = std::sqrt(std::max(0.0, solver.eigenvalues()[0]) / static_cast<double>(neighbours.size()));
}

// Appends what hangs together with the surfel inside the ball: the other face of a thin wall does not, though it is as
// near.
void collect_neighbours(const Surfels& surfels, std::uint32_t i, std::vector<std::uint32_t>& neighbours) {
    struct Buffers {
        std::vector<char> seen;  // all zero between calls
        std::vector<std::uint32_t> outside;
    };
    thread_local Buffers of_thread;
    auto& [marks, outside] = of_thread;
    marks.resize(std::max(marks.size(), surfels.at.size()), 0);
    outside.clear();
    char* const seen = marks.data();
    const Eigen::Vector3d p = surfels.at[i].p;
    const double squared = surfels.radius * surfels.radius;
    const std::size_t begin = neighbours.size();
    neighbours.push_back(i);
    seen[i] = 1;
    for (std::size_t k = begin; k < neighbours.size(); ++k) {
        for (const std::uint32_t j : surfels.next[neighbours[k]]) {
            if (!seen[j]) {
                seen[j] = 1;
                ((surfels.at[j].p - p).squaredNorm() <= squared ? neighbours : outside).push_back(j);
            }
        }
    }
    for (const std::uint32_t j : outside) {
        seen[j] = 0;
    }
    for (std::size_t k = begin; k < neighbours.size(); ++k) {
        seen[neighbours[k]] = 0;
    }
}

void orient_to_sensor(Surfels& surfels, const Eigen::Vector3d& sensor) {
    for (Surfel& s : surfels.at) {
        if (s.n.dot(sensor - s.p) < 0) {
            s.n = -s.n;
        }
    }
}

void orient_to_file_normals(Surfels& surfels, const PointGrid& grid, const Scan& scan) {
    for (std::size_t cell = 0; cell < surfels.at.size(); ++cell) {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (std::size_t k = 0; k < grid.points(cell).size(); ++k) {
            sum += scan.normals[grid.source(grid.first_point(cell) + k)];
        }
        if (surfels.at[cell].n.dot(sum.cast<double>()) < 0) {
            surfels.at[cell].n = -surfels.at[cell].n;
        }
    }
}

// Per piece: how many more of its normals are free than of their opposites. Returns the share of deciding rays in the
// largest piece.
double turn_outwards(Surfels& surfels, const PointGrid& grid) {
    std::vector<Surfel>& at = surfels.at;
    const Eigen::Vector3d low =
        std::accumulate(at.begin(), at.end(), at.front().p,
                        [](const Eigen::Vector3d& m, const Surfel& s) { return m.cwiseMin(s.p).eval(); });
    const Eigen::Vector3d high =
        std::accumulate(at.begin(), at.end(), at.front().p,
                        [](const Eigen::Vector3d& m, const Surfel& s) { return m.cwiseMax(s.p).eval(); });
    const double reach = std::min((high - low).norm(), 400 * grid.cell());
    const double start = 2 * grid.cell();  // past the surfel's own surface, not past a thin wall's other face
    const std::size_t stride = std::max<std::size_t>(1, at.size() / 4000);
    std::vector<int> vote(at.size(), 0);
    parallel_for((at.size() + stride - 1) / stride, 32, [&](std::size_t k) {
        const Surfel& s = at[k * stride];
        if (s.n.squaredNorm() > 0) {
            vote[k * stride] = static_cast<int>(blocked(grid, s.p, -s.n, start, reach)) -
                               static_cast<int>(blocked(grid, s.p, s.n, start, reach));
        }
    });
    std::vector<int> votes(at.size(), 0), size(at.size(), 0);
    for (std::size_t i = 0; i < at.size(); ++i) {
        votes[at[i].piece] += vote[i];
        ++size[at[i].piece];
    }
    for (Surfel& s : at) {
        const double clear = std::abs(votes[s.piece]) * static_cast<double>(stride) / size[s.piece];
        s.side = clear >= kClear ? AirSide::known : clear >= kHint ? AirSide::assumed : AirSide::unknown;
        if (votes[s.piece] < 0) {
            s.n = -s.n;
        }
    }
    const auto largest = std::max_element(size.begin(), size.end()) - size.begin();
    return std::abs(votes[static_cast<std::size_t>(largest)]) * static_cast<double>(stride) /
           size[static_cast<std::size_t>(largest)];
}

}  // namespace

Surfels make_surfels(const PointGrid& grid, double radius) {
    Surfels surfels;
    surfels.radius = radius;
    surfels.at.resize(grid.cells());
    parallel_for(grid.cells(), 256, [&](std::size_t i) { surfels.at[i].p = grid.mean(i); });
    const double touch = kTouch * grid.cell();
    surfels.next = {grid.cells(), [&](std::uint32_t i, std::vector<std::uint32_t>& next) {
                        const Eigen::Vector3d p = surfels.at[i].p, reach = Eigen::Vector3d::Constant(touch);
                        grid.for_cells_in_box(p - reach, p + reach, [&](std::size_t j) {
                            if (j != i && (surfels.at[j].p - p).squaredNorm() <= touch * touch) {
                                next.push_back(static_cast<std::uint32_t>(j));
                            }
                        });
                    }};
    surfels.neighbours = {grid.cells(), [&](std::uint32_t i, std::vector<std::uint32_t>& neighbours) {
                              collect_neighbours(surfels, i, neighbours);
                          }};
    parallel_for(grid.cells(), 256,
                 [&](std::size_t i) { fit_surfel(surfels.at[i], surfels.neighbours[i], surfels.at); });
    return surfels;
}

void orient(Surfels& surfels, const PointGrid& grid, const Scan& scan) {
    if (surfels.at.empty()) {
        return;
    }
    if (!scan.normals.empty()) {
        orient_to_file_normals(surfels, grid, scan);
        surfels.orientation_reason = "air side from the normals in the file";
        return;
    }
    if (scan.sensor_mm) {
        orient_to_sensor(surfels, *scan.sensor_mm - scan.origin_mm);
        surfels.orientation_reason = "air side from the sensor's place in the file";
        return;
    }
    make_consistent(surfels);
    const double clearness = turn_outwards(surfels, grid);
    const auto open =
        std::count_if(surfels.at.begin(), surfels.at.end(), [](const Surfel& s) { return s.side == AirSide::unknown; });
    const auto side = clearness < kClear ? turn_to_side_of_main_plane(surfels, grid) : std::nullopt;
    if (side) {
        surfels.orientation_reason = *side;
    } else if (2 * static_cast<std::size_t>(open) < surfels.at.size()) {
        surfels.orientation_reason = "air side is the one to which the surfaces are open";
    } else {
        surfels.orientation_reason =
            "the scan is open to both sides; the air is taken to be where the joints are concave";
    }
}

}  // namespace seampath::detail
