#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "stages/geometry/photo_view.hpp"
#include "stages/types.hpp"

/// A seam between two flat sheets in a photograph.
namespace seampath {

/// One point of the seam's middle.
struct PhotoPoint {
    Eigen::Vector2d p;       ///< px: x to the right, y down, from the middle of the first pixel
    Eigen::Vector2d normal;  ///< unit, across the seam
    double sigma_px = 0;     ///< 1-sigma of p along the normal
    bool modelled = false;   ///< carried over from both sides: a tack, a hole or a highlight hides the seam
};

/// The seam, from left to right or from top to bottom, and how it was told from other lines.
struct PhotoLine {
    std::vector<PhotoPoint> points;
    double width_px = 0;           ///< of the line, median
    bool between_borders = false;  ///< it lies midway between two borders, as the seam of a prepared joint does
    double clarity = 0;            ///< what shows it, in sigmas of texture a block, with the borders
    double rival_clarity = 0;      ///< the same of the best line elsewhere
};

/// The seam of two sheets: a line darker or brighter than both of its sides, that may change from the one to the other,
/// crosses the picture from side to side or from top to bottom, and is at most 45 degrees off that course. Empty where
/// there is none.
///
/// Texture shows many short lines; a seam is what agrees over the whole picture. So lines of many widths and slopes are
/// measured in blocks, against what texture gives around them, and the path that is worth most is found by dynamic
/// programming over places and slopes: it goes straight over tacks, holes and highlights. Of several lines side by side
/// the one midway between two borders is the seam. The strip about it is laid out straight and searched again for lines
/// about as wide, in it the ridge is measured to a fraction of a pixel (stages/geometry/steger.hpp), and a line as
/// smooth as the measurement lets it be is laid through, robustly: flakes and holes are modelled. It ends at the
/// picture's borders, or where what is not measured is longer than the line is smooth over.
///
/// Fails: a scratch along the whole picture is a line like any other, and a joint whose sheets overlap shows one border
/// and no line.
std::optional<PhotoLine> find_photo_line(const GreyImage& image);

/// The seam in the plane's frame, mm: a butt joint whose flanks both face the camera. Its 1-sigma holds that of the
/// plane, across the seam. Throws InputError as point_on_plane() does.
Seam seam_on_plane(const PhotoLine& line, const PhotoView& view);

}  // namespace seampath
