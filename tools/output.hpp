#pragma once

#include <filesystem>
#include <string_view>

namespace seampath {

/// Writes a file that a subcommand's --out names, whole or not at all; its folder is created. Throws InputError when it
/// can't be written.
void write_output(const std::filesystem::path& file, std::string_view content);

}  // namespace seampath
