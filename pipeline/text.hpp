#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Small text helpers shared by messages, tables and files.
namespace seampath {

/// The candidate that a mistyped word most likely meant: a few edits away, or the same word without its unit.
/// Empty when nothing is near.
std::string_view near_miss(std::string_view word, std::span<const std::string_view> candidates);

/// `; did you mean "candidate"?`, or empty when nothing is near.
std::string hint(std::string_view word, std::span<const std::string_view> candidates);

/// "a, b, c"
std::string join(std::span<const std::string_view> words);

/// Rows of cells as lines with aligned columns; every row has as many cells as the first.
std::string aligned(std::span<const std::vector<std::string>> rows);

}  // namespace seampath
