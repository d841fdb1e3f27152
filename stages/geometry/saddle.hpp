#pragma once

#include <variant>
#include <vector>

#include "stages/geometry/quadric.hpp"

/// The saddle: the closed curve in which a round branch meets a header.
namespace seampath {

/// What a branch can stand on. Anything else that is a quadric needs a row in quadric.hpp and here.
using Header = std::variant<Plane, Cylinder, Cone, Sphere, Ellipsoid>;

/// One place of the saddle.
struct SaddlePoint {
    double theta = 0;         ///< branch angle, rad
    Eigen::Vector3d p;        ///< mm
    Eigen::Vector3d tangent;  ///< unit, along n1 x n2
    double speed_mm_rad = 0;  ///< |dp/dtheta|
    Eigen::Vector3d n1;       ///< outward normal of the branch
    Eigen::Vector3d n2;       ///< outward normal of the header
    double opening = 0;       ///< angle of the air between both walls, pi - angle(n1, n2), rad
    double curvature_per_mm = 0;
};

/// The curve of a branch (cylinder of radius r, unit axis a out of the header) on a header, by the branch angle theta.
///
/// theta counts from the direction `zero` clockwise as seen against the axis, as in eq. (1) of Xue et al. 2018, so that
/// n1 x n2 points along travel. With e1 = `zero` made square to a, e2 = e1 x a, n1 = e1 cos(theta) + e2 sin(theta) the
/// generator line of the branch at theta is P0 + u a, P0 = point + r n1. In a header w' A w + 2 b.w + c = 0 that is one
/// quadratic in u,
///     alpha u^2 + 2 beta u + gamma = 0,  alpha = a'Aa,  beta = (A w0 + b).a,  gamma = f(P0),
/// and the seam is at the root u = (-beta + sqrt(D)) / alpha, D = beta^2 - alpha gamma, at which the line leaves the
/// material. dp/dtheta = r e_t + u' a with u' = -r (n2.e_t) / (n2.a). The curvature follows from the normal curvatures
/// k1, k2 of both walls along the tangent, kappa^2 = (k1^2 + k2^2 - 2 k1 k2 c) / (1 - c^2), c = n1.n2 (Ye & Maekawa,
/// CAGD 16, 1999). For two cylinders at right angles without offset all this is eqs. (1) to (23) of Xue et al.
///
/// The arc length is a table of eight-point Gauss-Legendre sums over pieces that are halved until halves and whole
/// agree to 1e-13 of the length, inverted by Newton's method: to about 1e-12 mm.
class SaddleCurve {
public:
    /// Throws InputError, saying why, for a branch that misses the header somewhere (D < 0: a partial penetration, no
    /// closed curve on the branch), that touches it so that the curve has corners (D = 0, e.g. equal radii at right
    /// angles without offset), or that doesn't leave it; and for sizes that are no sizes.
    SaddleCurve(Cylinder branch, const Eigen::Vector3d& zero, const Header& header);

    const Cylinder& branch() const { return branch_; }

    /// Any theta; period 2 pi.
    SaddlePoint at(double theta) const;

    double length() const { return station_.back(); }  ///< mm, once round
    double station(double theta) const;                ///< arc length from theta = 0, mm; any theta
    double theta(double station_mm) const;             ///< the inverse

private:
    struct Crossing {
        Eigen::Vector3d n1, e_t, w0;
        double alpha, beta, gamma;
        double discriminant() const { return beta * beta - alpha * gamma; }
    };
    Crossing crossing(double theta) const;
    double speed(double theta) const;
    double speed_integral(double from, double to) const;
    void check_meets_all_round() const;
    void check_has_no_corner() const;
    void check_stays_on(const Cone& cone) const;
    void add_pieces(double from, double to, double whole, double tolerance, int depth);

    Cylinder branch_;
    Eigen::Vector3d e1_, e2_;
    Quadric header_;
    std::vector<double> theta_;    ///< ends of the pieces, 0 to 2 pi
    std::vector<double> station_;  ///< mm at those ends
};

}  // namespace seampath
