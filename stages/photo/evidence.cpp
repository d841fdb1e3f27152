#include "stages/photo/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "stages/geometry/parallel.hpp"

namespace seampath::detail {
namespace {

constexpr int kBlockColumns = 2 * LineEvidence::kStep;
constexpr int kFrame = 16;          // rows along the picture's frame, which is no border of anything
constexpr float kRounding = 0.01F;  // of logarithms: about a grey value in a mean of 100

/// Logarithms of grey values, so that light and shade change a line's height as little as they change what it is: a gap
/// is as dark in the shade.
GreyImage reduced(const GreyImage& image, int by) {
    GreyImage small{image.width / by, image.height / by, image.white, {}};
    small.value.reserve(static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height));
    for (int r = 0; r < small.height; ++r) {
        for (int c = 0; c < small.width; ++c) {
            float sum = 0;
            for (int i = 0; i < by * by; ++i) {
                sum += image.at(c * by + i % by, r * by + i / by);
            }
            small.value.push_back(std::log(kBlack + sum / static_cast<float>(by * by)));
        }
    }
    return small;
}

/// Rows' means over a block's columns, taken along a slope, and summed up: the i-th is the sum of the rows above i.
std::vector<float> sums_along(const GreyImage& image, int first_column, double slope) {
    std::vector<float> mean(static_cast<std::size_t>(image.height), 0);
    for (int i = 0; i < kBlockColumns; ++i) {
        const int shift = static_cast<int>(std::lround(slope * (i + 0.5 - 0.5 * kBlockColumns)));
        for (int r = 0; r < image.height; ++r) {
            mean[static_cast<std::size_t>(r)] += image.clamped(first_column + i, r + shift);
        }
    }
    std::vector<float> sums{0};
    for (const float m : mean) {
        sums.push_back(sums.back() + m / kBlockColumns);
    }
    return sums;
}

float mean_between(const std::vector<float>& sums, int begin, int end) {
    return (sums[static_cast<std::size_t>(end)] - sums[static_cast<std::size_t>(begin)]) /
           static_cast<float>(end - begin);
}

/// Means over a line's own rows and over half as many on either side of it, a quarter of them apart: its borders are
/// soft.
struct LineContrast {
    float own, above, below;
    float signed_height() const { return own - 0.5F * (above + below); }
    float border() const { return below - above; }
    /// A seam's sides look alike: a line's height is worth less the more they differ.
    float alike(float height) const { return height > 0 ? height * height / (height + 0.5F * std::abs(border())) : 0; }
};

/// Rows' mean sizes of a contrast up to each of them, from which 1-sigma of what it is without a line follows: a line's
/// own part in the mean around it is small.
class ContrastSigma {
public:
    explicit ContrastSigma(int around) : around_(around) {}
    void add(float contrast) { sums_.push_back(sums_.back() + std::abs(contrast)); }
    float at(int i) const {
        constexpr float kSigmaOfMean = 1.2533F;  // sqrt(pi / 2): of a normal variable's mean size
        const int n = static_cast<int>(sums_.size()) - 1;
        return kSigmaOfMean * mean_between(sums_, std::max(0, i - around_), std::min(n, i + around_ + 1)) + kRounding;
    }

private:
    int around_;
    std::vector<float> sums_{0};
};

void keep_stronger(LineSign& sign, float strength, int width) {
    if (strength > sign.strength) {
        sign = {strength, static_cast<float>(width)};
    }
}

/// Keeps, per row, the stronger of what is there and of lines of one width.
void look_for_width(const std::vector<float>& sums, int width, const std::array<LineSign*, kLineKinds>& signs) {
    const int rows = static_cast<int>(sums.size()) - 1, apart = std::max(1, width / 4), side = std::max(2, width / 2);
    const int reach = apart + side, around = 16 * width + 32;
    std::vector<LineContrast> contrasts;
    ContrastSigma line_sigma(around), border_sigma(around);
    for (int top = reach; top + width + reach <= rows; ++top) {
        contrasts.push_back({mean_between(sums, top, top + width), mean_between(sums, top - reach, top - apart),
                             mean_between(sums, top + width + apart, top + width + reach)});
        line_sigma.add(contrasts.back().signed_height());
        border_sigma.add(contrasts.back().border());
    }
    for (int i = 0; i < static_cast<int>(contrasts.size()); ++i) {
        const LineContrast& c = contrasts[static_cast<std::size_t>(i)];
        const int row = reach + i + width / 2;
        const float sigma = line_sigma.at(i);
        keep_stronger(signs[0][row], c.alike(std::min(c.above, c.below) - c.own) / sigma, width);
        keep_stronger(signs[1][row], c.alike(c.own - std::max(c.above, c.below)) / sigma, width);
        if (row >= kFrame && row < rows - kFrame) {
            keep_stronger(signs[2][row], std::abs(c.border()) / border_sigma.at(i), width);
        }
    }
}

/// The edges of a gap shine: what is bright right beside a dark line is as much less a line as that one is more.
void drop_glints(const LineSign* dark, LineSign* bright, int rows) {
    constexpr int kGlint = 3;  // rows
    std::vector<float> beside(static_cast<std::size_t>(rows), 0);
    for (int r = 0; r < rows; ++r) {
        const int reach = static_cast<int>(0.5F * dark[r].width) + kGlint;
        for (int i = std::max(0, r - reach); dark[r].strength > 0 && i < std::min(rows, r + reach + 1); ++i) {
            beside[static_cast<std::size_t>(i)] = std::max(beside[static_cast<std::size_t>(i)], dark[r].strength);
        }
    }
    for (int r = 0; r < rows; ++r) {
        bright[r].strength = std::max(0.0F, bright[r].strength - beside[static_cast<std::size_t>(r)]);
    }
}

}  // namespace

LineEvidence::LineEvidence(const GreyImage& image, int reduction, std::span<const int> widths) : reduction_(reduction) {
    const GreyImage small = reduced(image, reduction);
    blocks_ = std::max(0, small.width / kStep - 1);
    rows_ = small.height;
    sign_.resize(static_cast<std::size_t>(kLineKinds * blocks_ * kSlopeCount) * static_cast<std::size_t>(rows_));
    parallel_for(static_cast<std::size_t>(blocks_), 1, [&](std::size_t b) {
        const int block = static_cast<int>(b);
        for (int s = -kSlopes; s <= kSlopes; ++s) {
            const auto sums = sums_along(small, block * kStep, static_cast<double>(s) / kSlopes);
            const std::array<LineSign*, kLineKinds> signs{&sign_[index(LineKind::dark, block, s)],
                                                          &sign_[index(LineKind::bright, block, s)],
                                                          &sign_[index(LineKind::border, block, s)]};
            for (const int width : widths) {
                look_for_width(sums, width, signs);
            }
            drop_glints(signs[0], signs[1], rows_);
        }
    });
}

double LineEvidence::column_of(int block) const {
    return (block + 1) * kStep * reduction_ - 0.5;
}

double LineEvidence::row_of(double row) const {
    return (row + 0.5) * reduction_ - 0.5;
}

}  // namespace seampath::detail
