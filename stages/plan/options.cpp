#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "stages/plan/plan.hpp"
#include "stages/plan/text.hpp"

namespace seampath {

Fields describe(PlanOptions& o) {
    return {
        {"speed_mm_s", &o.speed_mm_s, "travel speed along the seam, mm/s", within(0.1, 1000)},
        {"run_in", choice(o.run_in, kRunInNames),
         "where the torch gets to its speed and comes to rest: none leaves it to the robot; within takes the first and "
         "the last bit of the weld; before takes a lead-in and lead-out, and the weld has one speed"},
        {"acceleration_mm_s2", &o.acceleration_mm_s2, "largest change of the speed along the seam, mm/s2",
         within(1, 100000)},
        {"jerk_mm_s3", &o.jerk_mm_s3, "largest change of that acceleration, mm/s3", within(10, 10000000)},
        {"centripetal_mm_s2", &o.centripetal_mm_s2,
         "largest acceleration across the seam where it bends, speed squared over radius; the torch slows down for it, "
         "mm/s2",
         within(0.1, 100000)},
        {"turn_rate_deg_s", &o.turn_rate_deg_s,
         "largest rate at which the torch turns along the seam; it slows down "
         "for it, deg/s",
         within(0.1, 5000)},
        {"period_s", &o.period_s, "waypoints of the weld at equal times instead of as few as hold the tolerance, s",
         within(0.0001, 100)},
        {"step_mm", &o.step_mm, "waypoints of the weld at equal distances instead, mm", within(0.001, 1000)},
        {"at_knots", &o.at_knots, "waypoints of the weld at the knots of the seam's curve instead"},
        {"approach_mm", &o.approach_mm, "distance of the approach point before the weld, back along the torch, mm",
         within(1, 1000)},
        {"retract_mm", &o.retract_mm, "distance of the retract point after the weld, back along the torch, mm",
         within(1, 1000)},
        {"air_speed_mm_s", &o.air_speed_mm_s, "speed of all moves without arc, mm/s", within(1, 5000)},
        {"chord_tolerance_mm", &o.chord_tolerance_mm, "largest distance of straight moves from the seam curve, mm",
         within(0.001, 5)},
        {"max_turn_deg", &o.max_turn_deg, "largest turn of the torch between neighbouring waypoints, deg",
         within(0.1, 45)},
        {"work_angle_deg", &o.work_angle_deg,
         "turn of the torch about the direction of travel, deg; above 0 its body leans towards flank 1",
         within(-60, 60)},
        {"travel_angle_deg", &o.travel_angle_deg,
         "turn of the torch about the cross direction, deg; above 0 it points ahead (push), below 0 back (drag)",
         within(-60, 60)},
        {"torch_law", choice(o.torch_law, kTorchLawNames),
         "what the torch keeps to: the flanks' bisector, or flank_angle_deg to flank1 or to flank2"},
        {"flank_angle_deg", &o.flank_angle_deg, "angle of the torch to the flank that torch_law names, deg",
         within(5, 120)},
        {"angle_table", &o.angle_table,
         "work and travel angle along the seam, instead of the constant ones: station mm, work deg, travel deg, and so "
         "on, straight in between",
         within(-100000, 100000)},
        {"tilt_rate_deg_mm", &o.tilt_rate_deg_mm,
         "largest change of the torch's lean in the seam's own frame, over which it is smoothed, deg/mm",
         within(0.001, 100)},
        {"roll", choice(o.roll, kRollLawNames),
         "turn about the wire: travel keeps X along travel, least turns the torch as little as possible"},
        {"roll_deg", &o.roll_deg, "turn of the torch about its wire from there, deg", within(-180, 180)},
        {"corner_reach_mm", &o.corner_reach_mm,
         "way before and behind a seam's corner over which the torch turns from one side of it to the other, mm",
         within(0.1, 1000)},
        {"start_station_mm", &o.start_station_mm,
         "where a closed seam's weld begins, mm; 0: at its first point, or in the middle of the longest side of one "
         "with corners",
         within(0, 100000)},
        {"backwards", &o.backwards, "weld from the seam's end to its start"},
        {"extend_start_mm", &o.extend_start_mm,
         "how far the weld begins before an open seam's start, straight on; below 0 behind it, mm",
         within(-10000, 1000)},
        {"extend_end_mm", &o.extend_end_mm, "the same of its end, mm", within(-10000, 1000)},
        {"overlap_mm", &o.overlap_mm, "way that a closed seam's weld goes on over its own start, mm", within(0, 1000)},
        {"pattern", choice(o.pattern, kWeldPatternNames),
         "what is welded: the whole seam, stitches of a length with gaps, or a number of tacks"},
        {"stitch_length_mm", &o.stitch_length_mm, "length of a stitch, mm", within(1, 10000)},
        {"stitch_gap_mm", &o.stitch_gap_mm, "gap between stitches, mm; evened out so that both ends are welded",
         within(1, 10000)},
        {"tacks", &o.tacks, "number of tacks, from end to end of the seam", within(1, 1000)},
        {"tack_length_mm", &o.tack_length_mm, "length of a tack, mm", within(1, 1000)},
        {"lead_in_mm", &o.lead_in_mm, "way along the weld's direction without arc before it begins, mm",
         within(0, 1000)},
        {"lead_out_mm", &o.lead_out_mm, "the same after its end, mm", within(0, 1000)},
        {"crater_back_mm", &o.crater_back_mm, "way back over the weld before the arc ends, which fills the crater, mm",
         within(0, 100)},
        {"weave", choice(o.weave, kWeaveShapeNames), "shape in which the wire swings about the seam"},
        {"weave_amplitude_mm", &o.weave_amplitude_mm, "of the swing to each side, mm", within(0.05, 50)},
        {"weave_pitch_mm", &o.weave_pitch_mm, "way along the seam of one whole swing, mm", within(0.1, 200)},
        {"weave_frequency_hz", &o.weave_frequency_hz, "whole swings a second at speed_mm_s, instead of the pitch, Hz",
         within(0.01, 50)},
        {"weave_dwell_s", &o.weave_dwell_s, "time at each side of a swing in which the wire only goes along, s",
         within(0, 10)},
        {"order", choice(o.order, kSeamOrderNames),
         "order of the seams: as they were found, or with the shortest ways through the air"},
        {"order_turns_seams", &o.order_turns_seams, "whether order may weld open seams from their end"},
        {"order_moves_starts", &o.order_moves_starts, "whether order may begin closed seams anywhere"},
        {"nozzle_tip_mm", &o.nozzle_tip_mm,
         "diameter of the nozzle at its mouth, mm; with it the torch is held clear of the scan", within(1, 200)},
        {"nozzle_base_mm", &o.nozzle_base_mm, "diameter of the nozzle at its base, mm", within(1, 300)},
        {"nozzle_length_mm", &o.nozzle_length_mm, "length of the nozzle, mm", within(1, 1000)},
        {"stick_out_mm", &o.stick_out_mm, "from the nozzle's mouth to the tool centre point, mm", within(1, 200)},
        {"neck_angle_deg", &o.neck_angle_deg,
         "angle by which the torch's body is bent back from the nozzle's axis, deg", within(0, 90)},
        {"body_diameter_mm", &o.body_diameter_mm, "of the torch behind the nozzle, mm", within(1, 300)},
        {"body_length_mm", &o.body_length_mm, "of the torch behind the nozzle, mm", within(1, 1000)},
        {"torch_clearance_mm", &o.torch_clearance_mm, "least distance of the torch from the scan, mm", within(0, 50)},
        {"max_free_angle_deg", &o.max_free_angle_deg,
         "most that the torch may be leaned aside to hold it clear of the scan, deg", within(0, 60)},
        {"free_angle_rate_deg_mm", &o.free_angle_rate_deg_mm, "largest change of that lean along the seam, deg/mm",
         within(0.01, 100)},
        {"groove", choice(o.groove, kGrooveFormNames),
         "section that passes fill: none is one pass; fillet lies between the flanks, v about their bisector, bevel1 "
         "between flank 2 and a bevel on the side of flank 1, bevel2 the other way round"},
        {"groove_depth_mm", &o.groove_depth_mm, "height of the fill above the root, along the groove's middle, mm",
         within(0.5, 200)},
        {"groove_root_mm", &o.groove_root_mm, "width of the groove at its root, mm", within(0, 50)},
        {"groove_angle_deg", &o.groove_angle_deg, "angle between the sides of a v, bevel1 or bevel2, deg",
         within(4, 160)},
        {"bead_area_mm2", &o.bead_area_mm2, "section of one bead, mm2: wire feed times wire section over speed",
         within(0.5, 1000)},
        {"bead_width_to_height", &o.bead_width_to_height, "width of a bead over its height", within(0.5, 8)},
        {"pass_order", choice(o.pass_order, kPassOrderNames), "side from which the beads of a layer are welded"},
        {"pass_tilt_deg", &o.pass_tilt_deg, "lean of the torch away from a groove's side at the beads beside it, deg",
         within(0, 45)},
        {"arm", &o.arm,
         "robot arm that makes the travel: abb-irb-1600-6-1.2, abb-irb-1600-8-1.45, ur10e, kuka-kr-16-2, fanuc-m-10ia, "
         "or a URDF file; empty: none. It stands where export.base_from_scan says"},
        {"flange_from_tool",
         &o.flange_from_tool,
         "pose of the torch's tip in the arm's flange: x, y, z mm, qw, qx, qy, qz",
         {},
         7},
        {"arm_roll_deg", &o.arm_roll_deg, "most that the arm may turn the torch about its wire, either way, deg",
         within(0, 180)},
        {"arm_travel_angle_deg", &o.arm_travel_angle_deg,
         "most that the travel angle may be changed, either way, for an arm that can't make the travel otherwise, deg",
         within(0, 45)},
        {"arm_acceleration_deg_s2", &o.arm_acceleration_deg_s2, "acceleration limits of the arm's axes, deg/s2",
         above(0), 6},
        {"fixture", &o.fixture,
         "result.json of a fixture calibration: the program moves to where it says that the part stands, in place of "
         "export.base_from_scan, and its uncertainty joins that of the waypoints; empty: none"},
        {"fixture_max_age_h", &o.fixture_max_age_h, "oldest calibration that is taken, hours; none: any", above(0)},
    };
}

std::vector<std::string> plan_problems(const PlanOptions& options) {
    std::vector<std::string> problems;
    const auto& pose = options.flange_from_tool;
    double norm = 0;
    bool finite = pose.size() == 7;
    for (std::size_t i = 0; finite && i < pose.size(); ++i) {
        finite = std::isfinite(pose[i]);
        norm = i >= 3 ? std::hypot(norm, pose[i]) : 0;
    }
    if (!finite || std::abs(norm - 1) > 1e-6) {
        problems.push_back("flange_from_tool: the quaternion qw, qx, qy, qz has a length of " + planning::number(norm) +
                           "; x, y, z in mm and a quaternion of length 1 were needed");
    }
    if (int(options.period_s.has_value()) + int(options.step_mm.has_value()) + int(options.at_knots) > 1) {
        problems.push_back(
            "period_s: with step_mm or at_knots it says twice where waypoints lie; one of the three was needed");
    }
    if (options.angle_table.size() % 3 != 0) {
        problems.push_back("angle_table: " + std::to_string(options.angle_table.size()) +
                           " numbers; three for each place were needed: station mm, work deg, travel deg");
    }
    for (std::size_t i = 0; i + 2 < options.angle_table.size(); i += 3) {
        const double station = options.angle_table[i];
        const double steepest = std::max(std::abs(options.angle_table[i + 1]), std::abs(options.angle_table[i + 2]));
        if (i > 0 && !(station > options.angle_table[i - 3])) {
            problems.push_back("angle_table: station " + planning::number(station) +
                               " does not lie behind the one before; ascending stations were needed");
        }
        if (!(steepest <= 60)) {
            problems.push_back("angle_table: an angle of " + planning::number(steepest) + " deg at station " +
                               planning::number(station) + "; -60 to 60 were needed");
        }
    }
    const double swing_s =
        options.weave_frequency_hz ? 1 / *options.weave_frequency_hz : options.weave_pitch_mm / options.speed_mm_s;
    if (options.weave != WeaveShape::none && 2 * options.weave_dwell_s >= swing_s) {
        problems.push_back("weave_dwell_s: twice " + planning::number(options.weave_dwell_s) +
                           " s leave no time to swing in the " + planning::number(swing_s) +
                           " s of one swing; a shorter dwell or a longer swing was needed");
    }
    return problems;
}

}  // namespace seampath
