#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pipeline/artefact.hpp"
#include "pipeline/codec.hpp"
#include "pipeline/config.hpp"

namespace seampath {

/// Leaves in a folder what commands read of a run's models, without running anything.
inline void write_run(const std::filesystem::path& folder, const std::vector<SeamModel>& models,
                      const Config& config = {}) {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "4-models.json", std::ios::binary)
        << artefact_text("fit", std::string(64, '0'), encode(models));
    std::ofstream(folder / "config.resolved.json", std::ios::binary) << config_json(config);
}

}  // namespace seampath
