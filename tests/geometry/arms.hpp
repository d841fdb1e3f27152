#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "pipeline/arms.hpp"
#include "stages/geometry/arm.hpp"

/// Arms and random postures for tests.
namespace seampath::test {

inline constexpr double kDegree = std::numbers::pi / 180;

/// Uniform within the limits, and within a turn.
inline JointAngles random_posture(const Arm& arm, std::mt19937_64& generator) {
    JointAngles q;
    for (int i = 0; i < kArmAxes; ++i) {
        const ArmAxis& axis = arm.axes[static_cast<std::size_t>(i)];
        const double share = std::generate_canonical<double, 53>(generator);
        q[i] = std::max(axis.lowest, -std::numbers::pi) +
               share * (std::min(axis.highest, std::numbers::pi) - std::max(axis.lowest, -std::numbers::pi));
    }
    return q;
}

inline JointAngles degrees(double a, double b, double c, double d, double e, double f) {
    return kDegree * (JointAngles() << a, b, c, d, e, f).finished();
}

}  // namespace seampath::test
