#include <array>
#include <cmath>

#include "datasets/course.hpp"
#include "datasets/portable_math.hpp"
#include "datasets/scene_parts.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using portable::radians;

constexpr double kBeyond = 1;  // mm by which the range of a plate passes the flank that bounds it

/// Of a plate, across the course and in height.
struct Range {
    double low_y, high_y, low_z, high_z;
};

/// A plate between the course's ends, within the range and inside the flanks.
void add_plate_along(Scene& scene, const CourseLine& course, const Range& range, std::vector<SceneShape> flanks) {
    const Vector3d low(-course.half_length(), range.low_y, range.low_z);
    const Vector3d high(course.half_length(), range.high_y, range.high_z);
    for (const SceneShape& face : block_faces(low, high)) {
        flanks.push_back(face);
    }
    add_solid(scene, flanks);
    scene.box.extend(low);
    scene.box.extend(high);
}

/// Section of one plate of a groove: heights of its top, of its underside and of the lower end of its bevel, which is
/// the top's where there is no bevel.
struct GrooveSide {
    double top = 0;
    double underside = 0;
    double lower_end = 0;
    double bevel = 0;  ///< rad, from the upright

    /// By which the bevel widens the groove.
    double widening() const {
        const auto [s, c] = portable::sincos(bevel);
        return (top - lower_end) * s / c;
    }
};

/// Area of the polygon of both plates' corners, by the shoelace formula.
double groove_area(double gap, const GrooveSide& right, const GrooveSide& left) {
    const std::array<Eigen::Vector2d, 6> corners{{{-gap / 2, right.underside},
                                                  {gap / 2, left.underside},
                                                  {gap / 2, left.lower_end},
                                                  {gap / 2 + left.widening(), left.top},
                                                  {-gap / 2 - right.widening(), right.top},
                                                  {-gap / 2, right.lower_end}}};
    double twice = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector2d& a = corners[i];
        const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
        twice += a.x() * b.y() - b.x() * a.y();
    }
    return twice / 2;
}

/// The right plate and its bevel are number 1: there the seam has its first surface.
void add_groove_plates(Scene& scene, const CourseLine& course, const SceneOptions& o, const GrooveSide& right,
                       const GrooveSide& left) {
    const double outer = course.reach() + *o.margin_mm;
    require(std::abs(*o.mismatch_mm) < *o.plate_thickness_mm,
            "a mismatch of " + shortest(*o.mismatch_mm) + " mm sets one plate above the other; make it smaller than " +
                "the plates' " + shortest(*o.plate_thickness_mm) + " mm");
    for (const auto& [side, plate] : {std::pair(1.0, right), std::pair(-1.0, left)}) {
        const double across = -side * *o.gap_mm / 2;
        require(course.reach() + plate.widening() + *o.gap_mm / 2 < outer,
                "the groove is wider than its plates; make margin_mm larger than " + shortest(*o.margin_mm));
        std::vector<SceneShape> flanks{course.wall(across, side)};
        if (plate.bevel > 0) {
            flanks.push_back(course.flank(across, plate.lower_end, plate.bevel, side));
        }
        const double inner = course.reach() + kBeyond;
        add_plate_along(scene, course,
                        {side > 0 ? -outer : -inner, side > 0 ? inner : outer, plate.underside, plate.top}, flanks);
    }
    scene.front = Vector3d::UnitX();  // only along a groove does one see down to its root
}

Groove groove_of(const SceneOptions& o, const GrooveSide& right, const GrooveSide& left) {
    const auto degrees = [](double angle) { return angle * (180 / portable::kPi); };
    const double depth = right.top - right.lower_end;
    return {*o.gap_mm,
            *o.mismatch_mm,
            *o.plate_thickness_mm - depth,
            depth,
            degrees(right.bevel),
            degrees(left.bevel),
            degrees(right.bevel + left.bevel),
            groove_area(*o.gap_mm, right, left)};
}

void require_course(const SceneOptions& o) {
    require(o.course != Course::s_curve,
            "scene " + std::string(name(o.kind)) + " has no S-curved course; set scene.course to straight or arc");
}

}  // namespace

/// The lower plate ends below the upper one.
Scene make_lap(const SceneOptions& o) {
    const CourseLine course(o);
    const double lower_end = -course.reach() - *o.overlap_mm;
    Scene scene;
    add_plate_along(scene, course, {lower_end, course.reach() + *o.margin_mm, -*o.plate_thickness_mm, 0}, {});
    add_plate_along(scene, course, {lower_end - *o.margin_mm, course.reach() + kBeyond, 0, *o.thickness_mm},
                    {course.wall(0, 1)});
    scene.front = Vector3d::UnitY();
    add_seam(scene, JointKind::lap, false, -course.half_length(), course.half_length(), [&](double x) {
        const auto at = course.at(x);
        return CurvePoint{at.p, Vector3d::UnitZ(), at.left};
    });
    return scene;
}

Scene make_butt(const SceneOptions& o) {
    require_course(o);
    const CourseLine course(o);
    const double h = *o.mismatch_mm;
    const GrooveSide right{0, -*o.plate_thickness_mm, 0, 0};
    const GrooveSide left{h, h - *o.plate_thickness_mm, h, 0};
    Scene scene;
    add_groove_plates(scene, course, o, right, left);
    TruthSeam& seam =
        add_seam(scene, JointKind::butt, false, -course.half_length(), course.half_length(), [&](double x) {
            const auto at = course.at(x);
            const Vector3d z = Vector3d::UnitZ();
            return CurvePoint{at.p + h / 2 * z, z, z, at.left.cross(z)};
        });
    seam.groove = groove_of(o, right, left);
    return scene;
}

/// With a single bevel, the left plate is square: its side faces the bevel, and has no lower end of its own.
Scene make_v_groove(const SceneOptions& o) {
    require_course(o);
    const CourseLine course(o);
    const double depth = *o.plate_thickness_mm - *o.root_face_mm;
    require(depth > 0, "root face " + shortest(*o.root_face_mm) + " mm leaves no groove in a plate of " +
                           shortest(*o.plate_thickness_mm) + " mm; make it smaller");
    const double bevel = radians(*o.included_angle_deg) / (o.single_bevel ? 1 : 2);
    require(bevel < radians(75), "a bevel of " + shortest(*o.included_angle_deg) +
                                     " deg lies flatter than 75 deg; make included_angle_deg smaller");
    const double h = *o.mismatch_mm;
    const GrooveSide right{0, -*o.plate_thickness_mm, -depth, bevel};
    const GrooveSide left{h, h - *o.plate_thickness_mm, o.single_bevel ? h : h - depth, o.single_bevel ? 0 : bevel};
    Scene scene;
    add_groove_plates(scene, course, o, right, left);
    const double root = o.single_bevel ? right.lower_end : (right.lower_end + left.lower_end) / 2;
    TruthSeam& seam =
        add_seam(scene, JointKind::v_groove, false, -course.half_length(), course.half_length(), [&](double x) {
            const auto at = course.at(x);
            const auto facing = [&](const Vector3d& out, double angle) -> Vector3d {
                const auto [s, c] = portable::sincos(angle);
                return c * out + s * Vector3d::UnitZ();
            };
            return CurvePoint{at.p + root * Vector3d::UnitZ(), facing(at.left, right.bevel),
                              facing(-at.left, left.bevel)};
        });
    seam.groove = groove_of(o, right, left);
    return scene;
}

/// A level plate whose edge is flush with the outer face of a plate that hangs below it.
Scene make_corner(const SceneOptions& o) {
    require_course(o);
    const CourseLine course(o);
    const double lean = radians(*o.lean_deg);
    const auto [s, c] = portable::sincos(lean);
    const double height = *o.height_mm;
    const double spread = std::abs(height * s / c) + *o.thickness_mm / c + kBeyond;
    require(*o.margin_mm > *o.thickness_mm / c, "a level plate of " + shortest(*o.margin_mm) +
                                                    " mm is no wider than the other is thick; make margin_mm larger");
    const SceneShape outer = course.flank(0, 0, lean, 1);
    Scene scene;
    add_plate_along(scene, course, {-course.reach() - *o.margin_mm, course.reach() + spread, -*o.plate_thickness_mm, 0},
                    {outer});
    add_plate_along(scene, course, {-course.reach() - spread, course.reach() + spread, -height, 0},
                    {outer, course.flank(-*o.thickness_mm / c, 0, -lean, -1)});
    scene.front = Vector3d::UnitY();
    add_seam(scene, JointKind::corner, false, -course.half_length(), course.half_length(), [&, s = s, c = c](double x) {
        const auto at = course.at(x);
        return CurvePoint{at.p, Vector3d::UnitZ(), c * at.left + s * Vector3d::UnitZ()};
    });
    return scene;
}

}  // namespace seampath
