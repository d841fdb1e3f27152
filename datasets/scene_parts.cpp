#include "datasets/scene_parts.hpp"

#include <algorithm>
#include <cmath>

#include "stages/error.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

constexpr double kTruthSpacing = 0.095;  // mm; the promise is 0.1

}  // namespace

void require(bool holds, const std::string& what) {
    if (!holds) {
        throw InputError("dataset: " + what);
    }
}

void add_solid(Scene& scene, const std::vector<SceneShape>& faces) {
    for (std::size_t i = 0; i < faces.size(); ++i) {
        std::vector<SceneShape> others = faces;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        scene.surfaces.push_back({faces[i], std::move(others)});
    }
}

std::vector<SceneShape> block_faces(const Vector3d& low, const Vector3d& high) {
    std::vector<SceneShape> faces;
    for (int axis = 0; axis < 3; ++axis) {
        faces.emplace_back(PlaneShape{high, Vector3d::Unit(axis)});
        faces.emplace_back(PlaneShape{low, -Vector3d::Unit(axis)});
    }
    return faces;
}

void add_block(Scene& scene, const Vector3d& low, const Vector3d& high) {
    add_solid(scene, block_faces(low, high));
    scene.box.extend(low);
    scene.box.extend(high);
}

void add_bar(Scene& scene, const CylinderShape& cylinder, double length) {
    const Vector3d end = cylinder.p + length * cylinder.axis;
    add_solid(scene, {cylinder, PlaneShape{end, cylinder.axis}, PlaneShape{cylinder.p, -cylinder.axis}});
    const Vector3d reach = cylinder.radius * (Vector3d::Ones() - cylinder.axis.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
    for (const Vector3d& centre : {cylinder.p, end}) {
        scene.box.extend(centre - reach);
        scene.box.extend(centre + reach);
    }
}

void add_plate(Scene& scene, double half_x, double half_y, const SceneOptions& o) {
    add_block(scene, {-half_x, -half_y, -*o.plate_thickness_mm}, {half_x, half_y, 0});
}

TruthSeam& add_seam(Scene& scene, JointKind kind, bool closed, double begin, double end, const SeamCurve& curve) {
    const int kProbe = 2048;
    double longest = 0;
    for (int i = 0; i < kProbe; ++i) {
        const auto at = [&](int k) { return curve(begin + (end - begin) * k / kProbe).p; };
        longest = std::max(longest, (at(i + 1) - at(i)).norm());
    }
    const int steps = static_cast<int>(std::ceil(longest * kProbe / kTruthSpacing));
    TruthSeam seam{closed, {}, kind, {}};
    for (int i = 0; i < steps + (closed ? 0 : 1); ++i) {
        const CurvePoint c = curve(begin + (end - begin) * i / steps);
        seam.points.push_back({c.p, c.along.normalized(), c.n1, c.n2});
    }
    if ((seam.points[1].p - seam.points[0].p).dot(seam.points[0].tangent) < 0) {
        std::reverse(seam.points.begin(), seam.points.end());
    }
    scene.truth.seams.push_back(std::move(seam));
    return scene.truth.seams.back();
}

}  // namespace seampath
