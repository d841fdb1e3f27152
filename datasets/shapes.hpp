#pragma once

#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

/// Exact surfaces and their intersection with rays. A part is a list of surfaces that bound closed solids; a new joint
/// kind is a new list, a new kind of surface one more alternative of `SceneShape`.
namespace seampath {

/// Plane through p; n is unit and points out of the material, as does the normal of every shape.
struct PlaneShape {
    Eigen::Vector3d p;
    Eigen::Vector3d n;
};

/// Around the line p + s axis (axis unit); the material lies inside for side = +1 (a bar), outside for side = -1 (a
/// bore).
struct CylinderShape {
    Eigen::Vector3d p;
    Eigen::Vector3d axis;
    double radius;
    double side = 1;
};

/// From the apex p along the axis (unit), by the half-angle with this sine and cosine; the material lies inside for
/// side = +1, outside for side = -1.
struct ConeShape {
    Eigen::Vector3d p;
    Eigen::Vector3d axis;
    double sin, cos;
    double side = 1;
};

struct SphereShape {
    Eigen::Vector3d p;
    double radius;
};

/// Wall y = offset + amplitude sin(wave_number x), upright in z; the material lies on the side of smaller y for side =
/// +1, of larger y for side = -1.
struct SineWall {
    double amplitude;
    double wave_number;
    double offset;
    double side;
};

using SceneShape = std::variant<PlaneShape, CylinderShape, ConeShape, SphereShape, SineWall>;

/// Keeps what lies on the inner side of the shape.
struct Surface {
    SceneShape shape;
    std::vector<SceneShape> inside_of;  ///< the surface ends where it leaves one of these
};

/// Signed value that vanishes on the shape and is positive outside the material, mm. It is the distance from the
/// surface, except from a sine wall (the distance along y) and before a cone's apex (the distance from the cone's
/// lines, drawn out).
double signed_value(const SceneShape& shape, const Eigen::Vector3d& p);

/// Unit normal, out of the material, at a point of the shape.
Eigen::Vector3d normal(const SceneShape& shape, const Eigen::Vector3d& p);

struct Ray {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;  ///< unit
};

struct Hit {
    double t;             ///< mm from the ray's origin
    std::size_t surface;  ///< index into the list
};

/// The first surface that the ray meets at more than 0 and less than `limit` mm.
std::optional<Hit> first_hit(const std::vector<Surface>& surfaces, const Ray& ray, double limit = 1e9);

}  // namespace seampath
