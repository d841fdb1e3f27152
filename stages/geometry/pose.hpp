#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Rotations as the stages and the robot languages speak of them. Quaternions are unit; q and -q are the same rotation.
namespace seampath {

/// Angle of the rotation that takes a to b, rad, 0..pi; exact to rounding for small and for large angles alike.
double rotation_angle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

/// q or -q, whichever lies on the same side as `reference`.
Eigen::Quaterniond nearest_sign(const Eigen::Quaterniond& q, const Eigen::Quaterniond& reference);

/// Axis times angle, rad, of length 0..pi; exact at 0 and at pi (a torch straight down).
Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& q);

/// Angles (z, y, x) of q = Rz(z) Ry(y) Rx(x), rad: z and x in -pi..pi, y in -pi/2..pi/2. Robots call them A, B, C or
/// R, P, W. Where y is +-pi/2 only z + x or z - x is fixed, and z is taken as `free_z`; near there all three are exact
/// together, though z and x alone tell little.
Eigen::Vector3d euler_zyx(const Eigen::Quaterniond& q, double free_z = 0);

/// Rz(z) Ry(y) Rx(x).
Eigen::Quaterniond from_euler_zyx(double z, double y, double x);

/// Distance of p from the straight line between a and b, mm; a and b may coincide.
double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace seampath
