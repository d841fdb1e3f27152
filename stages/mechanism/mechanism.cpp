#include "stages/mechanism/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/mechanism/optimal.hpp"
#include "stages/mechanism/walk.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using namespace mechanism;

constexpr double kMostBeta = std::numbers::pi / 3;

// A point may be outside the disc by rounding.
constexpr double kOnEdge = 1e-12;

// Steps that go into a turn up to this share of a turn do.
constexpr double kWhole = 1e-9;

// More nodes than this in a turn are finer than any encoder, and i no longer fits.
constexpr double kMostSteps = 1e8;

int whole_steps(double range, double step, const char* axis, const char* name) {
    const double steps = std::round(range / step);
    if (!(step > 0) || !(steps >= 1) || !(steps <= kMostSteps) || std::abs(steps * step / range - 1) > kWhole) {
        throw InputError(std::string("mechanism: the step of ") + axis + " is " +
                         shortest(step * 180 / std::numbers::pi) + " deg; a step that goes into " + name +
                         " a whole number of times, at most 100 million, is needed; 10, 7.5, 5 or 0.01 do");
    }
    return static_cast<int>(steps);
}

std::string text(const Vector2d& p) {
    return "(" + shortest(p.x()) + ", " + shortest(p.y()) + ")";
}

void require_in_disc(double radius, const Vector2d& p, const std::string& what) {
    if (!(p.norm() <= radius * (1 + kOnEdge))) {
        throw InputError("mechanism: " + what + text(p) + " lies " + fixed(p.norm(), 3) +
                         " mm from the centre; the tool reaches " + shortest(radius) +
                         " mm; move the path, or take a larger mechanism");
    }
}

template <class Iterator>
PathError error_of(Iterator first, Iterator last) {
    PathError error;
    for (; first < last; ++first) {
        ++error.nodes;
        error.rms_mm += first->distance_mm * first->distance_mm;
        error.max_mm = std::max(error.max_mm, first->distance_mm);
    }
    error.rms_mm = error.nodes > 0 ? std::sqrt(error.rms_mm / static_cast<double>(error.nodes)) : 0;
    return error;
}

std::vector<GridNode> way(const GridSegment& segment, GridNode start, GridMethod method) {
    const bool single = method == GridMethod::bresenham || method == GridMethod::optimal_single;
    const Neighbours neighbours = single ? Neighbours::four : Neighbours::eight;
    std::vector<GridNode> greedy = greedy_way(segment, start, neighbours);
    const bool optimal = method == GridMethod::optimal || method == GridMethod::optimal_single;
    return optimal ? optimal_way(segment, greedy, neighbours) : greedy;
}

}  // namespace

Vector2d tool_position(double radius_mm, const TwoTierAngles& angles) {
    const double out = 2 * radius_mm * std::sin(angles.beta / 2), direction = angles.alpha + angles.beta / 2;
    return {out * std::cos(direction), -out * std::sin(direction)};
}

TwoTierAngles two_tier_angles(double radius_mm, const Vector2d& p) {
    require_in_disc(radius_mm, p, "the point ");
    if (p.norm() == 0) {
        return {};
    }
    TwoTierAngles angles;
    angles.beta = std::min(kMostBeta, 2 * std::asin(std::min(0.5, p.norm() / (2 * radius_mm))));
    angles.alpha = std::atan2(-p.y(), p.x()) - angles.beta / 2;
    angles.alpha += angles.alpha < 0 ? kTurn : 0;
    angles.alpha -= angles.alpha >= kTurn ? kTurn : 0;
    return angles;
}

TwoTierGrid two_tier_grid(double radius_mm, double alpha_step, double beta_step) {
    if (!(radius_mm > 0) || !std::isfinite(radius_mm)) {
        throw InputError("mechanism: the radius is " + shortest(radius_mm) + " mm; a finite size above 0 is needed");
    }
    return {radius_mm, whole_steps(kTurn, alpha_step, "alpha", "360 deg"),
            whole_steps(kMostBeta, beta_step, "beta", "60 deg")};
}

Vector2d position(const TwoTierGrid& grid, GridNode node) {
    return tool_position(grid.radius_mm, {kTurn * node.i / grid.alpha_steps, kMostBeta * node.j / grid.beta_steps});
}

GridNode nearest_node(const TwoTierGrid& grid, const Vector2d& p) {
    // On circle j the nearest node is that of the nearest direction; circles are looked at from p's own outwards.
    const TwoTierAngles angles = two_tier_angles(grid.radius_mm, p);
    const int middle = static_cast<int>(std::round(angles.beta / kMostBeta * grid.beta_steps));
    GridNode best;
    double best_distance = std::numeric_limits<double>::infinity();
    const auto look = [&](int j) {
        const double beta = kMostBeta * j / grid.beta_steps;
        if (std::abs(2 * grid.radius_mm * std::sin(beta / 2) - p.norm()) > best_distance) {
            return false;
        }
        const double alpha = std::atan2(-p.y(), p.x()) - beta / 2;
        const int turn = static_cast<int>(std::round(alpha / kTurn * grid.alpha_steps));
        const GridNode node{(turn % grid.alpha_steps + grid.alpha_steps) % grid.alpha_steps, j};
        const double distance = (position(grid, node) - p).norm();
        if (distance < best_distance) {
            best_distance = distance;
            best = node;
        }
        return true;
    };
    for (int j = middle; j >= 0 && look(j); --j) {
    }
    for (int j = middle + 1; j <= grid.beta_steps && look(j); ++j) {
    }
    return best;
}

GridPath follow(const TwoTierGrid& grid, std::span<const Vector2d> polyline, GridMethod method) {
    for (std::size_t k = 0; k < polyline.size(); ++k) {
        require_in_disc(grid.radius_mm, polyline[k], "point " + std::to_string(k + 1) + " of the path, ");
    }
    GridPath path;
    for (std::size_t k = 0; k + 1 < polyline.size(); ++k) {
        if (polyline[k] == polyline[k + 1]) {
            continue;
        }
        const GridSegment segment(grid, polyline[k], polyline[k + 1]);
        const bool first = path.nodes.empty();
        const GridNode start = first ? nearest_node(grid, polyline[k]) : path.nodes.back().node;
        const std::vector<GridNode> nodes = way(segment, start, method);
        for (std::size_t n = first ? 0 : 1; n < nodes.size(); ++n) {
            path.nodes.push_back({nodes[n], k, segment.distance_from_line(position(grid, nodes[n]))});
        }
    }
    if (path.nodes.empty()) {
        throw InputError("mechanism: the path has no length; at least two different points are needed");
    }
    const auto begin = path.nodes.begin(), end = path.nodes.end();
    path.interior = error_of(begin + 1, end - 1);
    path.after_first = error_of(begin + 1, end);
    path.all = error_of(begin, end);
    path.start_gap_mm = (position(grid, path.nodes.front().node) - polyline.front()).norm();
    path.end_gap_mm = (position(grid, path.nodes.back().node) - polyline.back()).norm();
    return path;
}

std::vector<AxisStep> axis_steps(const TwoTierGrid& grid, const GridPath& path) {
    std::vector<AxisStep> steps;
    for (std::size_t k = 1; k < path.nodes.size(); ++k) {
        const GridNode from = path.nodes[k - 1].node, to = path.nodes[k].node;
        int alpha = (to.i - from.i + grid.alpha_steps) % grid.alpha_steps;
        alpha -= 2 * alpha > grid.alpha_steps ? grid.alpha_steps : 0;
        if (from.j == 0) {
            steps.insert(steps.end(), static_cast<std::size_t>(std::abs(alpha)), {alpha < 0 ? -1 : 1, 0});
            alpha = 0;
        }
        steps.push_back({alpha, to.j - from.j});
    }
    return steps;
}

}  // namespace seampath
