#pragma once

#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "stages/stripe/stripe.hpp"

namespace seampath {

/// A straight piece of a profile: points [begin, end) of it.
struct ProfileLine {
    std::size_t begin = 0;
    std::size_t end = 0;
    Eigen::Vector2d middle{0, 0};     ///< of its points
    Eigen::Vector2d direction{1, 0};  ///< unit, along the profile
    double length = 0;
    double sigma = 0;  ///< 1-sigma of the line across itself, at its middle

    double height(const Eigen::Vector2d& p) const {  ///< of p over the line, to the left of its direction
        return direction.x() * (p - middle).y() - direction.y() * (p - middle).x();
    }
};

/// The profile's straight pieces, in order: the cut into pieces with the least sum of squared distances over sigma^2
/// and a charge a piece (the Bayesian information criterion, Schwarz 1978), by dynamic programming; then each piece's
/// line anew without what lies within the scale's band of its ends, where the stripe's own width rounds corners, and
/// with Tukey's biweight. Pieces that are too short for that are left out.
std::vector<ProfileLine> straight_pieces(std::span<const Eigen::Vector2d> points, const ProfileScale& scale);

/// Where two lines meet; they must not be parallel.
Eigen::Vector2d meeting(const ProfileLine& a, const ProfileLine& b);

/// Turn from one piece to the next, rad: positive in a hollow, for points in order of x and y out of the material.
double turn(const ProfileLine& a, const ProfileLine& b);

inline constexpr double kLeastBend = 20 * std::numbers::pi / 180;  ///< of a corner; less is a bent sheet

}  // namespace seampath
