#include "stages/geometry/flank_surface.hpp"

#include <array>
#include <string>

#include "stages/error.hpp"

namespace seampath {
namespace {

constexpr std::array<Eigen::Index, 4> kParameters{3, 5, 6, 4};  // in the order of SurfaceShape

void describe_shape(FlankSurface& to, const Plane& s) {
    to.shape = SurfaceShape::plane;
    to.point = s.point;
    to.direction = s.normal;
}
void describe_shape(FlankSurface& to, const Cylinder& s) {
    to.shape = SurfaceShape::cylinder;
    to.point = s.point;
    to.direction = s.axis;
    to.size = s.radius;
}
void describe_shape(FlankSurface& to, const Cone& s) {
    to.shape = SurfaceShape::cone;
    to.point = s.apex;
    to.direction = s.axis;
    to.size = s.half_angle;
}
void describe_shape(FlankSurface& to, const Sphere& s) {
    to.shape = SurfaceShape::sphere;
    to.point = s.centre;
    to.size = s.radius;
}

SurfaceFit::Shape shape_of(const FlankSurface& s, const Eigen::Vector3d& point) {
    switch (s.shape) {
        case SurfaceShape::cylinder:
            return Cylinder{point, s.direction, s.size};
        case SurfaceShape::cone:
            return Cone{point, s.direction, s.size};
        case SurfaceShape::sphere:
            return Sphere{point, s.size};
        case SurfaceShape::plane:
            break;
    }
    return Plane{point, s.direction};
}

}  // namespace

FlankSurface flank_surface(const SurfaceFit& fit, const Eigen::MatrixXd& covariance) {
    FlankSurface surface;
    std::visit([&](const auto& s) { describe_shape(surface, s); }, fit.shape());
    surface.bore = fit.bore();
    surface.scale_mm = fit.scale();
    surface.share_taken = fit.share_taken();
    surface.origin = fit.frame().origin;
    surface.e0 = fit.frame().e0;
    surface.e1 = fit.frame().e1;
    surface.lever_mm = fit.frame().length;
    surface.covariance = rows_of(covariance);
    return surface;
}

SurfaceFit surface_fit(const FlankSurface& s, const Eigen::Vector3d& origin) {
    const Eigen::Index n = kParameters[static_cast<std::size_t>(s.shape)];
    return {shape_of(s, s.point - origin), s.bore,     SurfaceFrame{s.origin - origin, s.lever_mm, s.e0, s.e1},
            matrix_of(s.covariance, n, n), s.scale_mm, s.share_taken};
}

std::vector<double> rows_of(const Eigen::MatrixXd& matrix) {
    std::vector<double> rows;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
        for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
            rows.push_back(matrix(i, j));
        }
    }
    return rows;
}

Eigen::MatrixXd matrix_of(const std::vector<double>& rows, Eigen::Index height, Eigen::Index width) {
    if (std::ssize(rows) != height * width) {
        throw InputError("seam: a covariance has " + std::to_string(rows.size()) + " numbers; " +
                         std::to_string(height * width) + " are needed; extract the seam again");
    }
    Eigen::MatrixXd matrix(height, width);
    for (Eigen::Index i = 0; i < height; ++i) {
        for (Eigen::Index j = 0; j < width; ++j) {
            matrix(i, j) = rows[static_cast<std::size_t>(i * width + j)];
        }
    }
    return matrix;
}

}  // namespace seampath
