#include "datasets/scenes.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/portable_math.hpp"
#include "datasets/scene_parts.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {

using Eigen::Vector3d;
using portable::kPi;
using portable::radians;

/// Web flush with the plate's ends, leaning to +y.
Scene make_tee(const SceneOptions& o) {
    const auto [s, c] = portable::sincos(radians(*o.lean_deg));
    const Vector3d up(0, s, c);
    const Vector3d side(0, c, -s);
    const double half_length = *o.length_mm / 2;
    const double half_thickness = *o.thickness_mm / 2;
    const double half_foot = half_thickness / c;
    Scene scene;
    add_plate(scene, half_length, half_foot + *o.margin_mm, o);
    add_solid(scene, {PlaneShape{half_thickness * side, side}, PlaneShape{-half_thickness * side, -side},
                      PlaneShape{*o.height_mm * up, up}, PlaneShape{Vector3d::Zero(), -Vector3d::UnitZ()},
                      PlaneShape{half_length * Vector3d::UnitX(), Vector3d::UnitX()},
                      PlaneShape{-half_length * Vector3d::UnitX(), -Vector3d::UnitX()}});
    scene.front = Vector3d::UnitY();
    for (const double sign : {1.0, -1.0}) {
        scene.box.extend(*o.height_mm * up + sign * half_thickness * side);
        add_seam(scene, JointKind::fillet, false, -half_length, half_length, [&](double x) {
            return CurvePoint{{x, sign * half_foot, 0}, Vector3d::UnitZ(), sign * side};
        });
    }
    return scene;
}

namespace {

Scene make_s_curve(const SceneOptions& o) {
    const double half_length = *o.length_mm / 2;
    const double half_thickness = *o.thickness_mm / 2;
    const double wave_number = 2 * kPi / *o.wavelength_mm;
    const double reach = std::abs(*o.amplitude_mm) + half_thickness;
    Scene scene;
    add_plate(scene, half_length, reach + *o.margin_mm, o);
    const SineWall left{*o.amplitude_mm, wave_number, half_thickness, 1};
    const SineWall right{*o.amplitude_mm, wave_number, -half_thickness, -1};
    add_solid(scene, {left, right, PlaneShape{*o.height_mm * Vector3d::UnitZ(), Vector3d::UnitZ()},
                      PlaneShape{Vector3d::Zero(), -Vector3d::UnitZ()},
                      PlaneShape{half_length * Vector3d::UnitX(), Vector3d::UnitX()},
                      PlaneShape{-half_length * Vector3d::UnitX(), -Vector3d::UnitX()}});
    scene.box.extend(Vector3d(0, 0, *o.height_mm));
    scene.front = Vector3d::UnitY();
    for (const SineWall& wall : {left, right}) {
        add_seam(scene, JointKind::fillet, false, -half_length, half_length, [&](double x) {
            const Vector3d p(x, wall.offset + wall.amplitude * portable::sin(wave_number * x), 0);
            return CurvePoint{p, Vector3d::UnitZ(), normal(wall, p)};
        });
    }
    return scene;
}

/// Outline of a rectangle with rounded corners, by arc length from the middle of its +x side, counter-clockwise.
CurvePoint box_outline(double half_x, double half_y, double radius, double s) {
    const double straight[2] = {2 * (half_y - radius), 2 * (half_x - radius)};
    const double arc = radius * kPi / 2;
    s += straight[0] / 2;
    for (int side = 0;; ++side) {
        const auto [sin, cos] = portable::sincos((side % 4) * (kPi / 2));
        const auto turned = [&, sn = sin, cs = cos](double x, double y) {
            return Vector3d(cs * x - sn * y, sn * x + cs * y, 0);
        };
        const double out = side % 2 == 0 ? half_x : half_y;
        const double length = straight[side % 2];
        if (s <= length) {
            return {turned(out, s - length / 2), Vector3d::UnitZ(), turned(1, 0)};
        }
        s -= length;
        if (s <= arc) {
            const auto [sa, ca] = portable::sincos(s / radius);
            return {turned(out - radius + radius * ca, length / 2 + radius * sa), Vector3d::UnitZ(), turned(ca, sa)};
        }
        s -= arc;
    }
}

/// The rounded box is the union of two blocks and four bars; their faces inside the union are never seen.
Scene make_box_on_plate(const SceneOptions& o) {
    const double half_x = *o.length_mm / 2;
    const double half_y = *o.width_mm / 2;
    const double radius = *o.corner_radius_mm;
    const double height = *o.height_mm;
    require(
        radius > 0 && radius < std::min(half_x, half_y),
        "corner radius " + shortest(radius) + " mm does not fit the box; use one between 0 and half its shorter side");
    Scene scene;
    add_plate(scene, half_x + *o.margin_mm, half_y + *o.margin_mm, o);
    add_block(scene, {-half_x, -half_y + radius, 0}, {half_x, half_y - radius, height});
    add_block(scene, {-half_x + radius, -half_y, 0}, {half_x - radius, half_y, height});
    for (const double x : {half_x - radius, radius - half_x}) {
        for (const double y : {half_y - radius, radius - half_y}) {
            add_bar(scene, {{x, y, 0}, Vector3d::UnitZ(), radius}, height);
        }
    }
    const double around = 4 * (half_x + half_y - 2 * radius) + 2 * kPi * radius;
    add_seam(scene, JointKind::fillet, true, 0, around,
             [&](double s) { return box_outline(half_x, half_y, radius, s); });
    return scene;
}

/// A branch bar leaning to +x in the plane y = offset; its points are
/// (0, offset, 0) + radius (cos(phi) e1 + sin(phi) e2) + s axis.
struct Branch {
    double radius, offset, sin_lean, cos_lean;
    Vector3d axis() const { return {sin_lean, 0, cos_lean}; }
    Vector3d radial(const portable::SinCos& phi) const { return {phi.cos * cos_lean, phi.sin, -phi.cos * sin_lean}; }
    /// Where the ruling at phi reaches the height z.
    Vector3d at_height(const portable::SinCos& phi, double z) const {
        const double s = (z + radius * phi.cos * sin_lean) / cos_lean;
        const Vector3d p = Vector3d(0, offset, 0) + radius * radial(phi) + s * axis();
        return {p.x(), p.y(), z};
    }
};

Branch make_branch(const SceneOptions& o) {
    const auto [s, c] = portable::sincos(radians(*o.lean_deg));
    return {*o.radius_mm, o.offset_mm.value_or(0), s, c};
}

Scene make_pipe_on_plate(const SceneOptions& o) {
    const Branch branch = make_branch(o);
    const double tan_lean = branch.sin_lean / branch.cos_lean;
    Scene scene;
    add_plate(scene, branch.radius / branch.cos_lean + *o.margin_mm, branch.radius + *o.margin_mm, o);
    // The bar's flat lower end must stay within the plate, so the plate's top cuts it.
    const double length = *o.height_mm + branch.radius * std::abs(tan_lean);
    const CylinderShape cylinder{Vector3d::Zero(), branch.axis(), branch.radius};
    add_solid(scene, {cylinder, PlaneShape{length * branch.axis(), branch.axis()},
                      PlaneShape{Vector3d::Zero(), -Vector3d::UnitZ()}});
    const Vector3d end = length * branch.axis();
    scene.box.extend(
        end + Vector3d(branch.radius * branch.cos_lean, branch.radius, branch.radius * std::abs(branch.sin_lean)));
    scene.box.extend(end - Vector3d(branch.radius * branch.cos_lean, branch.radius, 0));
    add_seam(scene, JointKind::saddle, true, 0, 2 * kPi, [&](double angle) {
        const auto phi = portable::sincos(angle);
        return CurvePoint{branch.at_height(phi, 0), Vector3d::UnitZ(), branch.radial(phi)};
    });
    return scene;
}

Scene make_pipe_on_pipe(const SceneOptions& o) {
    const Branch branch = make_branch(o);
    const double header = *o.header_radius_mm;
    require(branch.radius + std::abs(branch.offset) < header,
            "branch radius " + shortest(branch.radius) + " mm and offset " + shortest(branch.offset) +
                " mm together reach beyond the header's radius " + shortest(header) + " mm; make them smaller than it");
    const auto seam = [&](double angle) {
        const auto phi = portable::sincos(angle);
        const double y = branch.offset + branch.radius * phi.sin;
        const double z = std::sqrt(header * header - y * y);
        return CurvePoint{branch.at_height(phi, z), Vector3d(0, y, z) / header, branch.radial(phi)};
    };
    Scene scene;
    double highest = 0;  // of the seam, along the branch
    Eigen::AlignedBox3d around;
    for (int i = 0; i < 720; ++i) {
        const Vector3d p = seam(i * (kPi / 360)).p;
        highest = std::max(highest, p.dot(branch.axis()));
        around.extend(p);
    }
    const double half_length = *o.header_length_mm / 2;
    const double middle = (around.min().x() + around.max().x()) / 2;
    require(half_length > around.sizes().x() / 2,
            "header length " + shortest(2 * half_length) + " mm is shorter than the branch is wide; make it longer");
    add_bar(scene, {{middle - half_length, 0, 0}, Vector3d::UnitX(), header}, 2 * half_length);
    add_bar(scene, {{0, branch.offset, 0}, branch.axis(), branch.radius}, highest + *o.height_mm);
    add_seam(scene, JointKind::saddle, true, 0, 2 * kPi, seam);
    return scene;
}

bool follows_course(const SceneOptions& o) {
    return (o.kind >= SceneKind::lap && o.kind <= SceneKind::corner) ||
           (o.kind == SceneKind::spatter && o.spattered == Spattered::lap);
}

}  // namespace

Scene make_scene(const SceneOptions& options) {
    require(options.course == Course::straight || follows_course(options),
            "scene " + std::string(name(options.kind)) + " has a course of its own; leave scene.course at straight");
    switch (options.kind) {
        case SceneKind::tee:
            return make_tee(options);
        case SceneKind::s_curve:
            return make_s_curve(options);
        case SceneKind::box_on_plate:
            return make_box_on_plate(options);
        case SceneKind::pipe_on_plate:
            return make_pipe_on_plate(options);
        case SceneKind::pipe_on_pipe:
        case SceneKind::pipe_on_pipe_oblique:
        case SceneKind::pipe_on_pipe_equal:
            return make_pipe_on_pipe(options);
        case SceneKind::lap:
            return make_lap(options);
        case SceneKind::butt:
            return make_butt(options);
        case SceneKind::v_groove:
            return make_v_groove(options);
        case SceneKind::corner:
            return make_corner(options);
        case SceneKind::multi:
            return make_multi(options);
        case SceneKind::plain:
            return make_plain(options);
        case SceneKind::spatter:
            return make_spatter(options);
    }
    ensure(false, "every scene kind can be made");
    return {};
}

Truth transformed(const Truth& truth, const Eigen::Isometry3d& to_from_here) {
    Truth moved = truth;
    const Eigen::Matrix3d turn = to_from_here.linear();
    for (TruthSeam& seam : moved.seams) {
        for (TruthPoint& point : seam.points) {
            point = {to_from_here * point.p, turn * point.tangent, turn * point.n1, turn * point.n2};
        }
    }
    return moved;
}

}  // namespace seampath
