#pragma once

#include <algorithm>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "datasets/scenes.hpp"

namespace seampath {

/// A solid is inside all its faces, a part is the union of its solids: below 0 inside the part, above 0 outside.
inline double part_value(const Scene& scene, const Eigen::Vector3d& p) {
    double part = std::numeric_limits<double>::infinity();
    for (const Surface& surface : scene.surfaces) {
        double solid = signed_value(surface.shape, p);
        for (const Shape& other : surface.inside_of) {
            solid = std::max(solid, signed_value(other, p));
        }
        part = std::min(part, solid);
    }
    return part;
}

/// All scenes, for parameterised tests.
inline auto all_scenes() {
    return testing::Range(0, static_cast<int>(kSceneNames.size()));
}

inline std::string scene_test_name(const testing::TestParamInfo<int>& info) {
    std::string name(kSceneNames[static_cast<std::size_t>(info.param)]);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

inline SceneOptions scene_options(int kind, std::uint64_t seed = 1) {
    SceneOptions options;
    options.kind = static_cast<SceneKind>(kind);
    return resolved(options, seed);
}

}  // namespace seampath
