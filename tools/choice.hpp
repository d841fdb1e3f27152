#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace seampath {

/// Index of the word that an option was given among those it may have. Throws InputError, with the nearest one, when it
/// is none of them.
std::size_t choice(const std::string& option, const std::string& word, std::span<const std::string_view> names);

}  // namespace seampath
