#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "datasets/scenes.hpp"

/// What scenes are put together from; for the makers of scenes only.
namespace seampath {

/// Throws InputError that says `what` unless it holds.
void require(bool holds, const std::string& what);

/// A solid is what lies inside all its faces. The caller extends the scene's box.
void add_solid(Scene& scene, const std::vector<SceneShape>& faces);

/// The six faces of a block.
std::vector<SceneShape> block_faces(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

void add_block(Scene& scene, const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// A round bar from s = 0 to s = length along the axis.
void add_bar(Scene& scene, const CylinderShape& cylinder, double length);

/// Top at z = 0, around the origin.
void add_plate(Scene& scene, double half_x, double half_y, const SceneOptions& o);

/// Position and normals of a seam at a parameter. `along` gives the direction of travel.
struct CurvePoint {
    Eigen::Vector3d p, n1, n2;
    Eigen::Vector3d along = n1.cross(n2);
};
using SeamCurve = std::function<CurvePoint(double)>;

/// Points at equal steps of the parameter, so many that none are further apart than promised, in the direction of
/// travel.
TruthSeam& add_seam(Scene& scene, JointKind kind, bool closed, double begin, double end, const SeamCurve& curve);

/// Balls and tack welds on and beside the seams that the scene has.
void add_spatter(Scene& scene, const SceneOptions& o);

Scene make_tee(const SceneOptions& o);
Scene make_lap(const SceneOptions& o);
Scene make_butt(const SceneOptions& o);
Scene make_v_groove(const SceneOptions& o);
Scene make_corner(const SceneOptions& o);
Scene make_multi(const SceneOptions& o);
Scene make_plain(const SceneOptions& o);
Scene make_spatter(const SceneOptions& o);

}  // namespace seampath
