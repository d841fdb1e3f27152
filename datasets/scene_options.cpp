#include "datasets/rng.hpp"
#include "datasets/scenes.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

constexpr std::uint64_t kDimensionStream = 1;
constexpr std::uint64_t kSpatterStream = 3;

/// Usual value of a dimension, and how far the seed moves it either way. With `of_header`, both are shares of the
/// header's radius.
struct Usual {
    std::optional<double> SceneOptions::*dimension;
    double value;
    double spread = 0.2;
    bool of_header = false;
};

std::vector<Usual> joined(std::vector<Usual> first, const std::vector<Usual>& rest) {
    first.insert(first.end(), rest.begin(), rest.end());
    return first;
}

/// Of plates that meet along a course. A spread of 1 reaches from 0 to twice the value.
std::vector<Usual> usual_plate_joint(const SceneOptions& o) {
    using O = SceneOptions;
    const std::vector<Usual> course{{&O::plate_thickness_mm, 10}, {&O::length_mm, 160},     {&O::course_radius_mm, 220},
                                    {&O::amplitude_mm, 18},       {&O::wavelength_mm, 150}, {&O::margin_mm, 45}};
    switch (o.kind) {
        case SceneKind::butt:
            return joined(course, {{&O::gap_mm, 1.15, 0.74}, {&O::mismatch_mm, 0.75, 1}});
        case SceneKind::v_groove:
            return joined(course, {{&O::gap_mm, 1.5, 1},
                                   {&O::mismatch_mm, 0.75, 1},
                                   {&O::root_face_mm, 1.5, 1},
                                   {&O::included_angle_deg, o.single_bevel ? 45.0 : 70.0, 2.0 / 7}});
        case SceneKind::corner:
            return joined(course, {{&O::thickness_mm, 8}, {&O::height_mm, 45}, {&O::lean_deg, 8, 2}});
        default:  // lap
            return joined(course, {{&O::thickness_mm, 5.75, 0.74}, {&O::overlap_mm, 25}});
    }
}

std::vector<Usual> usual_dimensions(const SceneOptions& o) {
    using O = SceneOptions;
    const Usual plate{&O::plate_thickness_mm, 10};
    switch (o.kind) {
        case SceneKind::tee:
            return {plate,
                    {&O::margin_mm, 45},
                    {&O::length_mm, 200},
                    {&O::height_mm, 60},
                    {&O::thickness_mm, 8},
                    {&O::lean_deg, 15, 0.65}};
        case SceneKind::s_curve:
            return {plate,
                    {&O::margin_mm, 40},
                    {&O::length_mm, 210},
                    {&O::height_mm, 50},
                    {&O::thickness_mm, 8},
                    {&O::amplitude_mm, 18},
                    {&O::wavelength_mm, 180}};
        case SceneKind::box_on_plate:
            return {plate,
                    {&O::margin_mm, 40},
                    {&O::length_mm, 110},
                    {&O::width_mm, 80},
                    {&O::height_mm, 50},
                    {&O::corner_radius_mm, 10}};
        case SceneKind::pipe_on_plate:
            return {plate, {&O::margin_mm, 40}, {&O::radius_mm, 40}, {&O::height_mm, 65}, {&O::lean_deg, 22}};
        case SceneKind::pipe_on_pipe:
            return {{&O::header_radius_mm, 55},
                    {&O::radius_mm, 0.62, 0.2, true},
                    {&O::height_mm, 60},
                    {&O::lean_deg, 0},
                    {&O::offset_mm, 0}};
        case SceneKind::pipe_on_pipe_oblique:
            return {{&O::header_radius_mm, 58},
                    {&O::radius_mm, 0.54, 0.2, true},
                    {&O::height_mm, 55},
                    {&O::lean_deg, 24},
                    {&O::offset_mm, 0.18, 0.2, true}};
        case SceneKind::pipe_on_pipe_equal:
            return {{&O::header_radius_mm, 50},
                    {&O::radius_mm, 0.925, 0.025, true},
                    {&O::height_mm, 60},
                    {&O::lean_deg, 0},
                    {&O::offset_mm, 0}};
        case SceneKind::lap:
        case SceneKind::butt:
        case SceneKind::v_groove:
        case SceneKind::corner:
            return usual_plate_joint(o);
        case SceneKind::multi:
            return {plate,
                    {&O::margin_mm, 42},
                    {&O::length_mm, 130},
                    {&O::height_mm, 35},
                    {&O::thickness_mm, 6},
                    {&O::radius_mm, 22}};
        case SceneKind::plain:
            return {plate, {&O::length_mm, 180}, {&O::width_mm, 120}, {&O::radius_mm, 7}, {&O::step_mm, 0.7, 0.5}};
        case SceneKind::spatter: {
            SceneOptions clean = o;
            clean.kind = o.spattered == Spattered::tee ? SceneKind::tee : SceneKind::lap;
            return joined(usual_dimensions(clean), {{&O::spatter_per_100mm, 5, 1},
                                                    {&O::tack_spacing_mm, 60},
                                                    {&O::tack_length_mm, 10},
                                                    {&O::tack_leg_mm, 3}});
        }
    }
    ensure(false, "every scene kind has its dimensions");
    return {};
}

}  // namespace

Fields describe(SceneOptions& o) {
    return {
        {"kind", choice(o.kind, kSceneNames), "what stands before the scanner"},
        {"vary", &o.vary, "let the seed vary the dimensions that are not set"},
        {"length_mm", &o.length_mm, "length of web or joint; of box and plain plate along x", above(0)},
        {"width_mm", &o.width_mm, "width of box and plain plate along y", above(0)},
        {"height_mm", &o.height_mm, "height of web, box, branch or stiffener; of a corner's hanging plate", above(0)},
        {"thickness_mm", &o.thickness_mm, "thickness of web, lapped plate, stiffener or a corner's hanging plate",
         above(0)},
        {"lean_deg", &o.lean_deg, "lean of web, branch or hanging plate from the upright", within(-60, 60)},
        {"amplitude_mm", &o.amplitude_mm, "amplitude of the S-curve", at_least(0)},
        {"wavelength_mm", &o.wavelength_mm, "wavelength of the S-curve", above(0)},
        {"corner_radius_mm", &o.corner_radius_mm, "radius of the box's upright edges", above(0)},
        {"header_radius_mm", &o.header_radius_mm, "radius of the pipe that carries the branch", above(0)},
        {"header_length_mm", &o.header_length_mm, "length of the pipe that carries the branch", above(0)},
        {"radius_mm", &o.radius_mm, "radius of the branch, of the pipe on a plate, or of holes", above(0)},
        {"offset_mm", &o.offset_mm, "offset of the branch's axis from the header's"},
        {"plate_thickness_mm", &o.plate_thickness_mm, "thickness of the plate, or of both plates of a butt or groove",
         above(0)},
        {"margin_mm", &o.margin_mm, "width of plate around the part, or beside the joint", above(0)},
        {"random_pose", &o.random_pose, "turn the part any way and move it off the origin"},
        {"max_offset_mm", &o.max_offset_mm, "largest offset of the part from the origin, per axis", at_least(0)},
        {"course", choice(o.course, kCourseNames), "line of a lap, butt, V-groove or corner; s-curve: lap only"},
        {"course_radius_mm", &o.course_radius_mm, "radius of an arc course", above(0)},
        {"overlap_mm", &o.overlap_mm, "overlap of the two plates of a lap", above(0)},
        {"gap_mm", &o.gap_mm, "gap of a butt joint, or of a groove's root", at_least(0)},
        {"mismatch_mm", &o.mismatch_mm, "height of a butt's or groove's left plate above the right"},
        {"root_face_mm", &o.root_face_mm, "upright part of a groove's edge, below the bevel", at_least(0)},
        {"included_angle_deg", &o.included_angle_deg, "between the two sides of a groove", within(10, 140)},
        {"single_bevel", &o.single_bevel, "leave the left side of the groove square"},
        {"step_mm", &o.step_mm, "height of the steps of the plain plate", above(0)},
        {"spattered", choice(o.spattered, kSpatteredNames), "joint of the scene spatter"},
        {"spatter_per_100mm", &o.spatter_per_100mm, "spatter balls on 100 mm of seam", within(0, 1000)},
        {"tack_spacing_mm", &o.tack_spacing_mm, "distance of tack welds along the seam", at_least(1)},
        {"tack_length_mm", &o.tack_length_mm, "length of a tack weld between its round ends", at_least(0)},
        {"tack_leg_mm", &o.tack_leg_mm, "reach of a tack weld on either flank", above(0)},
        {"spatter_seed", &o.spatter_seed, "where balls and tack welds are; 0: from --seed", at_least(0)}};
}

SceneOptions resolved(const SceneOptions& options, std::uint64_t seed) {
    SceneOptions o = options;
    const Random random(seed, kDimensionStream);
    std::uint64_t draw = 0;
    for (const Usual& usual : usual_dimensions(o)) {
        const double shift = o.vary ? random.uniform(draw, -1, 1) : 0;
        ++draw;  // also for a dimension that is set, so that setting one does not change the others
        std::optional<double>& dimension = o.*usual.dimension;
        if (!dimension) {
            dimension = usual.value * (1 + usual.spread * shift) * (usual.of_header ? *o.header_radius_mm : 1);
        }
    }
    if (o.header_radius_mm && !o.header_length_mm) {
        o.header_length_mm = (o.vary ? random.uniform(draw, 2.5, 3) : 2.75) * 2 * *o.radius_mm;
    }
    if (o.kind == SceneKind::spatter && o.spatter_seed == 0) {
        o.spatter_seed = 1 + static_cast<int>(Random(seed, kSpatterStream).bits(0) >> 34);
    }
    return o;
}

}  // namespace seampath
