#pragma once

#include <filesystem>

#include "pipeline/robot_calibration.hpp"

namespace seampath {

/// Poses of the flange from a table, one a row. The header says the unit and what the rotations are: x_mm,y_mm,z_mm or
/// x_m,y_m,z_m, and qw,qx,qy,qz (quaternion), rx_rad,ry_rad,rz_rad (rotation vector, as UR's), a_deg,b_deg,c_deg (KUKA:
/// Rz(a) Ry(b) Rx(c)) or w_deg,p_deg,r_deg (FANUC: Rz(r) Ry(p) Rx(w)). Throws InputError.
RobotMeasurement read_pose_table(const std::filesystem::path& file);

}  // namespace seampath
