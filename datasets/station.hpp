#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "datasets/rng.hpp"
#include "datasets/scanner.hpp"

namespace seampath {

/// Where one view is taken from. Sensor axes: x right along a row, y down the rows, z away from the sensor.
/// A camera sees all rows from one place, with a projector beside it. A profile sensor moves along y: each row is one
/// laser fan from its own place, with a camera before it.
struct Station {
    Eigen::Isometry3d scene_from_sensor = Eigen::Isometry3d::Identity();
    Eigen::Vector3d other_eye;          ///< of row 0 for a profile sensor; scene frame
    Eigen::Vector3d row_step{0, 0, 0};  ///< by which both eyes move from row to row; scene frame
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    double focal_x = 0;   ///< pixels
    double focal_y = 0;   ///< pixels; infinite for a profile sensor, whose rows have no slope
    double centre_x = 0;  ///< pixel on the sensor's z axis
    double centre_y = 0;
    double nearest = 0;  ///< depth of the box around the part, mm
    double farthest = 0;

    Eigen::Vector3d eye(std::uint32_t row) const { return scene_from_sensor.translation() + row * row_step; }
    Eigen::Vector3d second_eye(std::uint32_t row) const { return other_eye + row * row_step; }

    /// Direction of a pixel's ray in the scene, so long that its depth (along the sensor's z) is 1.
    Eigen::Vector3d sight(double column, double row) const {
        return scene_from_sensor.linear() *
               Eigen::Vector3d((column - centre_x) / focal_x, (row - centre_y) / focal_y, 1);
    }
};

/// Station number `index` of options.views, about evenly round the part from the scene's front; it covers the whole
/// part.
Station make_station(const Scene& scene, const ScannerOptions& options, const Random& placing, int index);

}  // namespace seampath
