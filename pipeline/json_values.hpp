#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

/// Vectors, matrices and poses as they stand in result files.
namespace seampath {

nlohmann::ordered_json vector_json(const Eigen::Vector3d& v);

/// A list of rows.
nlohmann::ordered_json matrix_json(const Eigen::MatrixXd& m);

/// Position, quaternion and matrix.
nlohmann::ordered_json pose_json(const Eigen::Isometry3d& T);

/// The matrix of so many rows and columns. Throws nlohmann::json::exception for anything else.
Eigen::MatrixXd matrix_of(const nlohmann::ordered_json& json, Eigen::Index rows);

}  // namespace seampath
