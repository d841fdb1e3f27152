#include "stages/stripe/bars.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace seampath {
namespace {

/// Heights of bars, px: steps of at most sqrt(2) but for the smallest, where rows are whole. All are even.
constexpr std::array<int, 7> kHeights{2, 4, 6, 8, 12, 16, 24};

constexpr int kBlock = 16;  // columns that are worked on at once: a fixed number becomes vector code

/// Rows of numbers, each padded to whole blocks.
class Table {
public:
    Table(int width, int rows)
        : stride_(static_cast<std::size_t>((width + kBlock - 1) / kBlock) * kBlock),
          value_(stride_ * static_cast<std::size_t>(rows)) {}
    float* row(int i) { return value_.data() + static_cast<std::size_t>(i) * stride_; }
    const float* row(int i) const { return value_.data() + static_cast<std::size_t>(i) * stride_; }
    std::size_t stride() const { return stride_; }

private:
    std::size_t stride_;
    std::vector<float> value_;
};

/// Row r holds each column's sum of the rows above r.
Table sums_above(const GreyImage& image) {
    Table sums(image.width, image.height + 1);
    for (int r = 0; r < image.height; ++r) {
        const float* above = sums.row(r);
        float* here = sums.row(r + 1);
        for (int c = 0; c < image.width; ++c) {
            here[c] = above[c] + image.at(c, r);
        }
    }
    return sums;
}

/// Means over rows [begin, end) of a table of sums.
struct Window {
    const float* begin;
    const float* end;
    float share;
};

Window window(const Table& sums, int begin, int end) {
    return {sums.row(begin), sums.row(end), 1.0F / static_cast<float>(end - begin)};
}

/// A bar about the upper side of a row, and what it is held against: half as many rows on either side, half of its
/// height away, because stripes fade towards their borders. At the picture's border fewer; where nearly nothing is
/// left, what is bright there may be cut off, and its middle can't be told.
struct BarWindows {
    Window inner, upper, lower;
};

bool bar_windows(const Table& sums, int rows, int row, int height, BarWindows& windows) {
    const int half = height / 2;
    const int upper_begin = std::max(row - height - half, 0), lower_end = std::min(row + height + half, rows);
    const int least = (half + 1) / 2;
    if (row - height - upper_begin < least || lower_end - row - height < least) {
        return false;
    }
    windows = {window(sums, row - half, row + half), window(sums, upper_begin, row - height),
               window(sums, row + height, lower_end)};
    return true;
}

/// Keeps, per column, the best of what is there and this height's contrast times `weight`.
void keep_better(const BarWindows& w, float weight, float index, std::size_t columns, float* __restrict best,
                 float* __restrict which) {
    const float *ib = w.inner.begin, *ie = w.inner.end, *ub = w.upper.begin, *ue = w.upper.end;
    const float *lb = w.lower.begin, *le = w.lower.end;
    for (std::size_t begin = 0; begin < columns; begin += kBlock) {
        for (std::size_t i = begin; i < begin + kBlock; ++i) {
            const float inner = (ie[i] - ib[i]) * w.inner.share;
            const float upper = (ue[i] - ub[i]) * w.upper.share;
            const float lower = (le[i] - lb[i]) * w.lower.share;
            const float strength = (inner - (upper > lower ? upper : lower)) * weight;
            const bool better = strength > best[i];
            best[i] = better ? strength : best[i];
            which[i] = better ? index : which[i];
        }
    }
}

/// 1-sigma of a mean over the bar's rows less one over half as many.
double contrast_noise(int height, double noise) {
    return noise * std::sqrt(3.0 / height);
}

}  // namespace

double noise_of(const GreyImage& image) {
    constexpr int kStep = 3;  // rows and columns left out: a ninth of the pixels says enough
    std::vector<float> steps;
    for (int r = 0; r < image.height; r += kStep) {
        for (int c = 0; c + 2 < image.width; c += kStep) {
            steps.push_back(std::abs(image.at(c + 2, r) - image.at(c, r)));
        }
    }
    if (steps.empty()) {
        return 1;
    }
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    // Steps are whole numbers, so their mean tells more than their median; borders of things are left out.
    const float most = 4 * (*middle + 1);
    double sum = 0, count = 0;
    for (const float step : steps) {
        if (step <= most) {
            sum += step;
            ++count;
        }
    }
    constexpr double kSigmaOfMean = 0.886;  // sqrt(pi) / 2: of the mean size of a difference of two
    return std::max(std::sqrt(1.0 / 12), kSigmaOfMean * sum / count);
}

std::vector<std::vector<Bar>> find_bars(const GreyImage& image, double noise, double least) {
    const Table sums = sums_above(image);
    Table best(image.width, image.height + 1), which(image.width, image.height + 1);
    for (int r = 1; r < image.height; ++r) {
        for (std::size_t k = 0; k < kHeights.size(); ++k) {
            BarWindows windows{};
            if (bar_windows(sums, image.height, r, kHeights[k], windows)) {
                const double weight = 1 / contrast_noise(kHeights[k], noise);
                keep_better(windows, static_cast<float>(weight), static_cast<float>(k), sums.stride(), best.row(r),
                            which.row(r));
            }
        }
    }
    std::vector<std::vector<Bar>> bars(static_cast<std::size_t>(image.width));
    for (int r = 1; r < image.height; ++r) {
        for (int c = 0; c < image.width; ++c) {
            const float strength = best.row(r)[c];
            if (strength < least || strength < best.row(r - 1)[c] || strength <= best.row(r + 1)[c]) {
                continue;
            }
            const int height = kHeights[static_cast<std::size_t>(which.row(r)[c])];
            bool peak = true;
            for (int k = std::max(r - height, 0); peak && k <= std::min(r + height, image.height); ++k) {
                peak = best.row(k)[c] <= strength;
            }
            if (peak) {
                const double contrast = strength * contrast_noise(height, noise);
                bars[static_cast<std::size_t>(c)].push_back(
                    {static_cast<float>(r) - 0.5F, static_cast<float>(height), static_cast<float>(contrast), strength});
            }
        }
    }
    return bars;
}

}  // namespace seampath
