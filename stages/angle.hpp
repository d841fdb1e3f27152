#pragma once

#include <numbers>

namespace seampath {

inline constexpr double kTurn = 2 * std::numbers::pi;      // rad
inline constexpr double kDegree = std::numbers::pi / 180;  // rad
inline constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

}  // namespace seampath
