#include <algorithm>
#include <cmath>

#include "stages/geometry/bspline.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/validate/validate.hpp"
#include "stages/validate/verdict.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPhotoTolerance = 0.1;  // mm; as of a scan: tracking accuracy that arc welding asks of a path
constexpr int kSampleSteps = 2;          // of a profile, a px

/// Grey values across the seam at one station, means over some length along it.
struct CrossProfile {
    std::vector<double> grey;  ///< from -reach to reach
    double mm_per_px = 0;      ///< across the seam
};

double interpolated(const GreyImage& image, const Vector2d& p) {
    const double c = std::floor(p.x()), r = std::floor(p.y()), x = p.x() - c, y = p.y() - r;
    const auto at = [&](int i, int j) {
        return static_cast<double>(image.clamped(static_cast<int>(c) + i, static_cast<int>(r) + j));
    };
    return (1 - y) * ((1 - x) * at(0, 0) + x * at(1, 0)) + y * ((1 - x) * at(0, 1) + x * at(1, 1));
}

CrossProfile profile_at(const PhotoView& view, const Vector3d& p, const Vector3d& along, int reach_px) {
    constexpr int kHalfLength = 6;  // px along the seam
    const auto seen = [&](const Vector3d& q) { return pixel_of(view.camera, view.camera_from_plane * q); };
    const Vector2d middle = seen(p);
    const Vector2d t = (seen(p + 0.5 * along) - seen(p - 0.5 * along)).normalized(), n(-t.y(), t.x());
    CrossProfile profile;
    profile.mm_per_px = (point_on_plane(view.camera, view.camera_from_plane, middle + 0.5 * n) -
                         point_on_plane(view.camera, view.camera_from_plane, middle - 0.5 * n))
                            .norm();
    for (int i = -reach_px * kSampleSteps; i <= reach_px * kSampleSteps; ++i) {
        double sum = 0;
        for (int k = -kHalfLength; k <= kHalfLength; ++k) {
            sum += interpolated(view.image, middle + n * (static_cast<double>(i) / kSampleSteps) + t * k);
        }
        profile.grey.push_back(sum / (2 * kHalfLength + 1));
    }
    return profile;
}

/// A line in a profile, in samples of it.
struct ProfileBar {
    double contrast = -1;  ///< of its own grey from that of the side that is more like it
    double middle = 0;
};

/// The middle of the two edges of a dark (sign -1) or bright (1) line of about `width` samples, near the model: where
/// the grey is half way between the line's own and that of its side. No edge is used for the other's place.
ProfileBar bar_in(const std::vector<double>& grey, int width, double sign) {
    const int n = static_cast<int>(grey.size()), half = n / 2, reach = width;
    const auto value = [&](int i) { return sign * grey[static_cast<std::size_t>(i)]; };
    const auto mean = [&](int begin, int end) {
        double sum = 0;
        for (int i = begin; i < end; ++i) {
            sum += value(i);
        }
        return sum / (end - begin);
    };
    ProfileBar best;
    for (int middle = half - reach; middle <= half + reach; ++middle) {
        const int begin = middle - width / 2, end = begin + width;
        if (begin - width < 0 || end + width > n) {
            continue;
        }
        const double own = mean(begin + width / 4, end - width / 4), left = mean(begin - width, begin - width / 4);
        const double right = mean(end + width / 4, end + width), contrast = own - std::max(left, right);
        if (contrast <= best.contrast) {
            continue;
        }
        const auto edge = [&](double side, int step) {
            const double level = 0.5 * (own + side);
            int i = middle;
            while (i + step > 0 && i + step < n - 1 && value(i) > level) {
                i += step;
            }
            const double inner = value(i - step), outer = value(i);
            return inner > outer ? i - step + step * (inner - level) / (inner - outer) : static_cast<double>(i);
        };
        best = {contrast, 0.5 * (edge(left, -1) + edge(right, 1))};
    }
    return best;
}

/// Median contrast along the seam of lines of one width and kind.
double usual_contrast(const std::vector<CrossProfile>& profiles, int width, double sign) {
    std::vector<double> contrasts;
    for (const CrossProfile& profile : profiles) {
        contrasts.push_back(bar_in(profile.grey, width, sign).contrast);
    }
    return quantile(contrasts, 0.5);
}

/// Robust 1-sigma of what neighbours differ by, as of single values.
double scatter_of(const std::vector<double>& values) {
    std::vector<double> steps;
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
        steps.push_back(std::abs(values[i] - 0.5 * (values[i - 1] + values[i + 1])));
    }
    return 1.4826 * quantile(steps, 0.5) / std::sqrt(1.5);
}

int width_of_line(const std::vector<CrossProfile>& profiles, int widest) {
    double most = 0;
    int best = 4;
    for (int width = 4; width <= widest; width = width * 5 / 4 + 1) {
        // Wide windows average more texture away; the narrowest line that is as clear is the line itself.
        const double contrast = std::max(usual_contrast(profiles, width, -1), usual_contrast(profiles, width, 1));
        if (contrast > 1.1 * most) {
            most = contrast;
            best = width;
        }
    }
    return best;
}

}  // namespace

Deviation validate(const SeamModel& model, const PhotoView& view, const ValidateOptions& options) {
    constexpr double kStep = 16;       // px between stations: beyond what profiles share
    constexpr int kReach = 60;         // px
    constexpr int kWidest = 40;        // samples
    constexpr double kLeastClear = 5;  // grey values: JPEG alone makes steps of some
    const ArcLength arc(model.curve);
    const Vector3d start = position(model.curve, arc.parameter(0)),
                   end = position(model.curve, arc.parameter(arc.length()));
    const auto seen = [&](const Vector3d& p) { return pixel_of(view.camera, view.camera_from_plane * p); };
    const auto count = static_cast<std::size_t>(std::max(8.0, (seen(end) - seen(start)).norm() / kStep));
    Deviation result;
    std::vector<CrossProfile> profiles;
    for (std::size_t i = 0; i < count; ++i) {
        DeviationSample sample;
        sample.station_mm = arc.length() * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        sample.p = position(model.curve, arc.parameter(sample.station_mm));
        result.samples.push_back(sample);
        profiles.push_back(profile_at(view, sample.p, tangent(model.curve, arc.parameter(sample.station_mm)), kReach));
    }
    const int width = width_of_line(profiles, kWidest);
    std::vector<double> offs;
    for (std::size_t i = 0; i < count; ++i) {
        const ProfileBar dark = bar_in(profiles[i].grey, width, -1), bright = bar_in(profiles[i].grey, width, 1);
        const ProfileBar& bar = dark.contrast > bright.contrast ? dark : bright;
        DeviationSample& sample = result.samples[i];
        const double off = (bar.middle - kReach * kSampleSteps) / kSampleSteps * profiles[i].mm_per_px;
        sample.flank1_mm = sample.flank2_mm = 0;  // a photograph shows no heights
        sample.distance_mm = std::abs(off);
        sample.covered = bar.contrast > kLeastClear && !flanks_at(model, sample.station_mm).modelled;
        if (sample.covered) {
            offs.push_back(off);
        }
    }
    const double sigma = scatter_of(offs);
    for (DeviationSample& sample : result.samples) {
        sample.sigma_mm = sigma;
    }
    result.tolerance_mm =
        options.tolerance_mm > 0 ? options.tolerance_mm : std::max(kPhotoTolerance, detail::kNoiseTolerance * sigma);
    detail::summarise(result, options);
    return result;
}

}  // namespace seampath
