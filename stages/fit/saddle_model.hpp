#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "stages/fit/saddle_fit.hpp"
#include "stages/geometry/pspline.hpp"

namespace seampath {

/// A saddle as the curve of a seam.
struct SaddleModel {
    CubicBSpline curve;
    SaddleParameters parameters;
    bool has_offsets = false;
    double degrees_of_freedom = 0;
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> normals;  ///< of both flanks, at each point of the seam
    std::string reason;
};

/// The saddle of fit.hpp through a seam's points, in the frame in which `origin` is 0. `points` are in that frame, with
/// the weights that the smoothing spline left them; they get the parameters of the saddle's points nearest to them.
/// `exact` wants no offsets, however far the points are off within what a pipe may be. Throws InputError for nominals
/// that say nothing.
std::variant<SaddleModel, NoSaddle> saddle_model(const Seam& seam, const Eigen::Vector3d& origin, CurvePoints& points,
                                                 const SaddleNominals& nominals, bool exact);

}  // namespace seampath
