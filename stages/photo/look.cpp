#include "stages/photo/look.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "stages/geometry/steger.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector2d;

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

private:
    const RidgeKernel& kernel_of(double width) {
        constexpr double kGrid = 0.25;  // px, of sigmas: one kernel serves many points
        const int index = static_cast<int>(std::lround(ridge_sigma(width) / kGrid));
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
          value_(2 * static_cast<std::size_t>(reach_) + 1, 0) {
        constexpr std::size_t kPlaces = 30;  // to either side
        const LineKind kind = track[middle].kind;
        const double sign = kind == LineKind::bright ? 1 : -1;
        const std::size_t end = std::min(track.size(), middle + kPlaces + 1);
        for (std::size_t i = middle > kPlaces ? middle - kPlaces : 0; i < end; ++i) {
            const bool counts = track[i].seen && track[i].kind == kind;
            places_ += counts ? 1 : 0;
            const int column = static_cast<int>(i) * kTrackStep, row = static_cast<int>(std::lround(track[i].y));
            for (int u = -reach_; counts && u <= reach_; ++u) {
                value_.begin()[u + reach_] += sign * static_cast<double>(image.clamped(column, row + u));
            }
        }
    }

    int reach() const { return reach_; }
    double at(int u) const { return value_.begin()[u + reach_] / std::max(1, places_); }
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

}  // namespace

double ridge_sigma(double width) {
    constexpr double kRidgeShare = 0.35;  // of the line's width; Steger's least is 0.29
    return std::max(0.85, kRidgeShare * width);
}

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

std::vector<RidgeSight> sights_of(const GreyImage& image, const std::vector<LinePlace>& places) {
    RidgeEye eye(image, places);
    std::vector<RidgeSight> sights;
    for (std::size_t i = 0; i < places.size(); ++i) {
        sights.push_back(eye.look(places[i], static_cast<int>(i) * kTrackStep));
    }
    return sights;
}

}  // namespace seampath::detail
