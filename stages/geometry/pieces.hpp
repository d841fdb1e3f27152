#pragma once

#include <array>
#include <vector>

#include "stages/types.hpp"

namespace seampath {

/// How many derivatives two neighbouring pieces share where they meet, as the multiplicity of the knot there.
enum Joint { kTwoDerivatives = 1, kOneDerivative = 2, kPositionOnly = 3 };

/// A curve of cubic pieces.
struct CubicPieces {
    std::vector<double> breaks;  ///< ascending, one more than pieces
    std::vector<std::array<Eigen::Vector3d, 4>>
        coefficients;           ///< of 1, v, v^2, v^3 for each piece; v counts from the break at its beginning
    std::vector<Joint> joints;  ///< at the beginning of each piece; the first is that of a closed curve's ends
};

/// The same curve as a B-spline, exactly: each control point is the blossom of a piece at three knots (Ramshaw,
/// Blossoms are polar forms, CAGD 6, 1989). The pieces meet as their joints say.
CubicBSpline as_bspline(const CubicPieces& pieces, bool periodic);

}  // namespace seampath
