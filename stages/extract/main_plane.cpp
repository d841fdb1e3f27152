#include "stages/extract/main_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

// All of a scan, or a piece of it.
struct Scope {
    const Surfels& surfels;
    const PointGrid& grid;
    std::optional<std::uint32_t> piece;
    bool holds(const Surfel& s) const { return !piece || s.piece == *piece; }
};

// The plane that holds most surfels: the plate that the part is, or the table that it lies on.
struct MainPlane {
    Eigen::Vector3d n{0, 0, 0};
    double d = 0, share = 0;
    bool holds(const Surfel& s, double reach) const {
        return std::abs(n.dot(s.p) - d) < reach && std::abs(n.dot(s.n)) > 0.9;
    }
};

MainPlane main_plane(const Scope& scope, double reach) {
    constexpr std::size_t kCandidates = 120;
    std::vector<const Surfel*> within;
    for (const Surfel& s : scope.surfels.at) {
        if (scope.holds(s)) {
            within.push_back(&s);
        }
    }
    std::vector<MainPlane> planes(std::min(kCandidates, within.size()));
    parallel_for(planes.size(), 4, [&](std::size_t k) {
        const Surfel& s = *within[(2 * k + 1) * within.size() / (2 * planes.size())];
        MainPlane plane{s.n, s.n.dot(s.p), 0};
        for (const Surfel* q : within) {
            plane.share += plane.holds(*q, reach);
        }
        plane.share /= static_cast<double>(within.size());
        planes[k] = plane;
    });
    return *std::max_element(planes.begin(), planes.end(),
                             [](const MainPlane& a, const MainPlane& b) { return a.share < b.share; });
}

// Walls that stand on the plane, along its outline and elsewhere.
struct Walls {
    double along_outline = 0, inside = 0;  // surfels at their feet
    double height = 0;                     // of those along the outline, mm
    bool at_outline = false;               // most of them
    bool opposite = false;                 // on opposite sides of it
    bool are_edges = false;                // the plane's own
};

// How far a wall goes on from its foot along `up`, mm.
double height_of_wall(const Surfels& surfels, const PointGrid& grid, const Surfel& foot, const Eigen::Vector3d& up,
                      double most) {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(grid.cell());
    double height = 0;
    for (double u = grid.cell(); u < most && u < height + 3 * grid.cell(); u += grid.cell()) {
        const Eigen::Vector3d q = foot.p + u * up;
        grid.for_cells_in_box(q - half, q + half, [&](std::size_t j) {
            if (std::abs(surfels.at[j].n.dot(up)) < 0.5) {
                height = u;
            }
        });
    }
    return height;
}

// Whether the plane is seen on the far side of a wall whose foot is at p, too; `out` points there.
bool goes_on_behind(const Surfels& surfels, const PointGrid& grid, const MainPlane& plane, const Eigen::Vector3d& p,
                    const Eigen::Vector3d& out, double reach) {
    const double cell = grid.cell();
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(cell), foot = p - (plane.n.dot(p) - plane.d) * plane.n;
    int seen = 0;
    for (double u = 3 * cell; u < reach && seen < 3; u += cell) {
        bool here = false;
        const Eigen::Vector3d q = foot + u * out;
        grid.for_cells_in_box(q - half, q + half,
                              [&](std::size_t j) { here = here || plane.holds(surfels.at[j], cell); });
        seen += here;
    }
    return seen >= 3;
}

// Whether many of these directions have many that are opposite to them.
bool any_opposite(const std::vector<Eigen::Vector3d>& directions) {
    constexpr double kMany = 0.1;
    const auto alike = [&](const Eigen::Vector3d& d) {
        return static_cast<double>(std::count_if(directions.begin(), directions.end(), [&](const Eigen::Vector3d& e) {
                   return d.dot(e) > 0.85;
               })) > kMany * static_cast<double>(directions.size());
    };
    for (std::size_t i = 0; i < directions.size(); i += 1 + directions.size() / 50) {
        if (alike(directions[i]) && alike(-directions[i])) {
            return true;
        }
    }
    return false;
}

// Across the shorter way, of the rectangle that spreads as these points of a plane do.
double width_of(const std::vector<Eigen::Vector3d>& members) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : members) {
        mean += p / static_cast<double>(members.size());
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& p : members) {
        spread += (p - mean) * (p - mean).transpose() / static_cast<double>(members.size());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread, Eigen::EigenvaluesOnly);
    return std::sqrt(12 * std::max(0.0, solver.eigenvalues()[1]));
}

// The walls on the side of the plane's normal.
Walls walls_on(const Scope& scope, const MainPlane& plane) {
    constexpr double kLow = 0.2;   // of the plane's width; a higher wall may be a part of its own
    constexpr double kFew = 0.05;  // of the outline of a square as large
    const auto& [surfels, grid, piece] = scope;
    const double cell = grid.cell(), reach = 400 * cell;
    Walls walls;
    std::vector<double> heights;
    std::vector<Eigen::Vector3d> members, outwards;
    for (std::size_t i = 0; i < surfels.at.size(); ++i) {
        const Surfel& s = surfels.at[i];
        if (!scope.holds(s)) {
            continue;
        }
        const double height = plane.n.dot(s.p) - plane.d;
        if (plane.holds(s, cell)) {
            members.push_back(s.p);
        }
        if (height < 1.5 * cell || height > 4 * cell || std::abs(s.n.dot(plane.n)) > 0.5) {
            continue;
        }
        // Which way the plane lies from the foot of the wall.
        Eigen::Vector3d towards = Eigen::Vector3d::Zero();
        for (const std::uint32_t j : surfels.neighbours[i]) {
            if (plane.holds(surfels.at[j], cell)) {
                towards += surfels.at[j].p - s.p;
            }
        }
        towards -= towards.dot(plane.n) * plane.n;
        if (towards.norm() < cell) {
            continue;
        }
        const Eigen::Vector3d out = -towards.normalized();
        if (goes_on_behind(surfels, grid, plane, s.p, out, reach)) {
            walls.inside += 1;
        } else {
            walls.along_outline += 1;
            outwards.push_back(out);
            heights.push_back(height_of_wall(surfels, grid, s, plane.n, reach) + height);
        }
    }
    walls.height = quantile(heights, 0.5);
    // A few surfels of strays are no wall.
    const double outline = 4 * std::sqrt(static_cast<double>(members.size()));
    walls.at_outline = walls.along_outline > std::max(walls.inside, kFew * outline);
    walls.opposite = any_opposite(outwards);
    walls.are_edges = walls.at_outline && (walls.opposite || walls.height < kLow * width_of(members));
    return walls;
}

// Turns the normals of the scope, see turn_to_side_of_main_plane; adds the pieces that had a share in the plane.
std::optional<std::string> turn(Surfels& surfels, const Scope& scope, std::vector<char>& turned) {
    const double cell = scope.grid.cell();
    constexpr double kMain = 0.25, kOneSide = 0.85;
    MainPlane plane = main_plane(scope, cell);
    double above = 0, below = 0;
    for (const Surfel& s : surfels.at) {
        const double height = plane.n.dot(s.p) - plane.d;
        above += scope.holds(s) && height > 3 * cell;
        below += scope.holds(s) && height < -3 * cell;
    }
    if (plane.share < kMain || above + below == 0 || std::max(above, below) < kOneSide * (above + below)) {
        return std::nullopt;
    }
    if (below > above) {
        plane.n = -plane.n;
        plane.d = -plane.d;
    }
    // The other face of a plate lies behind all of it; what stands on a plate, before a part of it.
    std::size_t members = 0, covered = 0;
    for (std::size_t i = 0; i < surfels.at.size(); i += 7) {
        if (scope.holds(surfels.at[i]) && plane.holds(surfels.at[i], cell)) {
            ++members;
            covered += blocked(scope.grid, surfels.at[i].p, plane.n, 2 * cell, 400 * cell);
        }
    }
    if (2 * covered > members) {
        return std::nullopt;
    }
    const Walls walls = walls_on(scope, plane);
    if (scope.piece && !walls.are_edges) {
        return std::nullopt;  // what a piece alone shows beside its largest face may as well be its other faces
    }
    constexpr double kShare = 0.05;  // of a piece; less of it lies in the plane by chance
    std::vector<double> sum(surfels.at.size(), 0), size(surfels.at.size(), 0);
    for (const Surfel& s : surfels.at) {
        ++size[s.piece];
        if (scope.holds(s) && plane.holds(s, cell)) {
            sum[s.piece] += (walls.are_edges ? -1 : 1) * s.n.dot(plane.n);
        }
    }
    for (Surfel& s : surfels.at) {
        if (std::abs(sum[s.piece]) <= kShare * size[s.piece]) {
            continue;
        }
        s.side = walls.at_outline ? AirSide::assumed : AirSide::known;
        turned[s.piece] = 1;
        if (sum[s.piece] < 0) {
            s.n = -s.n;
        }
    }
    return walls.are_edges ? "air side of the main plane is the one to which its outline has no edges"
                           : "air side is the side of the main plane on which the rest of the scan lies";
}

}  // namespace

// Whether a ray from p along d meets the scan beyond `start`, by steps of half a cell through the occupied cells.
bool blocked(const PointGrid& grid, const Eigen::Vector3d& p, const Eigen::Vector3d& d, double start, double end) {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(grid.cell() * 0.5);
    for (double x = start; x < end; x += grid.cell()) {
        bool hit = false;
        const Eigen::Vector3d q = p + x * d;
        grid.for_cells_in_box(q - half, q + half, [&](std::size_t cell) { hit |= grid.points(cell).size() > 2; });
        if (hit) {
            return true;
        }
    }
    return false;
}

std::optional<std::string> turn_to_side_of_main_plane(Surfels& surfels, const PointGrid& grid) {
    constexpr double kPiece = 0.05;  // of the scan; smaller ones are left
    std::vector<char> turned(surfels.at.size(), 0);
    auto reason = turn(surfels, {surfels, grid, std::nullopt}, turned);
    std::vector<std::size_t> size(surfels.at.size(), 0);
    for (const Surfel& s : surfels.at) {
        ++size[s.piece];
    }
    for (std::uint32_t piece = 0; reason && piece < size.size(); ++piece) {
        if (!turned[piece] && static_cast<double>(size[piece]) > kPiece * static_cast<double>(surfels.at.size())) {
            turn(surfels, {surfels, grid, piece}, turned);
        }
    }
    return reason;
}

}  // namespace seampath::detail
