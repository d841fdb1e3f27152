#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/geometry/arm.hpp"
#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

/// The section that passes fill, between two sides from the root up.
///   none     one pass along the seam
///   fillet   the sides are the seam's flanks; so for a V-groove of a scan, whose flanks are its bevels
///   v        both sides at half of groove_angle_deg from the flanks' bisector
///   bevel1   flank 2 is one side, and the other, on the side of flank 1, at groove_angle_deg from it; bevel2 the same
///            with the flanks exchanged
enum class GrooveForm { none, fillet, v, bevel1, bevel2 };
inline constexpr std::array<std::string_view, 5> kGrooveFormNames{"none", "fillet", "v", "bevel1", "bevel2"};

/// From which side the beads of a layer follow each other; `alternate` begins at the other side in every second layer.
enum class PassOrder { flank1, flank2, alternate };
inline constexpr std::array<std::string_view, 3> kPassOrderNames{"flank1", "flank2", "alternate"};

struct PlanOptions {
    double speed_mm_s = 8;
    double approach_mm = 30;
    double retract_mm = 30;
    double air_speed_mm_s = 100;
    double chord_tolerance_mm = 0.02;
    double max_turn_deg = 3;
    double work_angle_deg = 0;
    double travel_angle_deg = 0;
    GrooveForm groove = GrooveForm::none;
    double groove_depth_mm = 6;
    double groove_root_mm = 0;
    double groove_angle_deg = 60;
    double bead_area_mm2 = 20;
    double bead_width_to_height = 2;
    PassOrder pass_order = PassOrder::flank2;
    double pass_tilt_deg = 15;
    std::string arm;
    std::vector<double> flange_from_tool{0, 0, 0, 1, 0, 0, 0};  ///< x, y, z mm, qw, qx, qy, qz
    double arm_roll_deg = 180;
    std::vector<double> arm_acceleration_deg_s2{500, 500, 500, 1000, 1000, 1000};
    std::string fixture;  ///< file; says nothing to plan(), which works in the frame of the scan
    std::optional<double> fixture_max_age_h;
};
Fields describe(PlanOptions&);

/// What no single field's bounds can say. Each reads "key: what is wrong, with the value; what was needed"; empty when
/// all is well.
std::vector<std::string> plan_problems(const PlanOptions& options);

/// The arm that makes the travel, where it stands and what it holds.
struct ArmCell {
    Arm arm;
    Eigen::Isometry3d base_from_scan = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d flange_from_tool = Eigen::Isometry3d::Identity();
};

/// Torch poses along all models in the given order: +Z into the joint on the bisector of the flanks, +X along travel,
/// constant tool speed by inversion of the arc length, approach before and retract after each seam, and a point in the
/// air between two seams where the straight way would come near one. A closed seam ends in its first pose. Times are
/// those of the commanded speeds; turning on the spot takes none. Where options.groove asks for it, each seam is welded
/// in the passes that fill its groove, each with approach and retract of its own and all under the seam's number.
///
/// With a cell the plan says how the arm makes the travel: Plan::arm. The torch may be turned about its wire for it, by
/// up to options.arm_roll_deg: waypoints get that turn, and more of them where it changes. An arm that can't make the
/// travel leaves the waypoints as they are, with the reason in its verdict. Through the air it goes by its axes, and
/// times are those of that. `options.arm`, a name, says nothing here.
///
/// Throws InputError naming seam and station where the flanks have no bisector or the torch direction jumps, for a seam
/// shorter than ten chord tolerances, and for a groove that no passes fill.
Plan plan(std::span<const SeamModel> models, const PlanOptions& options, const std::optional<ArmCell>& cell = {});

}  // namespace seampath
