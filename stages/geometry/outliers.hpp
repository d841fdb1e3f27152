#pragma once

#include "stages/geometry/pspline.hpp"

/// Points that are off from what their neighbours agree on, told from bends, in which all neighbours take part.
namespace seampath {

/// A curve that follows the points closely, with a knot at each.
struct Loose {
    std::vector<Eigen::Vector3d> at;  ///< its point at the parameter of each of them
    std::vector<double> bulge;        ///< mm, how far each may be off its neighbours because the curve turns
};

/// Sets the weight of such points to zero, against a loose curve; one after the other where they stand close, each
/// judged by how far it is from the curve without it.
Loose drop_outliers(CurvePoints& points, const std::vector<double>& breaks, bool closed);

/// Weights of the points by Tukey's biweight on how far they are off a curve, times the weights `given`.
void weigh(CurvePoints& points, const std::vector<double>& given, const std::vector<double>& bulge,
           const std::vector<Eigen::Vector3d>& off_curve, bool closed);

}  // namespace seampath
