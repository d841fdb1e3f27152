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

namespace seampath {

enum class SceneKind {
    tee,
    s_curve,
    box_on_plate,
    pipe_on_plate,
    pipe_on_pipe,
    pipe_on_pipe_oblique,
    pipe_on_pipe_equal
};
inline constexpr std::array<std::string_view, 7> kSceneNames{
    "tee", "s-curve", "box-on-plate", "pipe-on-plate", "pipe-on-pipe", "pipe-on-pipe-oblique", "pipe-on-pipe-equal"};
inline std::string_view name(SceneKind kind) {
    return kSceneNames[static_cast<std::size_t>(kind)];
}

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
};
Fields describe(SceneOptions&);

/// A point of a true seam: n1 and n2 are the unit normals of the two surfaces, out of the material; the unit tangent is
/// along n1 x n2, which is the direction of travel.
struct TruthPoint {
    Eigen::Vector3d p;
    Eigen::Vector3d tangent;
    Eigen::Vector3d n1;
    Eigen::Vector3d n2;
};

/// Points in order along the seam, at most 0.1 mm apart. A closed seam does not repeat its first point.
struct TruthSeam {
    bool closed = false;
    std::vector<TruthPoint> points;
};

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
