#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace seampath {

struct PictureLine {
    std::vector<Eigen::Vector3d> points;  ///< of a polyline, mm
    std::string style;                    ///< CSS class
};

/// Lines in space as an inline SVG of this size in CSS pixels, seen square to the plane that is nearest to all their
/// points, their longest direction across. `title` is for readers who can't see it.
std::string line_picture(std::span<const PictureLine> lines, double width, double height, std::string_view title);

}  // namespace seampath
