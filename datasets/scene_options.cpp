#include "datasets/rng.hpp"
#include "datasets/scenes.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

constexpr std::uint64_t kDimensionStream = 1;

/// Usual value of a dimension, and how far the seed moves it either way. With `of_header`, both are shares of the
/// header's radius.
struct Usual {
    std::optional<double> SceneOptions::*dimension;
    double value;
    double spread = 0.2;
    bool of_header = false;
};

std::vector<Usual> usual_dimensions(SceneKind kind) {
    using O = SceneOptions;
    const Usual plate{&O::plate_thickness_mm, 10};
    switch (kind) {
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
    }
    ensure(false, "every scene kind has its dimensions");
    return {};
}

}  // namespace

Fields describe(SceneOptions& o) {
    return {{"kind", choice(o.kind, kSceneNames), "what stands before the scanner"},
            {"vary", &o.vary, "let the seed vary the dimensions that are not set"},
            {"length_mm", &o.length_mm, "length of the web, or of the box along x", above(0)},
            {"width_mm", &o.width_mm, "width of the box along y", above(0)},
            {"height_mm", &o.height_mm, "height of web, box or branch above the other part", above(0)},
            {"thickness_mm", &o.thickness_mm, "thickness of the web", above(0)},
            {"lean_deg", &o.lean_deg, "lean of web or branch from the upright", within(-60, 60)},
            {"amplitude_mm", &o.amplitude_mm, "amplitude of the S-curve", at_least(0)},
            {"wavelength_mm", &o.wavelength_mm, "wavelength of the S-curve", above(0)},
            {"corner_radius_mm", &o.corner_radius_mm, "radius of the box's upright edges", above(0)},
            {"header_radius_mm", &o.header_radius_mm, "radius of the pipe that carries the branch", above(0)},
            {"header_length_mm", &o.header_length_mm, "length of the pipe that carries the branch", above(0)},
            {"radius_mm", &o.radius_mm, "radius of the branch", above(0)},
            {"offset_mm", &o.offset_mm, "offset of the branch's axis from the header's"},
            {"plate_thickness_mm", &o.plate_thickness_mm, "thickness of the plate", above(0)},
            {"margin_mm", &o.margin_mm, "width of plate around the part", above(0)},
            {"random_pose", &o.random_pose, "turn the part any way and move it off the origin"},
            {"max_offset_mm", &o.max_offset_mm, "largest offset of the part from the origin, per axis", at_least(0)}};
}

SceneOptions resolved(const SceneOptions& options, std::uint64_t seed) {
    SceneOptions o = options;
    const Random random(seed, kDimensionStream);
    std::uint64_t draw = 0;
    for (const Usual& usual : usual_dimensions(o.kind)) {
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
    return o;
}

}  // namespace seampath
