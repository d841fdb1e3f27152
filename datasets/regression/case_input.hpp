#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include <Eigen/Geometry>

#include "datasets/regression/suite.hpp"

namespace seampath {

/// What a case gives to the program, and what is known of it.
struct MadeInput {
    std::filesystem::path file;                                        ///< scan, capture or observations
    std::optional<Truth> truth;                                        ///< in the scan's frame, mm
    std::optional<SceneOptions> scene;                                 ///< with every dimension, where it was made
    std::filesystem::path nominal;                                     ///< of a fixture
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();  ///< of a fixture, true
};

/// Makes the input of a case into a folder; of a case of files it is their first, where it lies. Throws InputError for
/// a scene that can't be built.
MadeInput make_input(const SuiteCase& entry, std::uint64_t seed, const std::filesystem::path& folder);

}  // namespace seampath
