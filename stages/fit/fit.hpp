#pragma once

#include "stages/geometry/parametrize.hpp"
#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

/// What the curve is: the saddle where a round pipe meets another surface, a smoothing spline through all points
/// (`automatic` takes one of both), or one of the lines that Minejeva & Markovics, Choice of
/// interpolation method for an arbitrary arc welding curve, compare, through the nodes.
enum class FitModel {
    automatic,
    saddle,
    spline,
    natural,
    clamped,
    not_a_knot,
    periodic,
    akima,
    pchip,
    linear,
    parametric,
    newton_forward,
    newton_backward,
    stirling,
    bessel,
    lagrange,
    newton_divided
};
inline constexpr std::array<std::string_view, 17> kFitModelNames{
    "auto",   "saddle",   "spline",        "natural",    "clamped",        "not-a-knot",      "periodic",
    "akima",  "pchip",    "linear",        "parametric", "newton-forward", "newton-backward", "stirling",
    "bessel", "lagrange", "newton-divided"};
inline std::string_view name(FitModel model) {
    return kFitModelNames[static_cast<std::size_t>(model)];
}

/// What x, y and z are functions of.
enum class FitAxis { length, x, y, z };
inline constexpr std::array<std::string_view, 4> kFitAxisNames{"length", "x", "y", "z"};

/// `minimax` is for limits of a robot's axes; a seam has none.
inline constexpr std::array<std::string_view, 5> kFitParametrizationNames{
    kObjectiveNames[0], kObjectiveNames[1], kObjectiveNames[2], kObjectiveNames[3], kObjectiveNames[4]};

struct FitOptions {
    FitModel model = FitModel::automatic;
    FitAxis axis = FitAxis::length;
    Objective parametrization = Objective::chord;
    int degree = 5;  ///< Minejeva & Markovics, section VII: no more
    /// What is known of a saddle beforehand: value and 1-sigma; a sigma of 0: nothing.
    std::vector<double> branch_radius_mm{0, 0}, header_radius_mm{0, 0}, angle_deg{0, 0}, offset_mm{0, 0};
};
Fields describe(FitOptions&);

/// Whether the model is a line through nodes.
bool interpolates(FitModel model);

/// Whether the nodes of a model lie at equal steps; such a model takes as many as were placed, but sets them itself.
bool sets_nodes(FitModel model);

/// The curve of a seam.
///
/// `saddle`: the exact curve in which a branch, which is a pipe, meets a header (SaddleCurve). Both are the surfaces
/// that extraction fitted to all points of the flanks, together with what `options` know beforehand.
///
/// `auto`: the saddle when it explains the seam's points: chi-squared, the mean square of their distances from it in
/// their own sigmas, is below the 99 % point for as many degrees of freedom as there are independent points among them,
/// told from how their distances correlate along the seam. When it does not, but the walls keep within what a pipe may
/// be out of round, smooth offsets along both flanks' normals, penalised as the spline is, are added to it. Else the
/// spline. SeamModel::reason says which and why. The B-spline that stands for a saddle is within 1e-5 mm of it.
///
/// `spline`: penalised least-squares cubic B-spline through the seam points (Eilers & Marx 1996), periodic when the
/// seam is closed. Points count with 1/sigma^2, of which only the ratios matter unless the points scatter less than
/// stated; single points that are off from their neighbours don't count. Distances are orthogonal. How stiff the curve
/// is, and where, is chosen from the points (smoothing.hpp), knots are as dense as the freedom that it turns out to
/// have. The nodes are not needed: every point takes part. Time is O(points).
///
/// All others pass the nodes, each coordinate interpolated over arc length along the seam's points or along an axis;
/// `parametric` is the natural spline, of a closed seam the periodic one, over Marin's parameters (parametrize.hpp).
/// Newton I, Newton II, Stirling and Bessel need equal steps: nodes at equal arc lengths (or equal steps of the axis)
/// are read off Akima's line through all seam points. Stirling's formula (12) about the nearest node jumps midway
/// between two nodes; here the formulas about both count, each the more the nearer its node is, 1 - |U|: the line keeps
/// their values and slopes at the nodes, and of degree 2 is Overhauser's. Its degree is even, Lagrange's is odd, for
/// one of even degree jumps; `newton_divided` is the same polynomial as `lagrange`. Closed seams are interpolated round
/// and round, from their first node. Cubics become the B-spline exactly, with double and triple knots where they share
/// one derivative or none; higher degrees are followed to within 1e-6 mm.
///
/// A seam with corners is fitted piece by piece, with its corners where neighbouring pieces meet; no saddle serves it.
///
/// Throws InputError for fewer than 6 points (of a piece), a seam without length, neighbouring nodes in one place, and
/// a model that can't serve the seam: `periodic` on an open one, `natural`, `clamped`, `not-a-knot` on a closed one, an
/// axis along which the seam turns back, a `saddle` where there is none, an option that the model has no use for.
SeamModel fit(const Seam& seam, const Nodes& nodes, const FitOptions& options);

}  // namespace seampath
