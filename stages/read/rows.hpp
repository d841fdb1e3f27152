#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "stages/read/cloud.hpp"
#include "stages/read/source.hpp"

/// Rows of numbers as text, one record a line. Blank lines and lines that begin with # or // are passed over.
namespace seampath {

/// A run of whole lines.
struct RowBlock {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t rows = 0;
};

struct Rows {
    std::vector<RowBlock> blocks;
    std::size_t count = 0;
};

/// Counts the rows from `offset` to the end of the file.
Rows find_rows(const Source& source, std::size_t offset);

/// One thing on a row: a number that goes to slot 0..2 (position) or 3..5 (normal), or is passed over (-1); or a list,
/// which is its length and so many numbers.
struct RowItem {
    int slot = -1;
    bool list = false;
};

struct RowLayout {
    std::vector<RowItem> items;
    char separator = ' ';  ///< ' ' stands for any run of blanks
    bool has_normals() const;
};

/// Position and normal of a row.
using RowNumbers = std::array<double, 6>;

/// Up to about a thousand rows, spread over rows first .. first + count - 1; rows that cannot be read are left out.
std::vector<RowNumbers> sample_rows(const Source& source, const Rows& rows, std::size_t first, std::size_t count,
                                    const RowLayout& layout);

/// Takes rows first .. first + count - 1 into the cloud. Throws InputError naming the first line that does not hold
/// exactly the items of the layout.
void decode_rows(Cloud& cloud, const Source& source, const Rows& rows, std::size_t first, std::size_t count,
                 const RowLayout& layout, bool record_numbers);

/// Takes the next field of a row, which has no blanks at its ends.
std::string_view next_field(std::string_view& line, char separator);

/// The first row from `offset` on, trimmed; `offset` moves behind it. Empty when there is none.
std::string_view next_row(std::string_view bytes, std::size_t& offset);

}  // namespace seampath
