#include "stages/photo/measure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/geometry/robust.hpp"
#include "stages/photo/look.hpp"
#include "stages/photo/smooth.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector2d;

constexpr double kSigmaOfMedian = 1.4826;

/// A stretch of the line, taken together.
struct LineStretch {
    double x = 0, y = 0, slope = 0;
    double sigma = 0;
    bool measured = false;
};

/// The middle of a stretch's sights, by medians along the track's slope, if half of them see the line.
LineStretch stretch_of(const std::vector<LinePlace>& places, const std::vector<RidgeSight>& sights, std::size_t begin,
                       std::size_t end) {
    LineStretch stretch;
    stretch.x = 0.5 * kTrackStep * static_cast<double>(begin + end - 1);
    const auto n = static_cast<double>(end - begin);
    const TrackPlace &first = places[begin].track, &last = places[end - 1].track;
    stretch.slope = end - begin > 1 ? (last.y - first.y) / (kTrackStep * (n - 1)) : first.slope;
    std::vector<double> heights, off;
    for (std::size_t i = begin; i < end; ++i) {
        if (sights[i].seen && places[i].track.seen) {
            heights.push_back(sights[i].y - stretch.slope * (kTrackStep * static_cast<double>(i) - stretch.x));
        }
    }
    stretch.measured = 2 * static_cast<double>(heights.size()) >= n;
    if (!stretch.measured) {
        return stretch;
    }
    const std::vector<double> all = heights;
    stretch.y = quantile(heights, 0.5);
    for (const double height : all) {
        off.push_back(std::abs(height - stretch.y));
    }
    constexpr double kLeastSigma = 0.02;    // px
    constexpr double kMedianLoss = 1.2533;  // 1-sigma of a median over that of a mean
    // Sights nearer together than the Gaussian is long share their errors.
    const double apart = 2 * std::sqrt(std::numbers::pi) * ridge_sigma(places[begin].width);
    const double independent = std::max(1.0, kTrackStep * static_cast<double>(all.size()) / apart);
    stretch.sigma = std::max(kLeastSigma, kSigmaOfMedian * kMedianLoss * quantile(off, 0.5) / std::sqrt(independent));
    return stretch;
}

/// The track's stretches along a smooth line.
struct MeasuredLine {
    std::vector<LineStretch> stretches;
    SmoothLine smooth;
    double step = 0;  ///< px from stretch to stretch
};

MeasuredLine smooth_stretches(const std::vector<LinePlace>& places, const std::vector<RidgeSight>& sights,
                              double width) {
    constexpr double kLeastStretch = 8, kLeastBlock = 32;  // px
    constexpr double kBlockWidths = 16;                    // flakes that break out of an edge are shorter
    constexpr double kMostBlocks = 12;                     // a share of the picture that says what comes next
    const double stretch_px = std::max(kLeastStretch, 4 * ridge_sigma(width));
    const auto together = static_cast<std::size_t>(std::lround(stretch_px / kTrackStep));
    const std::size_t count = std::max<std::size_t>(1, places.size() / together);
    MeasuredLine line;
    Heights heights;
    for (std::size_t i = 0; i < count; ++i) {
        line.stretches.push_back(
            stretch_of(places, sights, i * places.size() / count, (i + 1) * places.size() / count));
        heights.y.push_back(line.stretches.back().y);
        heights.measured.push_back(line.stretches.back().measured);
    }
    line.step = kTrackStep * static_cast<double>(places.size()) / static_cast<double>(count);
    if (std::count(heights.measured.begin(), heights.measured.end(), true) > 3) {
        const double length = kTrackStep * static_cast<double>(places.size());
        const double block = std::max(kLeastBlock, std::min(kBlockWidths * width, length / kMostBlocks)) / line.step;
        line.smooth = smooth_line(heights, std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(block))));
    }
    return line;
}

/// The track moved onto the smooth line.
void follow(std::vector<TrackPlace>& track, const MeasuredLine& line) {
    const std::size_t last = line.stretches.size() - 1;
    for (std::size_t i = 0; i < track.size(); ++i) {
        const double at = std::clamp((kTrackStep * static_cast<double>(i) - line.stretches[0].x) / line.step, 0.0,
                                     static_cast<double>(last));
        const std::size_t k = std::min(static_cast<std::size_t>(at), last > 0 ? last - 1 : 0),
                          next = std::min(k + 1, last);
        track[i].slope = (line.smooth.y[next] - line.smooth.y[k]) / line.step;
        track[i].y = line.smooth.y[k] + track[i].slope * (kTrackStep * static_cast<double>(i) - line.stretches[k].x);
    }
}

/// To the picture's borders where the line reaches the stretches beside them.
void reach_borders(std::vector<PhotoPoint>& points, const MeasuredLine& line, double last_column) {
    const auto add = [&](const PhotoPoint& end, double x) {
        PhotoPoint point = end;
        point.p += (x - end.p.x()) * Vector2d(1, -end.normal.x() / end.normal.y());
        return point;
    };
    if (points.front().p.x() < line.step) {
        points.insert(points.begin(), add(points.front(), 0));
    }
    if (points.back().p.x() > last_column - line.step) {
        points.push_back(add(points.back(), last_column));
    }
}

/// Points of the smooth line. What is not measured, or off the line by more than chance, is modelled; the farther it is
/// from what is measured the less is known of it. Beyond its measured ends the line is known as far as it is smooth.
std::vector<PhotoPoint> points_of(const MeasuredLine& line) {
    constexpr double kFlaw = 4;  // robust sigmas
    const auto& stretches = line.stretches;
    std::vector<double> sigmas;
    std::vector<std::size_t> sound;
    for (const auto& stretch : stretches) {
        if (stretch.measured) {
            sigmas.push_back(stretch.sigma);
        }
    }
    const double one = std::max(line.smooth.scatter, quantile(sigmas, 0.5));
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        if (stretches[i].measured && std::abs(stretches[i].y - line.smooth.y[i]) <= std::max(1.0, kFlaw * one)) {
            sound.push_back(i);
        }
    }
    std::vector<PhotoPoint> points;
    if (sound.empty()) {
        return points;
    }
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        const auto after = std::lower_bound(sound.begin(), sound.end(), i);
        const std::size_t to = after == sound.end() ? sound.back() : *after;
        const std::size_t from = after == sound.begin() || *after == i ? to : *std::prev(after);
        const auto away = static_cast<double>(std::min(i > from ? i - from : from - i, i > to ? i - to : to - i));
        if ((i < sound.front() || i > sound.back()) && away > line.smooth.length) {
            continue;
        }
        // Slopes are known to about the line's own 1-sigma over the length that it is smooth over.
        const double away_sigma = line.smooth.sigma * (1 + 2 * std::numbers::pi * away / line.smooth.length);
        const double a = line.smooth.y[from], b = line.smooth.y[to];
        const double chord = to > from && to != i
                                 ? a + (b - a) * static_cast<double>(i - from) / static_cast<double>(to - from)
                                 : line.smooth.y[i];
        const std::size_t k = std::min(i, stretches.size() - 2);
        const Vector2d normal = Vector2d(-(line.smooth.y[k + 1] - line.smooth.y[k]) / line.step, 1).normalized();
        points.push_back({{stretches[i].x, line.smooth.y[i]},
                          normal,
                          normal.y() * std::hypot(away_sigma, line.smooth.y[i] - chord),
                          away > 0});
    }
    return points;
}

}  // namespace

std::vector<PhotoPoint> measure_line(const GreyImage& image, std::vector<TrackPlace> track) {
    constexpr int kLooks = 2;  // the second from nearer by
    MeasuredLine line;
    for (int look = 0; look < kLooks; ++look) {
        std::vector<LinePlace> places;
        std::vector<double> widths;
        for (std::size_t i = 0; i < track.size(); ++i) {
            places.push_back(look_of(image, track, i));
            widths.push_back(places.back().width);
        }
        line = smooth_stretches(places, sights_of(image, places), quantile(widths, 0.5));
        if (line.smooth.y.empty()) {
            return {};
        }
        follow(track, line);
    }
    std::vector<PhotoPoint> points = points_of(line);
    if (!points.empty()) {
        reach_borders(points, line, image.width - 1);
    }
    return points;
}

}  // namespace seampath::detail
