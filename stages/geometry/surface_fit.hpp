#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/quadric.hpp"

/// Robust geometric least squares of whole surfaces: the sum of squared orthogonal distances, in double precision about
/// the centroid, with Tukey's biweight (c = 4.685) and the scale from the median absolute residual. A cylinder has five
/// parameters (two of its axis' place, two of its direction, the radius), none of them redundant.
namespace seampath {

/// A fitted plane or cylinder. Distances are signed and above 0 outside the material, which for a bore lies around the
/// cylinder.
class SurfaceFit {
public:
    using Shape = std::variant<Plane, Cylinder>;
    static constexpr int kMostParameters = 5;
    using Row = Eigen::Matrix<double, kMostParameters, 1>;
    using Matrix = Eigen::Matrix<double, kMostParameters, kMostParameters>;

    SurfaceFit(const Shape& shape, bool bore) : shape_(shape), side_(bore ? -1 : 1) {}

    const Shape& shape() const { return shape_; }
    bool bore() const { return side_ < 0; }
    int parameters() const { return std::holds_alternative<Plane>(shape_) ? 3 : 5; }
    double distance(const Eigen::Vector3d& p) const;
    Eigen::Vector3d normal(const Eigen::Vector3d& p) const;
    /// Robust 1-sigma of the points' residuals, mm.
    double scale() const { return scale_; }
    /// Share of the points with a weight above 0.
    double share_taken() const { return share_taken_; }
    /// 1-sigma of one point as far as means over many go, mm: what the points of a block share counts (see `fit`).
    double unit() const { return unit_; }
    /// 1-sigma of the surface's own place at p, mm.
    double sigma(const Eigen::Vector3d& p) const;
    /// Derivative of the distance at p by the parameters, and how far the parameters follow the points: the step that
    /// errors e of the points make is -cofactors() * sum of weight * e * row.
    Row row(const Eigen::Vector3d& p) const;
    const Matrix& cofactors() const { return cofactors_; }
    /// Weight of a point in the fit, 0..1.
    double weight(const Eigen::Vector3d& p) const;

    /// Fits the shape to the points, beginning with what it is. `block`, one number a point, says which points may
    /// share an error: neighbours see the same noise, the same view's registration. False when the points do not
    /// determine it.
    bool fit(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block, double least_scale);

private:
    void set_frame(const Eigen::Vector3d& origin);
    void move(const Row& step);
    bool gauss_newton(std::span<const Eigen::Vector3d> points, double& largest_step);
    void measure_scale(std::span<const Eigen::Vector3d> points, double least_scale);
    void finish(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block);

    Shape shape_;
    double side_;
    Eigen::Vector3d origin_{0, 0, 0}, e_[2];
    double length_ = 1;  ///< unit of the tilts' lever, mm
    double scale_ = 0, unit_ = 0, share_taken_ = 1;
    Matrix cofactors_ = Matrix::Zero();
};

/// The plane through points whose normal points to the side of `outward`.
std::optional<SurfaceFit> fit_plane(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                                    const Eigen::Vector3d& outward, double least_scale);

/// The cylinder through points, whose outward normals are roughly known at some places: the axis is first the direction
/// to which they are all square. Empty when the normals do not turn enough to tell one, or the fit does not settle.
std::optional<SurfaceFit> fit_cylinder(std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> block,
                                       std::span<const Eigen::Vector3d> places,
                                       std::span<const Eigen::Vector3d> normals, double least_scale);

}  // namespace seampath
