#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "stages/geometry/grey_image.hpp"

namespace seampath::detail {

/// What a picture may show along a line: a line darker or brighter than both of its sides, or a border between them.
enum class LineKind { dark, bright, border };
inline constexpr int kLineKinds = 3;

/// Slopes at which lines are looked for: i / kSlopes, i from -kSlopes to kSlopes.
inline constexpr int kSlopes = 12;
inline constexpr int kSlopeCount = 2 * kSlopes + 1;

/// Grey values that tell nothing in the dark: noise and compression. Lines are looked for in the logarithm of the grey
/// value plus these, so that light and shade change their height as little as they change what they are.
inline constexpr float kBlack = 8;

/// A line at one place.
struct LineSign {
    float strength = 0;  ///< how far it stands out, in sigmas of what the texture around it gives
    float width = 0;     ///< rows of the reduced picture
};

/// Widths of lines, rows: steps of about sqrt(2), where rows allow it.
inline constexpr std::array<int, 9> kLineWidths{1, 2, 3, 4, 6, 8, 12, 16, 24};

/// How much every place of a picture looks like a line that runs from left to right, at 45 degrees at most. The picture
/// is reduced by a whole number, and its columns are taken together in blocks that overlap by half: along a seam they
/// agree, along texture they do not. `widths`: of the lines, rows of the reduced picture.
class LineEvidence {
public:
    LineEvidence(const GreyImage& image, int reduction, std::span<const int> widths = kLineWidths);

    int blocks() const { return blocks_; }
    int rows() const { return rows_; }
    double column_of(int block) const;  ///< middle of the block, px of the picture
    double row_of(double row) const;    ///< from rows of the reduced picture to px

    /// One sign a row.
    const LineSign* at(LineKind kind, int block, int slope) const { return &sign_[index(kind, block, slope)]; }

    static constexpr int kStep = kSlopes;  ///< reduced columns from block to block: slope i moves by i rows

private:
    std::size_t index(LineKind kind, int block, int slope) const {
        const int line = (static_cast<int>(kind) * blocks_ + block) * kSlopeCount + slope + kSlopes;
        return static_cast<std::size_t>(line) * static_cast<std::size_t>(rows_);
    }

    int reduction_, blocks_ = 0, rows_ = 0;
    std::vector<LineSign> sign_;
};

}  // namespace seampath::detail
