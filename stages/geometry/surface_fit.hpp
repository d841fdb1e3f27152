#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include <Eigen/Core>

#include "stages/geometry/surface_parameters.hpp"

/// Robust geometric least squares of whole surfaces: the sum of squared orthogonal distances, in double precision about
/// the centroid, with Tukey's biweight (c = 4.685) and the scale from the median absolute residual.
namespace seampath {

/// A fitted surface. Distances are signed and above 0 outside the material, which for a bore lies around the surface.
class SurfaceFit {
public:
    using Shape = std::variant<Plane, Cylinder, Cone, Sphere>;
    static constexpr int kMostParameters = 6;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostParameters, 1>;
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostParameters, kMostParameters>;

    /// `covariance` is of the shape's parameters in `frame` (surface_parameters.hpp), mm^2.
    SurfaceFit(const Shape& shape, bool bore, const SurfaceFrame& frame, const Matrix& covariance, double scale,
               double share_taken)
        : shape_(shape),
          side_(bore ? -1 : 1),
          frame_(frame),
          covariance_(covariance),
          scale_(scale),
          share_taken_(share_taken) {}

    const Shape& shape() const { return shape_; }
    bool bore() const { return side_ < 0; }
    int parameters() const { return static_cast<int>(covariance_.rows()); }
    const SurfaceFrame& frame() const { return frame_; }
    const Eigen::Vector3d& origin() const { return frame_.origin; }  ///< centroid of the points
    double distance(const Eigen::Vector3d& p) const;
    Eigen::Vector3d normal(const Eigen::Vector3d& p) const;
    /// Robust 1-sigma of the points' residuals, mm.
    double scale() const { return scale_; }
    /// Share of the points with a weight above 0.
    double share_taken() const { return share_taken_; }
    /// 1-sigma of the surface's own place at p, mm.
    double sigma(const Eigen::Vector3d& p) const;
    /// Derivative of the distance at p, on the outside of the shape, by the parameters.
    Vector row(const Eigen::Vector3d& p) const;
    /// Weight of a point in the fit, 0..1.
    double weight(const Eigen::Vector3d& p) const;

    /// Of the parameters by which `moved` moves the shape, mm^2.
    const Matrix& covariance() const { return covariance_; }
    Shape moved(const Vector& step) const;

private:
    Shape shape_;
    double side_;
    SurfaceFrame frame_;
    Matrix covariance_;
    double scale_, share_taken_;
};

/// Each fit takes at least four points a parameter. `block`, one number a point from 0 on, says which points may share
/// an error: neighbours see the same noise, the same view's registration. `least_scale` keeps the scale from collapsing
/// on data that are exact or quantised, mm. `places` and `normals` are where, and how, the outward normal is roughly
/// known, at least 3. Empty when the points do not determine the surface, or do not tell it from a simpler one, at four
/// sigmas: a curved one from a plane, a cone from a cylinder.

/// The plane whose normal points to the side of `outward`.
std::optional<SurfaceFit> fit_plane(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                                    const Eigen::Vector3d& outward, double least_scale);

/// The axis is first the direction to which the normals are all square.
std::optional<SurfaceFit> fit_cylinder(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                                       std::span<const Eigen::Vector3d> places,
                                       std::span<const Eigen::Vector3d> normals, double least_scale);

/// The axis is first the direction to which the normals are all at one angle.
std::optional<SurfaceFit> fit_cone(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                                   std::span<const Eigen::Vector3d> places, std::span<const Eigen::Vector3d> normals,
                                   double least_scale);

std::optional<SurfaceFit> fit_sphere(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                                     std::span<const Eigen::Vector3d> places, std::span<const Eigen::Vector3d> normals,
                                     double least_scale);

}  // namespace seampath
