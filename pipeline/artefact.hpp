#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

/// The file that keeps one stage's result in a run folder: JSON with the stage, the key, the content and its SHA-256.
namespace seampath {

/// Changes with the stage, its options, the keys of what it takes, and the build.
std::string artefact_key(std::string_view stage, std::string_view options, std::span<const std::string> inputs);

std::string artefact_text(std::string_view stage, std::string_view key, std::string_view content);

/// The content, if the text is a whole and undamaged artefact of this stage with this key.
std::optional<std::string_view> artefact_content(std::string_view text, std::string_view stage, std::string_view key);

/// The same with any key: for who reads a run and doesn't go on with it.
std::optional<std::string_view> artefact_content(std::string_view text, std::string_view stage);

}  // namespace seampath
