#pragma once

#include <algorithm>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "datasets/scenes.hpp"

namespace seampath {

/// A solid is inside all its faces, a part is the union of its solids: below 0 inside the part, above 0 outside.
inline double part_value(const Scene& scene, const Eigen::Vector3d& p) {
    double part = std::numeric_limits<double>::infinity();
    for (const Surface& surface : scene.surfaces) {
        double solid = signed_value(surface.shape, p);
        for (const SceneShape& other : surface.inside_of) {
            solid = std::max(solid, signed_value(other, p));
        }
        part = std::min(part, solid);
    }
    return part;
}

/// All scenes, each with every course and form that it has.
inline std::vector<SceneOptions> scene_variants() {
    std::vector<SceneOptions> variants;
    for (int kind = 0; kind < static_cast<int>(kSceneNames.size()); ++kind) {
        SceneOptions& o = variants.emplace_back();
        o.kind = static_cast<SceneKind>(kind);
    }
    const auto add = [&](SceneKind kind, Course course, bool single_bevel = false) {
        SceneOptions& o = variants.emplace_back();
        o.kind = kind;
        o.course = course;
        o.single_bevel = single_bevel;
    };
    add(SceneKind::lap, Course::arc);
    add(SceneKind::lap, Course::s_curve);
    add(SceneKind::butt, Course::arc);
    add(SceneKind::v_groove, Course::arc);
    add(SceneKind::v_groove, Course::straight, true);
    add(SceneKind::v_groove, Course::arc, true);
    add(SceneKind::corner, Course::arc);
    add(SceneKind::spatter, Course::s_curve);
    variants.back().spattered = Spattered::lap;
    return variants;
}

inline std::string variant_name(const SceneOptions& o) {
    std::string text(name(o.kind));
    if (o.course != Course::straight) {
        text += "_" + std::string(kCourseNames[static_cast<std::size_t>(o.course)]);
    }
    if (o.single_bevel) {
        text += "_single";
    }
    std::replace(text.begin(), text.end(), '-', '_');
    return text;
}

/// For parameterised tests.
inline auto all_scenes() {
    return testing::ValuesIn(scene_variants());
}

inline std::string scene_test_name(const testing::TestParamInfo<SceneOptions>& info) {
    return variant_name(info.param);
}

inline void PrintTo(const SceneOptions& o, std::ostream* out) {
    *out << variant_name(o);
}

/// A seam point's foot on each flank, and where that flank goes from there; in the scene's frame.
struct Feet {
    Eigen::Vector3d p1, p2;
    Eigen::Vector3d along1, along2;
};

/// In a groove, the feet are the edges on either side of its middle. Flank 1 goes to the right of travel, and flank 2
/// to the left, but at an outer corner the other way.
inline Feet feet(const TruthSeam& seam, const TruthPoint& at) {
    const double sign = seam.kind == JointKind::corner ? -1 : 1;
    Feet f{at.p, at.p, sign * at.tangent.cross(at.n1), sign * at.n2.cross(at.tangent)};
    if (seam.groove) {
        const bool square = seam.kind == JointKind::v_groove && seam.groove->bevel_2_deg == 0;
        const Eigen::Vector3d right = at.tangent.cross(Eigen::Vector3d::UnitZ());
        const Eigen::Vector3d up = (square ? 0 : seam.groove->mismatch_mm) * Eigen::Vector3d::UnitZ();
        f.p1 += (seam.groove->gap_mm * right - up) / 2;
        f.p2 -= (seam.groove->gap_mm * right - up) / 2;
        if (square) {  // it may stand so high that it ends above the other's bevel
            f.p2.z() += std::max(0.0, seam.groove->mismatch_mm - seam.groove->root_face_mm);
        }
    }
    return f;
}

inline SceneOptions scene_options(int kind, std::uint64_t seed = 1) {
    SceneOptions options;
    options.kind = static_cast<SceneKind>(kind);
    return resolved(options, seed);
}

}  // namespace seampath
