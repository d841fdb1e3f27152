#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pipeline/result.hpp"
#include "tools/saddle_points.hpp"

/// What `seampath saddle` says of a saddle.
namespace seampath {

/// What is known of the saddle, its steps, its model and its plan; `dimensions` are its first entry.
nlohmann::ordered_json saddle_facts(const nlohmann::ordered_json& dimensions, const SaddleCurve& curve,
                                    const SaddleSteps& steps, const PartResult& part);

/// The same for people; `files` are rows of a name and a path.
std::string saddle_facts_text(const nlohmann::ordered_json& facts, const PartResult& part,
                              const std::vector<std::vector<std::string>>& files);

}  // namespace seampath
