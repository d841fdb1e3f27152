#include "stages/photo/measure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "stages/geometry/robust.hpp"
#include "stages/geometry/steger.hpp"
#include "stages/photo/smooth.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector2d;

constexpr double kSigmaOfMedian = 1.4826;
constexpr double kRidgeShare = 0.35;  // the Gaussian's sigma over the line's width; Steger's least is 0.29

/// A place of the track and how the line looks there.
struct LinePlace {
    TrackPlace track;
    double width = 0;  ///< px
    double level = 0;  ///< grey value between the line and the side that is more like it
};

/// The line bright on its sides' ground. Beyond the level its grey values are cut off: in an open gap light falls on
/// this and that, and its middle is the one of its edges.
GreyImage line_alone(const GreyImage& image, const std::vector<LinePlace>& places) {
    GreyImage alone = image;
    for (std::size_t i = 0; i < alone.value.size(); ++i) {
        const std::size_t column = i % static_cast<std::size_t>(image.width);
        const LinePlace& place = places[std::min(column / kTrackStep, places.size() - 1)];
        const auto level = static_cast<float>(place.level);
        float& grey = alone.value[i];
        grey = place.track.kind == LineKind::bright ? std::min(grey, level)
                                                    : static_cast<float>(image.white) - std::max(grey, level);
    }
    return alone;
}

/// The line's middle at one column.
struct RidgeSight {
    double y = 0;
    bool seen = false;
};

/// Steger's ridge along the line.
class RidgeEye {
public:
    RidgeEye(const GreyImage& image, const std::vector<LinePlace>& places) : image_(line_alone(image, places)) {}

    RidgeSight look(const LinePlace& line, int column) {
        constexpr double kPixelNoise = 0.3;  // grey values: rounding alone; texture is told from lines by the track
        constexpr double kFarthest = 1.5;    // px from the track, or half of the line's width
        const TrackPlace& place = line.track;
        const RidgeKernel& kernel = kernel_of(line.width);
        const auto ridge =
            ridge_point(image_, kernel, column, place.y, ground(line, column, kernel.sigma), kPixelNoise);
        if (!ridge) {
            return {};
        }
        // Where the ridge crosses the middle of the column.
        const double y = ridge->p.y() + (ridge->p.x() - column) * ridge->normal.x() / ridge->normal.y();
        return {y, std::abs(y - place.y) <= std::max(kFarthest, 0.5 * line.width)};
    }

    static double sigma_of(double width) { return std::max(0.85, kRidgeShare * width); }

private:
    const RidgeKernel& kernel_of(double width) {
        constexpr double kGrid = 0.25;  // px, of sigmas: one kernel serves many points
        const int index = static_cast<int>(std::lround(sigma_of(width) / kGrid));
        auto kernel = kernels_.find(index);
        if (kernel == kernels_.end()) {
            kernel = kernels_.emplace(index, make_kernel(index * kGrid)).first;
        }
        return kernel->second;
    }

    /// Sides of different grey draw the ridge towards the one that is more like the line. In the middle of a bar of the
    /// width w whose sides differ by d, the Gaussian's derivative of the picture is d g(w / 2): so much is taken off.
    GroundSlope ground(const LinePlace& line, int column, double sigma) const {
        const TrackPlace& place = line.track;
        const int reach = std::max(3, static_cast<int>(std::lround(3 * sigma)));
        GroundSlope slope;
        slope.normal = Vector2d(-place.slope, 1).normalized();
        double difference = 0;
        int count = 0;
        for (int i = -reach; i <= reach; ++i) {
            for (double away = 0.75 * line.width + 1; away <= 1.5 * line.width + 2; away += 1) {
                const double y = place.y + place.slope * i;
                const auto row = [&](double at) { return static_cast<int>(std::lround(at)); };
                difference += static_cast<double>(image_.clamped(column + i, row(y + away)) -
                                                  image_.clamped(column + i, row(y - away)));
                ++count;
            }
        }
        const double g =
            std::exp(-0.125 * line.width * line.width / (sigma * sigma)) / (std::sqrt(2 * std::numbers::pi) * sigma);
        slope.slope = difference / count * g;
        return slope;
    }

    GreyImage image_;
    std::map<int, RidgeKernel> kernels_;
};

/// Mean grey values across the line over some length of the track about a place, bright or negative as the line is.
class MeanProfile {
public:
    MeanProfile(const GreyImage& image, const std::vector<TrackPlace>& track, std::size_t middle)
        : reach_(static_cast<int>(std::lround(3 * track[middle].width)) + 6),
          value_(static_cast<std::size_t>(2 * reach_ + 1), 0) {
        constexpr std::size_t kPlaces = 30;  // to either side
        const LineKind kind = track[middle].kind;
        const double sign = kind == LineKind::bright ? 1 : -1;
        const std::size_t end = std::min(track.size(), middle + kPlaces + 1);
        for (std::size_t i = middle > kPlaces ? middle - kPlaces : 0; i < end; ++i) {
            const bool counts = track[i].seen && track[i].kind == kind;
            places_ += counts ? 1 : 0;
            const int column = static_cast<int>(i) * kTrackStep, row = static_cast<int>(std::lround(track[i].y));
            for (int u = -reach_; counts && u <= reach_; ++u) {
                value_[static_cast<std::size_t>(u + reach_)] +=
                    sign * static_cast<double>(image.clamped(column, row + u));
            }
        }
    }

    int reach() const { return reach_; }
    double at(int u) const { return value_[static_cast<std::size_t>(u + reach_)] / std::max(1, places_); }
    double mean(int begin, int end) const {
        double sum = 0;
        for (int u = begin; u <= end; ++u) {
            sum += at(u);
        }
        return sum / (end - begin + 1);
    }

private:
    int reach_, places_ = 0;
    std::vector<double> value_;
};

/// How the line looks about a place of the track. Its mean profile is as wide as it is between the places where the
/// grey is half way to either side's; as wide as the track says where it shows no such places.
LinePlace look_of(const GreyImage& image, const std::vector<TrackPlace>& track, std::size_t middle) {
    constexpr double kOpen = 4;   // px: narrower gaps show nothing of their inside
    constexpr double kCut = 0.4;  // of the way to a side: walls of a gap are darker, rims of sheets brighter
    const MeanProfile profile(image, track, middle);
    const double guess = track[middle].width;
    const int far = static_cast<int>(std::lround(2 * guess)) + 2, core = static_cast<int>(guess / 4);
    const double own = profile.mean(-core, core);
    const double above = profile.mean(-profile.reach(), -far), below = profile.mean(far, profile.reach());
    const auto edge = [&](int step) {
        const double level = 0.5 * (own + (step < 0 ? above : below));
        int u = 0;
        while (std::abs(u) < far && profile.at(u) > level) {
            u += step;
        }
        return u == 0 || std::abs(u) == far
                   ? 0.5 * guess
                   : std::abs(u) - (level - profile.at(u)) / (profile.at(u - step) - profile.at(u));
    };
    const double width = std::max(1.0, edge(-1) + edge(1));
    const bool bright = track[middle].kind == LineKind::bright;
    double level = bright ? image.white : 0;
    if (width >= kOpen) {
        level = (bright ? 1 : -1) * (own + kCut * (std::max(above, below) - own));
    }
    return {track[middle], width, level};
}

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
    const double apart = 2 * std::sqrt(std::numbers::pi) * RidgeEye::sigma_of(places[begin].width);
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
    const double stretch_px = std::max(kLeastStretch, 4 * RidgeEye::sigma_of(width));
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
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        if (stretches[i].measured) {
            sigmas.push_back(stretches[i].sigma);
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

std::vector<RidgeSight> sights_of(const GreyImage& image, const std::vector<LinePlace>& places) {
    RidgeEye eye(image, places);
    std::vector<RidgeSight> sights;
    for (std::size_t i = 0; i < places.size(); ++i) {
        sights.push_back(eye.look(places[i], static_cast<int>(i) * kTrackStep));
    }
    return sights;
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
