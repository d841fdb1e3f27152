#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "stages/geometry/saddle.hpp"
#include "stages/geometry/surface_fit.hpp"
#include "stages/types.hpp"

/// A saddle from the surfaces of its two parts.
namespace seampath {

/// What is known of a saddle beforehand. What a header does not have (see `SaddleFit`) is left aside.
struct SaddleNominals {
    std::optional<Measured> branch_radius_mm, header_radius_mm, angle_rad, offset_mm;
};

struct SaddleFit {
    SaddleCurve curve;
    SurfaceFit::Shape header;
    Eigen::Vector3d zero;                      ///< direction of branch angle 0: the header's axis, if it has one
    Measured branch_radius_mm;                 ///< the branch itself is curve.branch()
    std::optional<Measured> header_radius_mm;  ///< cylinder, sphere
    /// Between the axes, or between the branch's axis and a plane: at most 90 deg, or on the nominal angle's side of
    /// it.
    std::optional<Measured> angle_rad;
    /// Between the axes, or of a sphere's centre from the branch's axis. For a sphere, as the angle to a plane near 90
    /// deg, it is the length of a vector: smaller than its own sigma it says no more than that.
    std::optional<Measured> offset_mm;
    /// How far the nominals are off what was measured: chi-squared, of as many degrees of freedom as there are of them.
    double nominals_chi2 = 0;
    int nominals = 0;
};

/// Why there is none.
struct NoSaddle {
    std::string reason;
};

/// The branch (a cylinder) and the header that are most likely given both fits and the nominals: generalised least
/// squares, with the covariances of the fits and `between` them (the branch's parameters by the header's; of size 0
/// when they are independent), as a Gauss-Newton iteration (Bell & Cathey, The iterated Kalman filter update as a
/// Gauss-Newton method, 1993). No saddle when the branch is no cylinder,
/// runs along the header, misses it in part, or is as wide as the header (r + offset = R) within four sigmas. Throws
/// InputError for a nominal that is not finite or whose sigma is not above 0.
std::variant<SaddleFit, NoSaddle> fit_saddle(const SurfaceFit& branch, const SurfaceFit& header,
                                             const SaddleNominals& nominals, const Eigen::MatrixXd& between = {});

/// Branch angle of a point, -pi to pi.
double branch_angle(const SaddleFit& saddle, const Eigen::Vector3d& p);

/// The saddle from one branch angle to another, rad, by the arc length from its beginning; backwards when the second is
/// the smaller one.
class SaddleSeam {
public:
    SaddleSeam(SaddleCurve curve, double from, double to)
        : curve_(std::move(curve)), start_(curve_.station(from)), span_(curve_.station(to) - start_) {}

    double length() const { return std::abs(span_); }  ///< mm
    bool backwards() const { return span_ < 0; }
    SaddlePoint at(double station_mm) const {
        return curve_.at(curve_.theta(start_ + (span_ < 0 ? -station_mm : station_mm)));
    }
    /// The inverse of `at(...).theta`, whole turns and all.
    double station(double theta) const { return (span_ < 0 ? -1 : 1) * (curve_.station(theta) - start_); }

private:
    SaddleCurve curve_;
    double start_, span_;
};

}  // namespace seampath
