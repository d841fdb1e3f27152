#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace seampath {

/// Rows of numbers from a text file.
struct Table {
    std::vector<std::string> header;        ///< one name a column, or empty when the file has no header
    std::vector<std::vector<double>> rows;  ///< at least one; all finite and of the same length
    std::vector<std::size_t> lines;         ///< line in the file of each row, from 1
};

/// Reads a table of at most 16 MiB: one row a line, columns separated by commas, semicolons, tabs or blanks (whichever
/// the first row uses, in this order), decimal points. Empty lines and lines that begin with # are left out. The first
/// row is a header when none of its cells is a number. Throws InputError, with file and line, on cells that are no
/// finite numbers, rows that differ in length, a header without rows, and files that can't be read.
Table read_table(const std::filesystem::path& file);

}  // namespace seampath
