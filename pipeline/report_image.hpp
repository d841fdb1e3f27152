#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "stages/types.hpp"

namespace seampath {

struct ScanInput;

/// A picture that the part was measured in, small, as a JPEG, and what was found in it.
struct ReportImage {
    std::string title;
    std::string jpeg;
    int width = 0;  ///< px of the picture itself, in which the lines are
    int height = 0;
    std::vector<std::vector<Eigen::Vector2d>> measured;  ///< polylines, px
    std::vector<std::vector<Eigen::Vector2d>> modelled;  ///< bridged parts
    std::vector<Eigen::Vector2d> features;               ///< where seams cross the picture
    std::string legend;                                  ///< what the lines are
};

/// A photograph with its seams; of a laser line carried along a part, one picture with the line and where the first
/// seam crosses it. Of any other scan nothing.
std::vector<ReportImage> report_images(const ScanInput& input, const std::vector<Seam>& seams);

/// The pictures with what was found drawn over them, as HTML; empty without pictures.
std::string image_section(const std::vector<ReportImage>& images);

}  // namespace seampath
