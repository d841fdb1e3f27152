#include <algorithm>

#include "datasets/portable_math.hpp"
#include "datasets/scene_parts.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {

using Eigen::Vector3d;

/// From left to right on one base plate, `margin_mm` apart: a plate lapped on it, a stiffener across it, a pipe, and at
/// its right border a plate that hangs down, flush with it.
Scene make_multi(const SceneOptions& o) {
    const double t = *o.thickness_mm;
    const double margin = *o.margin_mm;
    const double radius = *o.radius_mm;
    const double half_y = *o.length_mm / 2;
    require(radius < half_y, "a pipe of radius " + shortest(radius) + " mm is wider than the plate; make length_mm " +
                                 "larger than " + shortest(*o.length_mm));
    const double half_x = (4 * margin + t + 2 * radius) / 2;
    const double lap = margin - half_x;
    const double stiffener = lap + margin;
    const Vector3d pipe(stiffener + t + margin + radius, 0, 0);
    const Vector3d x = Vector3d::UnitX();
    const Vector3d z = Vector3d::UnitZ();
    Scene scene;
    add_plate(scene, half_x, half_y, o);
    add_block(scene, {-half_x, -half_y, 0}, {lap, half_y, t});
    add_block(scene, {stiffener, -half_y, 0}, {stiffener + t, half_y, *o.height_mm});
    add_bar(scene, {pipe, z, radius}, *o.height_mm);
    add_block(scene, {half_x - t, -half_y, -*o.height_mm}, {half_x, half_y, 0});
    const auto straight = [&](JointKind kind, double at, const Vector3d& n2) {
        add_seam(scene, kind, false, -half_y, half_y, [&](double y) { return CurvePoint{{at, y, 0}, z, n2}; });
    };
    straight(JointKind::lap, lap, x);
    straight(JointKind::fillet, stiffener, -x);
    straight(JointKind::fillet, stiffener + t, x);
    add_seam(scene, JointKind::saddle, true, 0, 2 * portable::kPi, [&](double angle) {
        const auto [s, c] = portable::sincos(angle);
        const Vector3d out(c, s, 0);
        return CurvePoint{pipe + radius * out, z, out};
    });
    straight(JointKind::corner, half_x, x);
    return scene;
}

/// A plate that was only machined: a third of it stands higher by a step, a round boss by the same; holes go through
/// low, high and boss. Steps are lower than the thinnest plate that anyone laps.
Scene make_plain(const SceneOptions& o) {
    const double half_x = *o.length_mm / 2;
    const double half_y = *o.width_mm / 2;
    const double radius = *o.radius_mm;
    const double edge = -half_x / 3;
    const auto hole = [&](double at_x, double at_y) {
        return CylinderShape{{at_x, at_y, 0}, Vector3d::UnitZ(), radius, -1};
    };
    const std::vector<SceneShape> high_holes{hole(-2 * half_x / 3, half_y / 2), hole(-2 * half_x / 3, -half_y / 2)};
    const SceneShape low_hole = hole(half_x / 12, -half_y / 2);
    const CylinderShape boss{{half_x / 2, half_y / 6, 0}, Vector3d::UnitZ(), 2.5 * radius};
    const SceneShape boss_hole = CylinderShape{boss.p, boss.axis, radius, -1};
    require(boss.radius < std::min(half_x / 3, half_y / 2),
            "holes of radius " + shortest(radius) + " mm do not fit the plate; make radius_mm smaller");
    const auto drilled = [](std::vector<SceneShape> faces, const std::vector<SceneShape>& holes) {
        faces.insert(faces.end(), holes.begin(), holes.end());
        return faces;
    };
    const double under = -*o.plate_thickness_mm;
    const double step = *o.step_mm;
    Scene scene;
    scene.box.extend(Vector3d(-half_x, -half_y, under));
    scene.box.extend(Vector3d(half_x, half_y, step));
    add_solid(scene, drilled(drilled(block_faces({-half_x, -half_y, under}, {half_x, half_y, 0}), high_holes),
                             {low_hole, boss_hole}));
    add_solid(scene, drilled(block_faces({-half_x, -half_y, under}, {edge, half_y, step}), high_holes));
    add_solid(scene, {boss, PlaneShape{{0, 0, step}, Vector3d::UnitZ()},
                      PlaneShape{Vector3d::Zero(), -Vector3d::UnitZ()}, boss_hole});
    return scene;
}

Scene make_spatter(const SceneOptions& o) {
    Scene scene = o.spattered == Spattered::tee ? make_tee(o) : make_lap(o);
    add_spatter(scene, o);
    return scene;
}

}  // namespace seampath
