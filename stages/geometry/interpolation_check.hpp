#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/interpolate.hpp"

/// How good an interpolant is: against points that were measured between the nodes, and by its shape alone.
namespace seampath {

/// Statistics of |e| = |y - P(x)| at check points, in the sense of Minejeva & Markovics, section IX, and of the
/// distance of the check points from the line.
struct CheckStatistics {
    std::vector<double> error;              ///< |e|, one a check point
    std::vector<double> distance;           ///< shortest distance from the line, one a check point
    double mean = 0;                        ///< of |e|
    double variance = 0;                    ///< of |e| about its mean, over N
    std::optional<double> sample_variance;  ///< over N - 1; nothing for one check point
    double rms = 0;                         ///< root of the mean of e^2
    double max = 0;                         ///< of |e|
    double max_x = 0;                       ///< where
    double distance_mean = 0;
    double distance_rms = 0;
    double distance_max = 0;
};

/// At least one point, x within the table.
CheckStatistics check_points(const Interpolant& line, std::span<const Eigen::Vector2d> points);

/// A stretch on which a line falls where the data rise, or the other way round.
struct Reversal {
    double from_x = 0, to_x = 0;
    double x = 0;      ///< where it is steepest
    double slope = 0;  ///< there
};

/// What a line does that its data don't. An interval counts as monotone when no neighbouring interval runs the other
/// way, for beside a turn of the data a smooth line turns off the node.
struct Shape {
    std::vector<Reversal> reversals;  ///< in monotone intervals, ascending
    int turns = 0;                    ///< from rising to falling or back
    int data_turns = 0;               ///< the same of the polygon
    double overshoot = 0;             ///< farthest out of the range of its two nodes, in monotone intervals
    double overshoot_x = 0;
    double jump = 0;  ///< largest step of y at one x, where formulas change
    double jump_x = 0;
    bool runs_back = false;  ///< x(t) doesn't ascend: the line has several y at one x
};

Shape shape_of(const Interpolant& line, std::span<const double> x, std::span<const double> y);

}  // namespace seampath
