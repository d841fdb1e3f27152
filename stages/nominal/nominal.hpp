#pragma once

#include <array>
#include <numbers>
#include <string_view>
#include <vector>

#include "stages/geometry/saddle.hpp"
#include "stages/types.hpp"

/// Seams from nominal dimensions instead of a scan. After Xue et al., Interpolation Algorithm and Mathematical Model in
/// Automated Welding of Saddle-Shaped Weld, 2018; equation numbers are theirs.
namespace seampath {

enum class HeaderKind { cylinder, plane, cone, sphere, ellipsoid };
inline constexpr std::array<std::string_view, 5> kHeaderNames{"cylinder", "plane", "cone", "sphere", "ellipsoid"};

/// A branch on a header as a drawing gives it, in the paper's frame: z up, the header's axis along y. The branch's axis
/// lies in the plane x = offset, meets z = 0 at y = 0 and leaves it at `angle` from +y: along z at 90 deg.
struct SaddleDimensions {
    HeaderKind header = HeaderKind::cylinder;
    double branch_radius_mm = 0;
    double header_radius_mm = 0;          ///< of the cylinder, the sphere, the ellipsoid about z, the cone at y = 0
    double head_depth_mm = 0;             ///< semi-axis of the ellipsoid along z
    double cone_half_angle = 0;           ///< rad; the cone opens towards +y
    double angle = std::numbers::pi / 2;  ///< rad, between 0 and pi
    double offset_mm = 0;
};

/// Branch angle 0 is where the branch faces +y; the plane is z = 0, sphere and ellipsoid are about the origin. Throws
/// InputError as SaddleCurve does.
SaddleCurve saddle_of(const SaddleDimensions& dimensions);

/// How the torch goes on from one interpolation point to the next.
///   equal_angle     the same branch angle each time (1)-(3); this is what Table 1 of the paper shows
///   variable_angle  delta theta = v delta T sin(alpha) / r (14), (24): Euler's method on d theta/ds. Written here as
///                   v delta T / |dp/dtheta|, which is the same for the paper's saddle without its pole at 90 deg, and
///                   holds for every header
///   arc_length      the same arc each time, by inversion of the arc length
enum class StepLaw { equal_angle, variable_angle, arc_length };
inline constexpr std::array<std::string_view, 3> kStepLawNames{"equal-angle", "variable-angle", "arc-length"};

/// Angle of the torch from the branch's wall, in the section square to travel.
///   paper     opening - pi/2 + phi (12): the whole change of the opening goes into the torch, which so keeps its angle
///             to the header's wall
///   bisector  opening / 2
enum class PoseLaw { paper, bisector };
inline constexpr std::array<std::string_view, 2> kPoseLawNames{"paper", "bisector"};

/// Branch angles of the interpolation points, rad, from 0 to exactly 2 pi; a last step that is left over is shorter.
/// `step_mm` is v delta T, above 0; equal angles are as many as such steps go round.
std::vector<double> step_angles(const SaddleCurve& curve, StepLaw law, double step_mm);

/// Largest relative error of the speed, of all steps but the last.
struct StepErrors {
    double arc = 0;    ///< |arc of a step / step_mm - 1|: of a torch that keeps to the curve
    double chord = 0;  ///< the same of the chord: of a torch that moves straight from point to point
};
StepErrors step_errors(const SaddleCurve& curve, const std::vector<double>& angles, double step_mm);

/// Torch angle at one point, rad. `initial` is the paper's phi; the bisector has no use for it.
double torch_angle(const SaddlePoint& point, PoseLaw law, double initial);

/// The saddle as the model that planning takes: a periodic cubic spline through exact points, by arc length, with knots
/// added until it is within 1e-7 mm of the curve (or of rounding). `residual_*` are the distances found from exact
/// points between the knots. The flanks are the walls' normals, turned about travel where the law asks for another
/// torch than their bisector. `initial` as for torch_angle().
SeamModel nominal_model(const SaddleCurve& curve, PoseLaw law, double initial);

}  // namespace seampath
