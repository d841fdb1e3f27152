#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stages/nominal/nominal.hpp"

/// The interpolation points of `seampath saddle`.
namespace seampath {

/// As on the command line.
struct SaddleStepOptions {
    std::string step = "arc-length";
    int steps = 40;
    std::string pose = "bisector";
    double pose_angle_deg = 45;
    std::optional<double> period_s;
};

struct SaddleSteps {
    StepLaw law = StepLaw::arc_length;
    PoseLaw pose = PoseLaw::bisector;
    double initial = 0;  ///< the paper's phi, rad
    double step_mm = 0;
    double speed_mm_s = 0;
    std::vector<double> angles;
};

/// Throws InputError, naming the option, for what is no law, step or period.
SaddleSteps saddle_steps(const SaddleCurve& curve, const SaddleStepOptions& given, double speed_mm_s);

/// One line a point: branch angle, station, time, position, torch angle, opening, curvature, tangent, both normals.
std::string saddle_points_csv(const SaddleCurve& curve, const SaddleSteps& steps);

}  // namespace seampath
