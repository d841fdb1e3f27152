#pragma once

#include "stages/extract/surfels.hpp"

namespace seampath::detail {

/// How far the face with normal n goes on from p along d (a unit vector within it), by steps over its surfels; it may
/// bend gently. Holes of a few cells are passed. mm, at most `most`.
double face_width(const Surfels& surfels, const PointGrid& grid, Eigen::Vector3d p, Eigen::Vector3d d,
                  Eigen::Vector3d n, double most);

}  // namespace seampath::detail
