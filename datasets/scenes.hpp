#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "datasets/shapes.hpp"
#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

enum class SceneKind {
    tee,
    s_curve,
    box_on_plate,
    pipe_on_plate,
    pipe_on_pipe,
    pipe_on_pipe_oblique,
    pipe_on_pipe_equal,
    lap,
    butt,
    v_groove,
    corner,
    multi,
    plain,
    spatter
};
inline constexpr std::array<std::string_view, 14> kSceneNames{"tee",
                                                              "s-curve",
                                                              "box-on-plate",
                                                              "pipe-on-plate",
                                                              "pipe-on-pipe",
                                                              "pipe-on-pipe-oblique",
                                                              "pipe-on-pipe-equal",
                                                              "lap",
                                                              "butt",
                                                              "v-groove",
                                                              "corner",
                                                              "multi",
                                                              "plain",
                                                              "spatter"};
inline std::string_view name(SceneKind kind) {
    return kSceneNames[static_cast<std::size_t>(kind)];
}

/// Line that a lap, butt, V-groove or corner joint follows; only a lap joint can be S-curved.
enum class Course { straight, arc, s_curve };
inline constexpr std::array<std::string_view, 3> kCourseNames{"straight", "arc", "s-curve"};

/// Joint that the scene `spatter` spoils.
enum class Spattered { tee, lap };
inline constexpr std::array<std::string_view, 2> kSpatteredNames{"tee", "lap"};

/// What stands before the scanner. A dimension that is not set takes the scene's usual value, which the seed varies by
/// up to 20 % when `vary` says so. Dimensions that a scene has no use for are left alone.
struct SceneOptions {
    SceneKind kind = SceneKind::tee;
    bool vary = true;
    std::optional<double> length_mm;         ///< web along the seam, box along x
    std::optional<double> width_mm;          ///< box along y
    std::optional<double> height_mm;         ///< web, box or the shortest side of a branch, above the other part
    std::optional<double> thickness_mm;      ///< web
    std::optional<double> lean_deg;          ///< web or branch, from the upright
    std::optional<double> amplitude_mm;      ///< S-curve
    std::optional<double> wavelength_mm;     ///< S-curve
    std::optional<double> corner_radius_mm;  ///< box, upright edges
    std::optional<double> header_radius_mm;  ///< pipe that carries the branch
    std::optional<double> header_length_mm;
    std::optional<double> radius_mm;  ///< branch
    std::optional<double> offset_mm;  ///< of the branch's axis from the header's
    std::optional<double> plate_thickness_mm;
    std::optional<double> margin_mm;  ///< plate around the part
    bool random_pose = true;          ///< any rotation, and an offset
    double max_offset_mm = 300;       ///< of the part's origin from the scan's, along each axis
    Course course = Course::straight;
    std::optional<double> course_radius_mm;    ///< of an arc
    std::optional<double> overlap_mm;          ///< lap: of the two plates
    std::optional<double> gap_mm;              ///< butt; V-groove: at the root
    std::optional<double> mismatch_mm;         ///< butt, V-groove: height of the left plate above the right one
    std::optional<double> root_face_mm;        ///< V-groove
    std::optional<double> included_angle_deg;  ///< V-groove
    bool single_bevel = false;                 ///< V-groove: the left side is square
    std::optional<double> step_mm;             ///< plain: height of the machined steps
    Spattered spattered = Spattered::tee;
    std::optional<double> spatter_per_100mm;  ///< balls
    std::optional<double> tack_spacing_mm;
    std::optional<double> tack_length_mm;
    std::optional<double> tack_leg_mm;  ///< reach of a tack weld on either flank
    int spatter_seed = 0;               ///< of where balls and tack welds are; 0: from the data set's seed
};
Fields describe(SceneOptions&);

/// A point of a true seam: n1 and n2 are the unit normals of the two surfaces, out of the material; the unit tangent is
/// along n1 x n2, which is the direction of travel. The surfaces of a butt joint are the two tops, whose normals are
/// the same: there surface 1 is the one on the right of travel, as it is in every concave joint.
struct TruthPoint {
    Eigen::Vector3d p;
    Eigen::Vector3d tangent;
    Eigen::Vector3d n1;
    Eigen::Vector3d n2;
};

/// Section across a butt joint or a V-groove. Plate 1 is the one with surface 1. The depth is from a plate's top to the
/// lower end of its bevel, the root face from there to its underside; a square plate has neither, and a butt joint's
/// root face is its whole edge. The area is that between the plates, from the line that joins their top edges to the
/// line that joins their lower ones.
struct Groove {
    double gap_mm = 0;       ///< between the root faces
    double mismatch_mm = 0;  ///< height of plate 2 above plate 1
    double root_face_mm = 0;
    double depth_mm = 0;
    double bevel_1_deg = 0;  ///< from the upright
    double bevel_2_deg = 0;
    double included_angle_deg = 0;  ///< sum of both
    double area_mm2 = 0;

    bool operator==(const Groove&) const = default;
};

/// Points in order along the seam, at most 0.1 mm apart. A closed seam does not repeat its first point. Where there is
/// a groove, the points lie on neither surface but in the middle of the two edges.
struct TruthSeam {
    bool closed = false;
    std::vector<TruthPoint> points;
    JointKind kind = JointKind::fillet;
    std::optional<Groove> groove;  ///< of butt joints and V-grooves
};

/// A part may have no joint, and then no seam.
struct Truth {
    std::vector<TruthSeam> seams;
};
Truth transformed(const Truth& truth, const Eigen::Isometry3d& to_from_here);

/// Surfaces and seams in the scene's frame: z is up, the plate's top is z = 0; a header's axis is the x axis.
struct Scene {
    std::vector<Surface> surfaces;
    Eigen::AlignedBox3d box;
    Eigen::Vector3d front{1, 0, 0};  ///< level direction from which an operator would look at the joint first
    Truth truth;
};

/// All dimensions of the kind set; the missing ones from the seed. Throws InputError for a part that can't be built.
SceneOptions resolved(const SceneOptions& options, std::uint64_t seed);

/// `options` as `resolved` returns them.
Scene make_scene(const SceneOptions& options);

}  // namespace seampath
