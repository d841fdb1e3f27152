#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "stages/types.hpp"

/// Evaluation, arc length and foot points of CubicBSpline (types.hpp).
namespace seampath {

/// The four cubic basis functions that are not zero at a parameter, with first and second derivatives
/// (de Boor, A Practical Guide to Splines, ch. X). `control[k]` is the control point of `value[k]`.
struct CubicBasis {
    std::array<std::size_t, 4> control;
    std::array<double, 4> value;
    std::array<double, 4> d1;
    std::array<double, 4> d2;
};

/// Basis of a spline with these knots and so many control points at u. Periodic: u is wrapped into the period.
/// Open: u is clamped to the domain.
CubicBasis cubic_basis(const std::vector<double>& knots, std::size_t controls, bool periodic, double u);

/// First and last parameter of the curve; for a periodic curve they are one period apart.
double first_parameter(const CubicBSpline& curve);
double last_parameter(const CubicBSpline& curve);

/// A place where two polynomials meet, and how many derivatives they share there: 2, 1, 0, or -1 where even the
/// position jumps; from the multiplicity of the knot.
struct CurveKnot {
    double u = 0;
    int continuity = 2;
};

/// The inner knots of a curve, ascending; of a periodic one also that of its beginning.
std::vector<CurveKnot> knots_of(const CubicBSpline& curve);

Eigen::Vector3d position(const CubicBSpline& curve, double u);
Eigen::Vector3d derivative(const CubicBSpline& curve, double u);
Eigen::Vector3d second_derivative(const CubicBSpline& curve, double u);
Eigen::Vector3d tangent(const CubicBSpline& curve, double u);  ///< unit
double curvature(const CubicBSpline& curve, double u);         ///< 1/mm

/// Arc length of a curve as a table over its knots, filled by eight-point Gauss-Legendre quadrature of |c'| and
/// inverted by Newton's method: parameter(station(u)) = u to about 1e-12 mm. Keeps a copy of the curve.
class ArcLength {
public:
    explicit ArcLength(CubicBSpline curve);
    double length() const { return station_.back(); }
    double station(double u) const;          ///< mm from the first point; u within the domain
    double parameter(double station) const;  ///< closed curves wrap, open curves clamp
    const CubicBSpline& curve() const { return curve_; }

private:
    CubicBSpline curve_;
    std::vector<double> knot_;     ///< ends of the quadrature pieces
    std::vector<double> station_;  ///< mm at those ends
};

/// Parameter of the point of the curve nearest to p: the best of a coarse sampling, then Newton's method on (c - p).c'
/// = 0.
double nearest_parameter(const CubicBSpline& curve, const Eigen::Vector3d& p);

/// The same from a start that is already near (within a knot span or so).
double nearest_parameter(const CubicBSpline& curve, const Eigen::Vector3d& p, double start);

/// A point of a curve.
struct FootPoint {
    double u = 0;
    Eigen::Vector3d p;
};

/// That point itself.
FootPoint foot_point(const CubicBSpline& curve, const Eigen::Vector3d& p, double start);

/// Flank normals (unit), sigma and `modelled` at a station, interpolated between the model's samples.
FlankSample flanks_at(const SeamModel& model, double station_mm);

}  // namespace seampath
