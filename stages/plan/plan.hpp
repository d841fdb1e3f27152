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

/// Where the torch gets to its speed and comes to rest again.
///   none     on the spot: the robot's own ramps are not planned, and the weld is made at one speed from end to end
///   within   on the first and the last bit of the weld, from rest to rest
///   before   on the lead-in and the lead-out, which are as long as that takes: the weld begins and ends at full speed
enum class RunIn { none, within, before };
inline constexpr std::array<std::string_view, 3> kRunInNames{"none", "within", "before"};

/// What the torch keeps to in the section square to travel.
///   bisector   the middle between the flanks
///   flank1     the angle flank_angle_deg to that flank; flank2 likewise. With flank2, the header, and 45 deg this is
///              the law of a saddle's torch of Xue et al. 2018, eq. (12): delta = pi/2 - beta + phi from the branch's
///              wall
enum class TorchLaw { bisector, flank1, flank2 };
inline constexpr std::array<std::string_view, 3> kTorchLawNames{"bisector", "flank1", "flank2"};

/// How the torch is turned about its wire.
///   travel   +X stays along travel
///   least    along travel at the start, then turned about the wire as little as the wire's own way asks for: not at
///   all
enum class RollLaw { travel, least };
inline constexpr std::array<std::string_view, 2> kRollLawNames{"travel", "least"};

/// Which parts of a seam are welded: all of it, pieces of a length with gaps, or a number of short ones.
enum class WeldPattern { whole, stitch, tack };
inline constexpr std::array<std::string_view, 3> kWeldPatternNames{"whole", "stitch", "tack"};

/// How the wire swings about its way (weave.hpp).
enum class WeaveShape { none, sine, triangle, zigzag, circle, figure_eight };
inline constexpr std::array<std::string_view, 6> kWeaveShapeNames{"none",   "sine",   "triangle",
                                                                  "zigzag", "circle", "figure-eight"};

/// In which order seams are welded.
enum class SeamOrder { found, shortest };
inline constexpr std::array<std::string_view, 2> kSeamOrderNames{"found", "shortest"};

struct PlanOptions {
    double speed_mm_s = 8;
    RunIn run_in = RunIn::none;
    double acceleration_mm_s2 = 500;
    double jerk_mm_s3 = 5000;
    double centripetal_mm_s2 = 500;
    double turn_rate_deg_s = 360;
    std::optional<double> period_s;
    std::optional<double> step_mm;
    bool at_knots = false;
    double approach_mm = 30;
    double retract_mm = 30;
    double air_speed_mm_s = 100;
    double chord_tolerance_mm = 0.02;
    double max_turn_deg = 3;
    double work_angle_deg = 0;
    double travel_angle_deg = 0;
    TorchLaw torch_law = TorchLaw::bisector;
    double flank_angle_deg = 45;
    std::vector<double> angle_table;  ///< station mm, work angle deg, travel angle deg, and so on
    std::optional<double> tilt_rate_deg_mm;
    RollLaw roll = RollLaw::travel;
    double roll_deg = 0;
    double corner_reach_mm = 10;
    double start_station_mm = 0;
    bool backwards = false;
    double extend_start_mm = 0;
    double extend_end_mm = 0;
    double overlap_mm = 0;
    WeldPattern pattern = WeldPattern::whole;
    double stitch_length_mm = 30;
    double stitch_gap_mm = 50;
    int tacks = 3;
    double tack_length_mm = 10;
    double lead_in_mm = 0;
    double lead_out_mm = 0;
    double crater_back_mm = 0;
    WeaveShape weave = WeaveShape::none;
    double weave_amplitude_mm = 2;
    double weave_pitch_mm = 4;
    std::optional<double> weave_frequency_hz;
    double weave_dwell_s = 0;
    SeamOrder order = SeamOrder::found;
    bool order_turns_seams = false;
    bool order_moves_starts = false;
    std::optional<double> nozzle_tip_mm;  ///< of a torch that is held clear of the scan; none: it is not looked at
    double nozzle_base_mm = 25;
    double nozzle_length_mm = 60;
    double stick_out_mm = 15;
    double neck_angle_deg = 0;
    double body_diameter_mm = 40;
    double body_length_mm = 120;
    double torch_clearance_mm = 0.5;
    double max_free_angle_deg = 20;
    double free_angle_rate_deg_mm = 1;
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
    double arm_travel_angle_deg = 0;
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
/// the speed of speed.hpp by inversion of the arc length, approach before and retract after each seam, and a point in
/// the air between two seams where the straight way would come near one. A closed seam ends in its first pose. Times
/// along a weld are the integral of ds over the speed there, elsewhere those of the commanded speeds; turning on the
/// spot takes none. Where options.groove asks for it, each seam is welded
/// in the passes that fill its groove, each with approach and retract of its own and all under the seam's number.
///
/// With a cell the plan says how the arm makes the travel: Plan::arm. The torch may be turned about its wire for it, by
/// up to options.arm_roll_deg: waypoints get that turn, and more of them where it changes. An arm that can't make the
/// travel leaves the waypoints as they are, with the reason in its verdict; where options.arm_travel_angle_deg allows
/// it, the travel is planned anew with other travel angles before, and the first that the arm makes is taken. Through
/// the air it goes by its axes, and times are those of that. `options.arm`, a name, says nothing here.
///
/// With a scan and options.nozzle_tip_mm the torch is held clear of its points; a seam that leaves it no room gets no
/// waypoints: Plan::refused.
///
/// Throws InputError naming seam and station where the flanks have no bisector or the torch direction jumps, for a seam
/// shorter than ten chord tolerances, a weld shorter than its run-in, leads, way back or half a swing, pieces that
/// don't fit, and a groove that no passes fill.
Plan plan(std::span<const SeamModel> models, const PlanOptions& options, const std::optional<ArmCell>& cell = {},
          const Scan* scan = nullptr);

}  // namespace seampath
