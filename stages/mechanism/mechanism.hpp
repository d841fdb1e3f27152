#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

/// The two-tier mechanism and linear interpolation on its grid. After Naumov, Paschenko & Koltcov, Research and
/// comparative analysis of methods linear interpolation trajectory of the working tool of a two-tier mechanism;
/// equation numbers are theirs.
///
/// A disc of radius R turns by alpha about the origin; on its edge stands a rod of length R that turns by beta, 0..60
/// deg, and carries the tool, which so reaches every point of the disc:
///     x = R sin(alpha + beta) - R sin(alpha),   y = R cos(alpha + beta) - R cos(alpha)                         (2)
/// that is, radius 2 R sin(beta / 2) in the direction -(alpha + beta / 2). At the centre alpha is free.
namespace seampath {

struct TwoTierAngles {
    double alpha = 0;  ///< rad, [0, 2 pi)
    double beta = 0;   ///< rad, [0, pi / 3]
};

/// Eq. (2).
Eigen::Vector2d tool_position(double radius_mm, const TwoTierAngles& angles);

/// Its inverse, beta = 2 asin(|p| / 2R), alpha = atan2(-y, x) - beta / 2; at the centre alpha is 0. Eq. (1) as printed
/// has a wrong sign in its denominator and knows no quadrants. Throws InputError for a point outside the disc.
TwoTierAngles two_tier_angles(double radius_mm, const Eigen::Vector2d& p);

/// The positions that both axes' steps allow (3): alpha = i 360/alpha_steps deg, beta = j 60/beta_steps deg.
struct TwoTierGrid {
    double radius_mm = 0;
    int alpha_steps = 0;  ///< in a turn
    int beta_steps = 0;   ///< in 60 deg
};

/// Steps in rad. Throws InputError unless they go into a turn, and into 60 deg, without rest.
TwoTierGrid two_tier_grid(double radius_mm, double alpha_step, double beta_step);

/// 0 <= i < alpha_steps, 0 <= j <= beta_steps. Nodes with j = 0 are all the centre.
struct GridNode {
    int i = 0;
    int j = 0;
    bool operator==(const GridNode&) const = default;
};
Eigen::Vector2d position(const TwoTierGrid& grid, GridNode node);
GridNode nearest_node(const TwoTierGrid& grid, const Eigen::Vector2d& p);

/// From the node nearest to M1 on, how the next node is chosen. All go on only to neighbours that are nearer to M2, and
/// from the centre, where alpha is free, to any node round it.
///   least_distance  of eight neighbours the one least far from the line M1 M2, until none is nearer to M2
///   bresenham       the same of four neighbours: one axis at a time
///   optimal         eight neighbours; the way to where least_distance ends with the least rms distance of the nodes in
///                   between, and so also the best of all ways with its number of nodes; found by dynamic programming
///                   (Dinkelbach, Management Science 13, 1967, for the mean)
///   optimal_single  the same with four neighbours, to where bresenham ends
/// The search for an optimum keeps to a corridor about the line, twice as wide as the greedy way needs plus one cell.
enum class GridMethod { least_distance, bresenham, optimal, optimal_single };
inline constexpr std::array<std::string_view, 4> kGridMethodNames{"least-distance", "bresenham", "optimal",
                                                                  "optimal-single"};

/// One node of a way over the grid.
struct PathNode {
    GridNode node;
    std::size_t segment = 0;  ///< of the polyline
    double distance_mm = 0;   ///< perpendicular, from the line of that segment
};

/// The same statistics over one set of nodes; zeros where the set is empty.
struct PathError {
    std::size_t nodes = 0;
    double rms_mm = 0;
    double max_mm = 0;
};

struct GridPath {
    std::vector<PathNode> nodes;  ///< at least one; the centre, when it is passed, once
    PathError interior;           ///< all but the first and the last: the paper's figure for least distance
    PathError after_first;        ///< all but the first: the paper's figure for Bresenham
    PathError all;
    double start_gap_mm = 0;  ///< from the first point of the polyline to the first node
    double end_gap_mm = 0;    ///< from the last node to the last point
};

/// Follows a polyline, segment by segment; each begins at the node where the one before ended. Throws InputError naming
/// the point for points outside the disc, and for polylines without length.
GridPath follow(const TwoTierGrid& grid, std::span<const Eigen::Vector2d> polyline, GridMethod method);

/// One beat of both axes: -1, 0 or 1 step each.
struct AxisStep {
    int alpha = 0;
    int beta = 0;
};

/// What takes the mechanism along the nodes: one beat from node to node, and at the centre as many beats of alpha alone
/// as turn the disc, the shorter way, to where the tool goes on.
std::vector<AxisStep> axis_steps(const TwoTierGrid& grid, const GridPath& path);

}  // namespace seampath
