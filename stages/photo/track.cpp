#include "stages/photo/track.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

/// Median width of a path's line about a block, rows of the reduced picture.
double width_about(const LinePath& path, std::size_t block) {
    constexpr std::size_t kReach = 4;
    std::vector<double> widths;
    const std::size_t end = std::min(path.places.size(), block + kReach + 1);
    for (std::size_t i = block > kReach ? block - kReach : 0; i < end; ++i) {
        if (path.places[i].kind == path.places[block].kind && path.places[i].sign.strength > 0) {
            widths.push_back(static_cast<double>(path.places[i].sign.width));
        }
    }
    return widths.empty() ? 1 : quantile(widths, 0.5);
}

/// The path at each of the track's columns.
std::vector<TrackPlace> along_path(const GreyImage& image, const LineEvidence& evidence, const LinePath& path,
                                   double px_per_row) {
    const std::size_t last = path.places.size() - 1;
    const double first_column = evidence.column_of(0), block_px = LineEvidence::kStep * px_per_row;
    std::vector<TrackPlace> places;
    for (int column = 0; column < image.width; column += kTrackStep) {
        const double at = (column - first_column) / block_px;
        const auto i =
            static_cast<std::size_t>(std::clamp(std::floor(at), 0.0, std::max(0.0, static_cast<double>(last) - 1)));
        const std::size_t j = std::min(i + 1, last);
        const std::size_t nearest = at - static_cast<double>(i) < 0.5 ? i : j;
        const PathPlace &a = path.places[i], &b = path.places[j];
        TrackPlace place;
        place.slope = j > i ? static_cast<double>(b.row - a.row) / LineEvidence::kStep : 0;
        place.y = evidence.row_of(a.row + place.slope * LineEvidence::kStep * (at - static_cast<double>(i)));
        place.kind = path.places[nearest].kind;
        place.width = px_per_row * width_about(path, nearest);
        place.seen = path.places[nearest].sign.strength > 1;
        places.push_back(place);
    }
    return places;
}

/// How far rows about the path stand out as lines, one a row from -reach to reach, for one place.
class TrackStrip {
public:
    TrackStrip(const GreyImage& image, int reach) : image_(image), reach_(reach) {}

    /// Heights of lines of the place's width and kind, in logarithms of grey values, means over some columns.
    std::vector<double> heights(const TrackPlace& place, int column) const {
        constexpr int kHalfMean = 3;  // columns: jags of a torn edge are as long
        const int width = std::max(1, static_cast<int>(std::lround(place.width))), apart = std::max(1, width / 4);
        const int side = std::max(2, width / 2), edge = reach_ + width / 2 + apart + side + 1;
        std::vector<double> sums{0};
        for (int u = -edge; u <= edge + 1; ++u) {
            double sum = 0;
            for (int i = -kHalfMean; i <= kHalfMean; ++i) {
                const double row = place.y + place.slope * i + u;
                sum += static_cast<double>(image_.clamped(column + i, static_cast<int>(std::lround(row))));
            }
            sums.push_back(sums.back() + std::log(static_cast<double>(kBlack) + sum / (2 * kHalfMean + 1)));
        }
        const auto mean = [&](int begin, int count) {
            const auto first = sums.begin() + begin;
            return (first[count] - *first) / count;
        };
        std::vector<double> heights;
        for (int u = -reach_; u <= reach_; ++u) {
            const int top = u + edge - width / 2;
            const double own = mean(top, width), above = mean(top - apart - side, side);
            const double below = mean(top + width + apart, side);
            heights.push_back(place.kind == LineKind::bright ? own - std::max(above, below)
                                                             : std::min(above, below) - own);
        }
        return heights;
    }

private:
    const GreyImage& image_;
    int reach_;
};

/// Offsets, one a place, whose heights together are most; from place to place by one row at most, which costs.
std::vector<int> best_offsets(const std::vector<std::vector<double>>& heights, int reach) {
    constexpr double kMove = 1;  // of the usual height of what stands out
    constexpr double kMost = 3;  // times that height: more counts no more
    std::vector<double> all;
    for (const auto& column : heights) {
        all.push_back(*std::max_element(column.begin(), column.end()));
    }
    const double unit = std::max(1e-6, quantile(all, 0.5));
    const auto rows = 2 * static_cast<std::size_t>(reach) + 1;
    std::vector<double> worth(rows, 0);
    std::vector<std::int8_t> from(heights.size() * rows, 0);
    for (std::size_t k = 0; k < heights.size(); ++k) {
        std::vector<double> next(rows);
        for (std::size_t r = 0; r < rows; ++r) {
            int best = 0;
            for (const int move : {-1, 1}) {
                const std::size_t old = r + static_cast<std::size_t>(move);
                if (old < rows && worth[old] - kMove > worth[r + static_cast<std::size_t>(best)] - (best ? kMove : 0)) {
                    best = move;
                }
            }
            from[k * rows + r] = static_cast<std::int8_t>(best);
            next[r] = worth[r + static_cast<std::size_t>(best)] - (best ? kMove : 0) +
                      std::clamp(heights[k][r] / unit, 0.0, kMost);
        }
        worth = std::move(next);
    }
    std::vector<int> offsets(heights.size());
    auto r = static_cast<std::size_t>(std::max_element(worth.begin(), worth.end()) - worth.begin());
    for (std::size_t k = heights.size(); k-- > 0;) {
        offsets[k] = static_cast<int>(r) - reach;
        r += static_cast<std::size_t>(from[k * rows + r]);
    }
    return offsets;
}

}  // namespace

std::vector<TrackPlace> track_line(const GreyImage& image, const LineEvidence& evidence, const LinePath& path,
                                   double px_per_row) {
    constexpr double kRowsOff = 4;  // that a path may be off a ragged line
    const int reach = static_cast<int>(std::lround(kRowsOff * px_per_row));
    std::vector<TrackPlace> places = along_path(image, evidence, path, px_per_row);
    const TrackStrip strip(image, reach);
    std::vector<std::vector<double>> heights;
    for (std::size_t k = 0; k < places.size(); ++k) {
        heights.push_back(strip.heights(places[k], static_cast<int>(k) * kTrackStep));
    }
    const std::vector<int> offsets = best_offsets(heights, reach);
    for (std::size_t k = 0; k < places.size(); ++k) {
        places[k].y += offsets[k];
        places[k].seen = places[k].seen && heights[k].begin()[offsets[k] + reach] > 0;
    }
    return places;
}

}  // namespace seampath::detail
