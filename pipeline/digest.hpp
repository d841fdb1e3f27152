#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace seampath {

/// SHA-256 (FIPS 180-4) as 64 hexadecimal digits.
std::string sha256(std::string_view bytes);

/// The same of a file's content. Throws InputError when it can't be read.
std::string sha256_of_file(const std::filesystem::path& file);

/// Names this build of the program: the SHA-256 of the running executable, so that another build never takes over
/// what this one computed.
const std::string& build_id();

}  // namespace seampath
