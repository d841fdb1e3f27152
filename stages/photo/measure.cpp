#include "stages/photo/measure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "stages/geometry/robust.hpp"
#include "stages/geometry/steger.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector2d;

constexpr double kSigmaOfMedian = 1.4826;
constexpr double kRidgeShare = 0.35;  // the Gaussian's sigma over the line's width; Steger's least is 0.29

GreyImage inverted(const GreyImage& image) {
    GreyImage negative = image;
    for (float& grey : negative.value) {
        grey = static_cast<float>(image.white) - grey;
    }
    return negative;
}

/// The line's middle at one column.
struct RidgeSight {
    double y = 0;
    bool seen = false;
};

/// Steger's ridge in the picture or in its negative.
class RidgeEye {
public:
    explicit RidgeEye(const GreyImage& image) : bright_(image), dark_(inverted(image)) {}

    RidgeSight look(const TrackPlace& place, int column) {
        constexpr double kPixelNoise = 0.3;  // grey values: rounding alone; texture is told from lines by the track
        constexpr double kFarthest = 1.5;    // px from the track, or half of the line's width
        const GreyImage& image = place.kind == LineKind::bright ? bright_ : dark_;
        const RidgeKernel& kernel = kernel_of(place.width);
        const auto ridge =
            ridge_point(image, kernel, column, place.y, ground(image, place, column, kernel.sigma), kPixelNoise);
        if (!ridge) {
            return {};
        }
        // Where the ridge crosses the middle of the column.
        const double y = ridge->p.y() + (ridge->p.x() - column) * ridge->normal.x() / ridge->normal.y();
        return {y, std::abs(y - place.y) <= std::max(kFarthest, 0.5 * place.width)};
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
    GroundSlope ground(const GreyImage& image, const TrackPlace& place, int column, double sigma) const {
        const int reach = std::max(3, static_cast<int>(std::lround(3 * sigma)));
        GroundSlope slope;
        slope.normal = Vector2d(-place.slope, 1).normalized();
        double difference = 0;
        int count = 0;
        for (int i = -reach; i <= reach; ++i) {
            for (double away = 0.75 * place.width + 1; away <= 1.5 * place.width + 2; away += 1) {
                const double y = place.y + place.slope * i;
                const auto row = [&](double at) { return static_cast<int>(std::lround(at)); };
                difference += static_cast<double>(image.clamped(column + i, row(y + away)) -
                                                  image.clamped(column + i, row(y - away)));
                ++count;
            }
        }
        const double g =
            std::exp(-0.125 * place.width * place.width / (sigma * sigma)) / (std::sqrt(2 * std::numbers::pi) * sigma);
        slope.slope = difference / count * g;
        return slope;
    }

    const GreyImage& bright_;
    GreyImage dark_;
    std::map<int, RidgeKernel> kernels_;
};

/// Width of the line about a place of the track, px: of its mean profile over some length, between the places where
/// the grey is half way to either side's. The track's own where the profile shows no such places.
double width_of_profile(const GreyImage& image, const std::vector<TrackPlace>& track, std::size_t middle) {
    constexpr std::size_t kReach = 30;  // places
    const double guess = track[middle].width;
    const int reach = static_cast<int>(std::lround(3 * guess)) + 6, far = static_cast<int>(std::lround(2 * guess)) + 2;
    const int core = static_cast<int>(guess / 4);
    std::vector<double> profile(2 * static_cast<std::size_t>(reach) + 1, 0);
    const auto centre = profile.begin() + reach;
    for (std::size_t i = middle > kReach ? middle - kReach : 0; i < std::min(track.size(), middle + kReach + 1); ++i) {
        const double sign = track[i].kind == LineKind::bright ? 1 : -1;
        for (int u = -reach; track[i].seen && track[i].kind == track[middle].kind && u <= reach; ++u) {
            centre[u] += sign * static_cast<double>(image.clamped(static_cast<int>(i) * kTrackStep,
                                                                  static_cast<int>(std::lround(track[i].y)) + u));
        }
    }
    const auto at = [&](int u) { return centre[u]; };
    const auto mean = [&](int begin, int end) {
        double sum = 0;
        for (int u = begin; u <= end; ++u) {
            sum += at(u);
        }
        return sum / (end - begin + 1);
    };
    const double own = mean(-core, core);
    const auto edge = [&](int step) {
        const double side = step < 0 ? mean(-reach, -far) : mean(far, reach), level = 0.5 * (own + side);
        int u = 0;
        while (std::abs(u) < far && at(u) > level) {
            u += step;
        }
        return u == 0 || std::abs(u) == far ? 0.5 * guess : std::abs(u) - (level - at(u)) / (at(u - step) - at(u));
    };
    return std::max(1.0, edge(-1) + edge(1));
}

/// A stretch of the line, taken together.
struct LineStretch {
    double x = 0, y = 0, slope = 0;
    double sigma = 0;
    bool measured = false;
};

/// The middle of a stretch's sights, by medians along the track's slope, if half of them see the line.
LineStretch stretch_of(const std::vector<TrackPlace>& track, const std::vector<RidgeSight>& sights, std::size_t begin,
                       std::size_t end) {
    LineStretch stretch;
    stretch.x = 0.5 * kTrackStep * static_cast<double>(begin + end - 1);
    const auto n = static_cast<double>(end - begin);
    stretch.slope = end - begin > 1 ? (track[end - 1].y - track[begin].y) / (kTrackStep * (n - 1)) : track[begin].slope;
    std::vector<double> heights, off;
    for (std::size_t i = begin; i < end; ++i) {
        if (sights[i].seen && track[i].seen) {
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
    const double apart = 2 * std::sqrt(std::numbers::pi) * RidgeEye::sigma_of(track[begin].width);
    const double independent = std::max(1.0, kTrackStep * static_cast<double>(all.size()) / apart);
    stretch.sigma = std::max(kLeastSigma, kSigmaOfMedian * kMedianLoss * quantile(off, 0.5) / std::sqrt(independent));
    return stretch;
}

/// Marks as not measured what is off the line through its neighbours by more than chance.
void drop_strays(std::vector<LineStretch>& line) {
    constexpr std::size_t kReach = 5;
    constexpr double kLimit = 4;  // robust sigmas
    std::vector<double> off(line.size(), 0), sizes;
    for (std::size_t i = 0; i < line.size(); ++i) {
        std::vector<double> slopes, heights;
        const std::size_t begin = i > kReach ? i - kReach : 0, end = std::min(line.size(), i + kReach + 1);
        for (std::size_t a = begin; a < end; ++a) {
            for (std::size_t b = a + 1; b < end && line[a].measured; ++b) {
                if (line[b].measured && a != i && b != i) {
                    slopes.push_back((line[b].y - line[a].y) / (line[b].x - line[a].x));
                }
            }
        }
        const double slope = quantile(slopes, 0.5);  // Theil and Sen
        for (std::size_t a = begin; a < end; ++a) {
            if (line[a].measured && a != i) {
                heights.push_back(line[a].y - slope * (line[a].x - line[i].x));
            }
        }
        if (line[i].measured && heights.size() > 2) {
            off[i] = line[i].y - quantile(heights, 0.5);
            sizes.push_back(std::abs(off[i]));
        }
    }
    const double limit = std::max(1.0, kLimit * kSigmaOfMedian * quantile(sizes, 0.5));
    for (std::size_t i = 0; i < line.size(); ++i) {
        line[i].measured = line[i].measured && std::abs(off[i]) <= limit;
    }
}

/// How many times more the line scatters than the 1-sigma of its stretches says, at least 1: grains of rust and torn
/// edges are longer than a stretch. From third differences over every other one, which no bend of a seam reaches.
double scatter_beyond_sigma(const std::vector<LineStretch>& line) {
    constexpr std::size_t kLag = 2;
    constexpr double kGain2 = 20;  // 1 + 9 + 9 + 1
    std::vector<double> ratios;
    for (std::size_t i = 0; i + 3 * kLag < line.size(); ++i) {
        const LineStretch &a = line[i], &b = line[i + kLag], &c = line[i + 2 * kLag], &d = line[i + 3 * kLag];
        if (a.measured && b.measured && c.measured && d.measured) {
            const double sigma = 0.5 * (b.sigma + c.sigma);
            ratios.push_back(std::abs(a.y - 3 * b.y + 3 * c.y - d.y) / (std::sqrt(kGain2) * sigma));
        }
    }
    return ratios.size() < 5 ? 1 : std::max(1.0, kSigmaOfMedian * quantile(ratios, 0.5));
}

/// Fills stretches begin + 1 to end - 1 by the cubic that leaves both sides as they run there. Its 1-sigma holds how
/// far it is from the straight line: nothing says which of the two the seam follows.
void bridge(std::vector<LineStretch>& line, std::size_t begin, std::size_t end) {
    const auto slope_at = [&](std::size_t i, int step) {
        constexpr int kReach = 6;
        double n = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (int k = 0; k < kReach; ++k) {
            const std::size_t j = i + static_cast<std::size_t>(step * k);
            if (j >= line.size() || !line[j].measured) {
                break;
            }
            const double u = line[j].x - line[i].x;
            ++n, x += u, y += line[j].y, xx += u * u, xy += u * line[j].y;
        }
        const double spread = n * xx - x * x;
        return n > 2 && spread > 0 ? std::optional((n * xy - x * y) / spread) : std::nullopt;
    };
    const LineStretch a = line[begin], b = line[end];
    const double length = b.x - a.x, chord = (b.y - a.y) / length;
    const double from = slope_at(begin, -1).value_or(chord), to = slope_at(end, 1).value_or(chord);
    for (std::size_t i = begin + 1; i < end; ++i) {
        const double s = (line[i].x - a.x) / length;
        const double bow = length * s * (1 - s) * ((1 - s) * (from - chord) - s * (to - chord));
        line[i].y = a.y + s * (b.y - a.y) + bow;
        line[i].slope = chord;
        line[i].sigma = std::hypot((1 - s) * a.sigma + s * b.sigma, bow);
    }
}

/// Cuts off what is not measured at the ends and bridges it elsewhere.
void close_gaps(std::vector<LineStretch>& line) {
    const auto measured = [](const LineStretch& stretch) { return stretch.measured; };
    line.erase(line.begin(), std::find_if(line.begin(), line.end(), measured));
    line.erase(std::find_if(line.rbegin(), line.rend(), measured).base(), line.end());
    for (std::size_t i = 0; i + 1 < line.size();) {
        std::size_t next = i + 1;
        while (!line[next].measured) {
            ++next;
        }
        bridge(line, i, next);
        i = next;
    }
}

}  // namespace

std::vector<PhotoPoint> measure_line(const GreyImage& image, std::vector<TrackPlace> track) {
    RidgeEye eye(image);
    std::vector<RidgeSight> sights;
    std::vector<double> widths;
    for (std::size_t i = 0; i < track.size(); ++i) {
        widths.push_back(width_of_profile(image, track, i));
    }
    for (std::size_t i = 0; i < track.size(); ++i) {
        track[i].width = widths[i];
    }
    for (std::size_t i = 0; i < track.size(); ++i) {
        sights.push_back(eye.look(track[i], static_cast<int>(i) * kTrackStep));
    }
    constexpr double kLeastStretch = 8;  // px
    const double stretch_px = std::max(kLeastStretch, 4 * RidgeEye::sigma_of(quantile(widths, 0.5)));
    const auto step = static_cast<std::size_t>(std::lround(stretch_px / kTrackStep));
    std::vector<LineStretch> line;
    const std::size_t count = std::max<std::size_t>(1, track.size() / step);
    for (std::size_t i = 0; i < count; ++i) {
        line.push_back(stretch_of(track, sights, i * track.size() / count, (i + 1) * track.size() / count));
    }
    drop_strays(line);
    const double extra = scatter_beyond_sigma(line);
    for (LineStretch& stretch : line) {
        stretch.sigma *= extra;
    }
    close_gaps(line);
    std::vector<PhotoPoint> points;
    for (const LineStretch& s : line) {
        const Vector2d normal = Vector2d(-s.slope, 1).normalized();
        points.push_back({{s.x, s.y}, normal, s.sigma * normal.y(), !s.measured});
    }
    return points;
}

}  // namespace seampath::detail
