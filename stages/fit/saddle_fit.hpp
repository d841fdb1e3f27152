#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "stages/geometry/saddle.hpp"
#include "stages/geometry/surface_fit.hpp"

/// A saddle from the surfaces of its two parts.
namespace seampath {

/// A number and its 1-sigma: a measured one, or one known from elsewhere, e.g. a drawing and its tolerance.
struct Gaussian {
    double value = 0, sigma = 0;
};

/// What is known of a saddle beforehand. What a header does not have (see `SaddleFit`) is left aside.
struct SaddleNominals {
    std::optional<Gaussian> branch_radius_mm, header_radius_mm, angle_rad, offset_mm;
};

struct SaddleFit {
    SaddleCurve curve;
    Header header;
    Eigen::Vector3d zero;                      ///< direction of branch angle 0: the header's axis, if it has one
    Gaussian branch_radius_mm;                 ///< the branch itself is curve.branch()
    std::optional<Gaussian> header_radius_mm;  ///< cylinder, sphere
    /// Between the axes, or between the branch's axis and a plane: at most 90 deg, or on the nominal angle's side of
    /// it.
    std::optional<Gaussian> angle_rad;
    /// Between the axes, or of a sphere's centre from the branch's axis. For a sphere, as the angle to a plane near 90
    /// deg, it is the length of a vector: smaller than its own sigma it says no more than that.
    std::optional<Gaussian> offset_mm;
    /// How far the nominals are off what was measured: chi-squared, of as many degrees of freedom as there are of them.
    double nominals_chi2 = 0;
};

/// Why there is none.
struct NoSaddle {
    std::string reason;
};

/// The branch (a cylinder) and the header that are most likely given both fits and the nominals: generalised least
/// squares, with the covariances of the fits, which are independent of each other, as a Gauss-Newton iteration (Bell &
/// Cathey, The iterated Kalman filter update as a Gauss-Newton method, 1993). No saddle when the branch is no cylinder,
/// runs along the header, misses it in part, or is as wide as the header (r + offset = R) within four sigmas. Throws
/// InputError for a nominal that is not finite or whose sigma is not above 0.
std::variant<SaddleFit, NoSaddle> fit_saddle(const SurfaceFit& branch, const SurfaceFit& header,
                                             const SaddleNominals& nominals);

/// Branch angle of a point, -pi to pi.
double branch_angle(const SaddleFit& saddle, const Eigen::Vector3d& p);

/// A saddle all round, or a stretch of it, by the arc length from its beginning.
class SaddleSeam {
public:
    explicit SaddleSeam(SaddleCurve curve) : curve_(std::move(curve)), length_(curve_.length()), closed_(true) {}
    /// From one branch angle to a larger one, rad.
    SaddleSeam(SaddleCurve curve, double from, double to)
        : curve_(std::move(curve)), start_(curve_.station(from)), length_(curve_.station(to) - start_) {}

    bool closed() const { return closed_; }
    double length() const { return length_; }  ///< mm
    SaddlePoint at(double station_mm) const { return curve_.at(curve_.theta(start_ + station_mm)); }

private:
    SaddleCurve curve_;
    double start_ = 0, length_;
    bool closed_ = false;
};

}  // namespace seampath
