#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// The values that flow from stage to stage. Lengths are mm, angles rad, times s, speeds mm/s; frames are right-handed;
/// every position is in the scan's own frame unless its name says otherwise.
namespace seampath {

/// What was measured. Points are kept as 32-bit offsets from `origin_mm` so that a part far from the scanner's origin
/// loses no digits and ten million points stay at 12 bytes each.
struct Scan {
    std::string name;                      ///< file name without folder and extension
    Eigen::Vector3d origin_mm{0, 0, 0};    ///< position of point i is origin_mm + points[i]
    std::vector<Eigen::Vector3f> points;   ///< all finite
    std::vector<Eigen::Vector3f> normals;  ///< unit, one per point, or empty when the file has none
    std::uint32_t width = 0;               ///< raster of an organised cloud, or 0
    std::uint32_t height = 0;              ///< raster of an organised cloud, or 0
    std::vector<std::uint32_t> pixel;      ///< row * width + column of each point, ascending; empty when unorganised
    std::optional<Eigen::Vector3d> sensor_mm;  ///< where the sensor stood, when the file says so
    std::string format;                        ///< e.g. "ply binary_little_endian"
    double mm_per_unit = 1;                    ///< factor that was applied to the file's numbers
    std::string unit_reason;                   ///< why that factor was taken
    std::uint64_t points_in_file = 0;          ///< records in the file
    std::uint64_t dropped_not_finite = 0;      ///< records with NaN or Inf, left out of `points`

    Eigen::Vector3d position(std::size_t i) const { return origin_mm + points[i].cast<double>(); }
};

/// Joint kinds. `saddle` is a fillet round a pipe whose model is the exact curve in which the pipe meets another pipe,
/// a plate, a cone or a sphere.
enum class JointKind { fillet, lap, butt, v_groove, corner, saddle };
inline constexpr std::array<std::string_view, 6> kJointKindNames{"fillet",   "lap",    "butt",
                                                                 "v-groove", "corner", "saddle"};
inline std::string_view name(JointKind kind) {
    return kJointKindNames[static_cast<std::size_t>(kind)];
}

/// One extracted point of a seam. Flank normals are unit and point out of the material, to the side of the torch.
struct SeamPoint {
    Eigen::Vector3d p;      ///< mm
    Eigen::Vector3d n1;     ///< normal of the first flank at p
    Eigen::Vector3d n2;     ///< normal of the second flank at p
    double sigma_mm = 0;    ///< 1-sigma of p across the seam
    bool modelled = false;  ///< true: bridged, not measured (support on both sides only)
};

/// A number and its 1-sigma; both NaN where the scan does not show it. Also one known from elsewhere, e.g. a drawing
/// and its tolerance.
struct Measured {
    double value = std::numeric_limits<double>::quiet_NaN();
    double sigma = std::numeric_limits<double>::quiet_NaN();
};

/// Section of a butt joint or groove at one place, in the terms of ISO 9692-1. Bevel angles are from the upright of
/// their plate; side 1 is the one of flank 1.
struct GrooveStation {
    Measured gap_mm;       ///< between the plates at the root, along the surface
    Measured mismatch_mm;  ///< height of plate 2's top above plate 1's
    Measured bevel1_rad;
    Measured bevel2_rad;
    Measured included_angle_rad;
    Measured depth_mm;      ///< of the bevels, from the tops' mean height to the root
    Measured root_face_mm;  ///< upright part of the edges below the bevels
    Measured area_mm2;      ///< of the section between the plates, the tops and the root
};

enum class SurfaceShape { plane, cylinder, cone, sphere };
inline constexpr std::array<std::string_view, 4> kSurfaceShapeNames{"plane", "cylinder", "cone", "sphere"};
inline std::string_view name(SurfaceShape shape) {
    return kSurfaceShapeNames[static_cast<std::size_t>(shape)];
}

/// One flank of a seam as one surface: the plane, cylinder, cone or sphere that is nearest to all the flank's points
/// along the seam. Only a fit that `explains` them is what the flank is; of any other the rest tells how far it is off.
struct FlankSurface {
    SurfaceShape shape = SurfaceShape::plane;
    Eigen::Vector3d point{0, 0, 0};      ///< of the plane; on the axis; apex; centre, mm
    Eigen::Vector3d direction{0, 0, 1};  ///< unit: normal out of the material, or axis; of no use for a sphere
    double size = 0;                     ///< radius, mm, or half angle, rad; 0 for a plane
    bool bore = false;                   ///< the material lies around the surface
    bool explains = false;               ///< the points scatter about it as about their windows' own surfaces
    double scale_mm = 0;                 ///< robust 1-sigma of the points' residuals
    double share_taken = 0;              ///< of the points that the robust fit took, 0..1
    /// What the covariance's parameters (stages/geometry/surface_parameters.hpp) count from.
    Eigen::Vector3d origin{0, 0, 0}, e0{1, 0, 0}, e1{0, 1, 0};
    double lever_mm = 1;
    /// Of the parameters, row by row, mm^2: of noise and of shifts of the views, as far as either is known.
    std::vector<double> covariance;
};

/// Both flanks of a seam as surfaces, where they were fitted.
struct SeamSurfaces {
    std::optional<FlankSurface> first, second;
    /// Of the first's parameters with the second's, row by row, mm^2: both see the same shifts of the views. Empty when
    /// one is missing.
    std::vector<double> covariance_between;
};

/// Ordered points of one seam. Flank 1 and 2 are so that the cross product n1 x n2 points along travel. A closed seam
/// does not repeat its first point.
struct Seam {
    JointKind kind = JointKind::fillet;
    bool closed = false;
    double confidence = 0;              ///< 0..1, how sure extraction is that this is a joint of that kind
    std::string kind_reason;            ///< what was seen that makes it one, e.g. "surfaces meet at 87 deg, ..."
    std::vector<SeamPoint> points;      ///< at least 4, in order along the seam
    std::vector<GrooveStation> groove;  ///< one a point of a butt joint or V-groove, otherwise empty
    SeamSurfaces surfaces;
    /// Ascending indices of the points in which it turns sharply from one surface to the next; their normals are the
    /// means of both sides'. A closed seam with corners begins at one.
    std::vector<std::size_t> corners;
};

/// Nodes on a smooth line through the seam's points.
struct NodeLine {
    std::vector<double> station_mm;  ///< of each node along the line from the first point's foot, ascending
    std::vector<Eigen::Vector3d> p;  ///< of each node, mm: the foot of its seam point
    double length_mm = 0;            ///< of the line; once round when closed
    double max_error_mm = 0;         ///< largest distance of the cubic spline through the nodes from the line
};

/// The few points that carry the shape of a seam.
struct Nodes {
    std::vector<std::size_t> index;  ///< ascending indices into Seam::points; open seams keep first and last
    double max_chord_error_mm = 0;   ///< largest distance of any seam point from the chord of its interval
    std::optional<NodeLine> line;    ///< without: the nodes are the seam points themselves
};

/// Cubic B-spline in space. Open: clamped knots, `control.size() + 4` of them. Periodic: `control.size() + 1` knots
/// bound the `control.size()` spans of one period; control points wrap round.
struct CubicBSpline {
    bool periodic = false;
    std::vector<double> knots;             ///< ascending, mm (approximate arc length)
    std::vector<Eigen::Vector3d> control;  ///< mm
};

/// Flank directions and uncertainty along a model, at ascending stations; interpolated in between.
struct FlankSample {
    double station_mm = 0;
    Eigen::Vector3d n1;
    Eigen::Vector3d n2;
    double sigma_mm = 0;
    bool modelled = false;
};

/// What a saddle is made of: a branch, which is a pipe, on a header.
struct SaddleParameters {
    SurfaceShape header = SurfaceShape::plane;
    Measured branch_radius_mm;
    std::optional<Measured> header_radius_mm;  ///< cylinder, sphere
    std::optional<Measured> angle_rad;         ///< between the axes, or the branch's axis and a plane
    std::optional<Measured> offset_mm;         ///< between the axes, or of a sphere's centre from the branch's axis
};

/// Where the seam is for sure but for one time in twenty: within this distance, across travel, of the model at a
/// station.
struct BandSample {
    double station_mm = 0;
    double half_width_mm = 0;
};

/// The curve that a seam is, and how well it follows the extracted points.
struct SeamModel {
    JointKind kind = JointKind::fillet;
    bool closed = false;
    CubicBSpline curve;
    double length_mm = 0;
    std::vector<FlankSample> flanks;  ///< at least 2; closed seams: stations in [0, length), wraps round
    double residual_rms_mm = 0;       ///< orthogonal distance of the extracted points from the curve
    double residual_max_mm = 0;
    double degrees_of_freedom = 0;  ///< effective: 3 times the trace of the hat matrix of one coordinate; a saddle's
                                    ///< parameters
    std::string model;              ///< by name, e.g. "spline", "saddle"
    std::string reason;             ///< why that one, one sentence
    std::optional<SaddleParameters> saddle;
    std::vector<BandSample> band;  ///< at ascending stations; empty where the model does not tell
    /// Ascending stations of its corners: the curve shares only its position there, and one flank sample stands for
    /// each side. A closed one with corners begins at one.
    std::vector<double> corners_mm;
};

/// Where one sample of the model lies relative to the scan's two flank surfaces.
struct DeviationSample {
    double station_mm = 0;
    Eigen::Vector3d p;       ///< point of the model, mm
    double flank1_mm = 0;    ///< signed distance to flank surface 1, + outside the material
    double flank2_mm = 0;    ///< the same for flank surface 2
    double distance_mm = 0;  ///< distance, in the section, to the line in which the two surfaces meet
    double sigma_mm = 0;     ///< 1-sigma of distance_mm
    bool covered = false;    ///< both flanks had enough scan points; otherwise the distances are meaningless
};

/// Verdict of one seam model against the raw scan. Statistics are over covered samples; `signed_mean_mm` is of the mean
/// of the two flank distances.
struct Deviation {
    std::vector<DeviationSample> samples;
    double signed_mean_mm = 0;
    double rms_mm = 0;
    double p50_mm = 0;
    double p95_mm = 0;
    double p997_mm = 0;
    double max_mm = 0;
    double coverage = 0;      ///< share of the seam's length with covered samples, 0..1
    double tolerance_mm = 0;  ///< what the verdict was taken against
    bool pass = false;
    std::string verdict;  ///< one sentence with the numbers behind `pass`
};

enum class WaypointKind { approach, weld_start, weld, weld_end, retract, air };
inline constexpr std::array<std::string_view, 6> kWaypointKindNames{"approach", "weld_start", "weld",
                                                                    "weld_end", "retract",    "air"};
inline std::string_view name(WaypointKind kind) {
    return kWaypointKindNames[static_cast<std::size_t>(kind)];
}

/// Torch pose: +Z along the torch into the joint, +X along travel, Y completes the right-handed frame.
struct Waypoint {
    int seam = 0;
    int index = 0;  ///< counts from 0 in each seam
    WaypointKind kind = WaypointKind::weld;
    double station_mm = 0;             ///< arc length along the seam; approach and retract carry that of their seam end
    Eigen::Vector3d p;                 ///< tool centre point, mm
    Eigen::Quaterniond q{1, 0, 0, 0};  ///< scan_from_tool, unit, no sign jumps from point to point
    double speed_mm_s = 0;             ///< speed towards this point
    double time_s = 0;                 ///< since the first waypoint of the plan
    double sigma_mm = 0;
};

/// One of several passes that fill the groove of one seam. Offsets are from the seam to the wire's aim, in the section
/// square to travel: across, towards flank 1, and up, out of the joint along the groove's middle; means along the seam.
struct PlannedPass {
    int seam = 0;
    int layer = 0;  ///< from 0, at the root
    int bead = 0;   ///< from 0, in the order of welding in its layer
    double across_mm = 0;
    double up_mm = 0;
    double tilt_rad = 0;   ///< of the torch's body from the groove's middle, towards flank 1
    double area_mm2 = 0;   ///< of the section that the pass fills, mean along the seam
    double least_mm2 = 0;  ///< of that section, where the groove is narrowest
    double most_mm2 = 0;
};

/// The torch at one place of a weld. Angles are of its wire against the bisector of the flanks: work about the
/// direction of travel, above 0 with the torch's body leaning towards flank 1; travel about the cross direction, above
/// 0 when it points ahead.
struct TravelSample {
    int seam = 0;
    int weld = 0;  ///< from 0 in each seam, in the order of welding: its passes, stitches
    double station_mm = 0;
    double speed_mm_s = 0;
    double acceleration_mm_s2 = 0;  ///< along the seam
    double centripetal_mm_s2 = 0;   ///< speed squared over the seam's radius
    double turn_rate = 0;           ///< of the torch, rad/s
    double work_rad = 0;
    double travel_rad = 0;
};

/// A seam that gets no torch path, and why.
struct SeamRefusal {
    int seam = 0;
    double station_mm = 0;
    double depth_mm = 0;  ///< by which the scan would reach into the torch there
    std::string reason;   ///< one sentence
};

/// Where a robot arm stands at one moment of a travel.
struct ArmSample {
    int seam = 0;
    WaypointKind kind = WaypointKind::weld;  ///< of the move's end
    int waypoint = -1;                       ///< index into Plan::waypoints, or -1 between two of them
    double station_mm = 0;
    double time_s = 0;
    std::array<double, 6> q{};  ///< rad
    double roll = 0;            ///< turn of the torch about its wire from +X along travel, rad
    double manipulability = 0;  ///< |det J| (Yoshikawa 1985), lengths in m
};

/// How a robot arm makes a travel, or why it can't.
struct ArmTravel {
    std::string arm;
    bool pass = false;
    std::string verdict;                         ///< one sentence with the numbers behind `pass`
    std::array<double, 6> lowest{}, highest{};   ///< of the axes, rad
    std::array<double, 6> max_speed{};           ///< of the axes, rad/s
    std::array<double, 6> max_acceleration{};    ///< of the axes, rad/s^2
    std::array<double, 6> speed_share{};         ///< largest speed of each axis over its limit
    std::array<double, 6> acceleration_share{};  ///< the same of accelerations
    double least_margin = 0;                     ///< smallest distance of an axis from its limits, rad
    double least_manipulability = 0;
    double max_roll = 0;  ///< largest turn about the wire that it took, rad
    double duration_s = 0;
    std::vector<ArmSample> samples;           ///< in the order of travel; empty when it can't reach all
    std::optional<Eigen::Vector3d> shift_mm;  ///< in the base: a move of the part after which it can
};

/// How the torch travels all seams, and how good the travel is.
struct Plan {
    std::vector<Waypoint> waypoints;  ///< in the order of travel
    double max_chord_error_mm = 0;    ///< largest distance of the seam curve from the straight moves
    double max_speed_error = 0;       ///< relative, of straight moves between weld waypoints against the seam's speed
    double max_turn_deg = 0;          ///< largest rotation between neighbouring weld waypoints
    double duration_s = 0;
    std::vector<PlannedPass> passes;   ///< in the order of travel; empty where every seam is one pass
    std::vector<TravelSample> travel;  ///< along every weld, ascending stations
    std::vector<SeamRefusal> refused;  ///< without waypoints
    std::optional<ArmTravel> arm;      ///< where an arm is given
};

}  // namespace seampath
