#include "stages/photo/track.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

/// Median width of a line, rows, where it stands out and is no wider than it can be.
double usual_width(const LinePath& path, double widest) {
    std::vector<double> widths;
    for (const PathPlace& place : path.places) {
        if (place.sign.strength > 1 && static_cast<double>(place.sign.width) <= widest) {
            widths.push_back(static_cast<double>(place.sign.width));
        }
    }
    return widths.empty() ? 1 : quantile(widths, 0.5);
}

/// Half to double of a width, and no less than a pixel. A seam is as wide all along, give or take; what is far wider
/// beside it was ground or lies in its shade.
std::vector<int> widths_about(double width) {
    std::set<int> widths;
    for (int i = -2; i <= 2; ++i) {
        widths.insert(std::max(1, static_cast<int>(std::lround(width * std::pow(2, 0.5 * i)))));
    }
    return {widths.begin(), widths.end()};
}

/// A path as a polyline over the columns of the picture.
class PathLine {
public:
    PathLine(const LineEvidence& evidence, const LinePath& path) : path_(path) {
        for (int i = 0; i < evidence.blocks(); ++i) {
            x_.push_back(evidence.column_of(i));
            y_.push_back(evidence.row_of(path.places[static_cast<std::size_t>(i)].row));
        }
    }

    /// The piece that holds a column; the outer ones go on beyond the path's ends.
    std::size_t piece(double column) const {
        const auto after = std::upper_bound(x_.begin(), x_.end(), column);
        const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, after - x_.begin()));
        return std::min(i, std::max<std::size_t>(1, x_.size() - 1)) - 1;
    }
    double slope(double column) const {
        const std::size_t i = piece(column);
        return x_.size() < 2 ? 0 : (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]);
    }
    double y(double column) const { return y_[piece(column)] + slope(column) * (column - x_[piece(column)]); }
    const PathPlace& nearest(double column) const {
        const std::size_t i = piece(column);
        return path_.places[x_.size() > 1 && column - x_[i] > x_[i + 1] - column ? i + 1 : i];
    }

private:
    const LinePath& path_;
    std::vector<double> x_, y_;
};

/// The rows about a line, `half` to either side of it, each column moved so that the line is the middle row.
GreyImage strip_about(const GreyImage& image, const PathLine& line, int half) {
    GreyImage strip{image.width, 2 * half + 1, image.white, {}};
    strip.value.resize(static_cast<std::size_t>(strip.width) * static_cast<std::size_t>(strip.height));
    for (int c = 0; c < strip.width; ++c) {
        const double top = line.y(c) - half, whole = std::floor(top);
        const auto part = static_cast<float>(top - whole);
        for (int r = 0; r < strip.height; ++r) {
            const int row = static_cast<int>(whole) + r;
            strip.value[static_cast<std::size_t>(r) * static_cast<std::size_t>(strip.width) +
                        static_cast<std::size_t>(c)] =
                (1 - part) * image.clamped(c, row) + part * image.clamped(c, row + 1);
        }
    }
    return strip;
}

}  // namespace

std::vector<TrackPlace> track_line(const GreyImage& image, const LineEvidence& evidence, const ChosenLine& line,
                                   double px_per_row) {
    constexpr double kRowsOff = 4;  // that the chosen path may be off, and half of the line
    constexpr int kTexture = 64;    // px on either side, that tell what stands out
    constexpr std::array kSeamKinds{LineKind::dark, LineKind::bright};
    const double width = usual_width(line.path, line.widest) * px_per_row;
    const double reach = kRowsOff * px_per_row + 0.5 * width;
    const PathLine rough(evidence, line.path);
    const int half = static_cast<int>(std::ceil(reach + 4 * width)) + kTexture;
    const std::vector<int> widths = widths_about(width);
    const LineEvidence near(strip_about(image, rough, half), 1, widths);
    const auto blocks = static_cast<std::size_t>(near.blocks());
    const Corridor corridor{std::vector<double>(blocks, half), std::vector<double>(blocks, reach / Corridor::kShare)};
    const LinePath path = best_path(near, kSeamKinds, {}, &corridor);
    const PathLine fine(near, path);
    std::vector<TrackPlace> places;
    for (int column = 0; column < image.width; column += kTrackStep) {
        const PathPlace& place = fine.nearest(column);
        places.push_back({rough.y(column) + fine.y(column) - half, rough.slope(column) + fine.slope(column),
                          static_cast<double>(place.sign.width), place.kind, place.sign.strength > 1});
    }
    return places;
}

}  // namespace seampath::detail
