#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "stages/nominal/nominal.hpp"
#include "stages/types.hpp"

/// A saddle as it was fitted to a scan against its nominal dimensions: `seampath saddle --from`.
namespace seampath {

/// One dimension of both; rad and mm.
struct DimensionDifference {
    std::string name;  ///< without unit
    bool is_angle = false;
    Measured fitted;
    double nominal = 0;
    double difference() const { return fitted.value - nominal; }
};

/// One place of the nominal seam and how far the fitted seam is off it at the same branch angle.
struct PlaceDifference {
    double theta = 0;            ///< branch angle, rad
    double station_mm = 0;       ///< along the nominal seam
    Eigen::Vector3d nominal;     ///< mm, in the frame of SaddleDimensions
    Eigen::Vector3d difference;  ///< fitted - nominal, mm
    double form_mm = 0;          ///< of that, how far the fitted seam is off the saddle of its own dimensions
    double branch_wall_mm = 0;   ///< along the nominal branch's outward normal
    double header_wall_mm = 0;   ///< along the nominal header's outward normal
    double distance_mm = 0;      ///< of the part square to travel
    double sigma_mm = 0;         ///< of that part's length, from the sigmas of the dimensions as if independent
    double opening = 0;          ///< of the air between the walls, fitted - nominal, rad
};

struct SaddleDifference {
    std::size_t seam = 0;
    SaddleDimensions fitted, nominal;
    std::vector<DimensionDifference> dimensions;
    std::vector<PlaceDifference> places;  ///< at equal branch angles, once round without the last
    double fitted_length_mm = 0, nominal_length_mm = 0;
    double rms_mm = 0;  ///< of the distances
    PlaceDifference worst;
};

/// The dimensions of a fitted saddle as a drawing gives them. A fit gives angles of at most 90 deg and no sides; `like`
/// says on which side of 90 deg, and of the header's axis, the drawing has the branch. Throws InputError for a cone,
/// whose fit does not keep its half angle.
SaddleDimensions dimensions_of(const SaddleParameters& fitted, const std::optional<SaddleDimensions>& like);

/// Both in the frame of SaddleDimensions: a shift or a turn of the whole part is no difference. Where a closed seam was
/// fitted with smooth offsets from its saddle, these are part of the difference; of one with ends they are not. Throws
/// InputError when the headers are of different shapes, and as SaddleCurve does.
SaddleDifference saddle_difference(std::size_t seam, const SeamModel& fitted, const SaddleDimensions& nominal);

/// Whether a fitted saddle has smooth offsets.
bool has_offsets(const SeamModel& fitted);

std::string saddle_difference_text(const SaddleDifference& difference);
nlohmann::ordered_json saddle_difference_json(const SaddleDifference& difference);
std::string saddle_difference_csv(const std::vector<SaddleDifference>& differences);
std::string saddle_difference_svg(const std::vector<SaddleDifference>& differences);

}  // namespace seampath
