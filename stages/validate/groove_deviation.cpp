#include "stages/validate/groove_deviation.hpp"

#include <algorithm>
#include <optional>

#include "stages/geometry/groove_section.hpp"
#include "stages/geometry/parallel.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// At a station of the model: h between the bevels' normals.
GrooveFrame frame_at(const SeamModel& model, const ArcLength& arc, double station, const FlankSample& flanks,
                     const Vector3d& origin) {
    const double step = 1e-3 * arc.length();
    const auto at = [&](double s) { return position(model.curve, arc.parameter(s)); };
    const double low = std::max(0.0, station - step), high = std::min(arc.length(), station + step);
    GrooveFrame frame;
    frame.p = at(station) - origin;
    frame.t = (at(high) - at(low)).normalized();
    const Vector3d up = (flanks.n1.normalized() + flanks.n2.normalized());
    frame.up = (up - up.dot(frame.t) * frame.t).normalized();
    // By a span long enough for the bend and short against it.
    const double span = std::min(10.0, 0.25 * arc.length());
    const double middle = std::clamp(station, span, arc.length() - span);
    frame.bend = (at(middle - span) - 2 * at(middle) + at(middle + span)) / (span * span);
    frame.bend -= frame.bend.dot(frame.t) * frame.t;
    return frame;
}

}  // namespace

void measure_groove_samples(const SeamModel& model, const ArcLength& arc, const Vector3d& origin, const PointGrid& grid,
                            std::span<const std::size_t> view_starts, const ScanScale& scale,
                            std::vector<DeviationSample>& samples, std::vector<double> (&density)[2]) {
    constexpr double kAround = 4;  // mm of the groove that tell its shape, each way
    const GrooveWindow window = groove_window(measuring_window(scale)), around{kAround, kAround, 0, 0};
    std::vector<std::optional<GrooveFit>> measured(samples.size());
    parallel_for(samples.size(), 4, [&](std::size_t i) {
        const double station = samples[i].station_mm;
        const FlankSample flanks = flanks_at(model, station);
        const GrooveFrame frame = frame_at(model, arc, station, flanks, origin);
        const auto in_section = [&](const Vector3d& n) {
            return Vector2d(n.dot(frame.left()), n.dot(frame.up)).normalized();
        };
        const auto inside = [&](const GrooveWindow& whole) {
            return model.closed ? whole : near_ends(whole, station, arc.length() - station);
        };
        const GrooveWindow near = inside(around);
        const auto shape =
            shape_about(grid, scale, frame, {in_section(flanks.n1), in_section(flanks.n2)}, near.back, near.ahead);
        if (shape) {
            measured[i] = fit_groove(grid, view_starts, scale, frame, *shape, inside(window), 3);
        }
    });
    std::vector<GrooveFit> fits;
    std::vector<std::size_t> of;
    for (std::size_t i = 0; i < measured.size(); ++i) {
        if (measured[i]) {
            fits.push_back(std::move(*measured[i]));
            of.push_back(i);
        }
    }
    const auto root = pool_roots(fits, arc.length() / static_cast<double>(samples.size()), 2 * window.back);
    for (std::size_t j = 0; root && j < fits.size(); ++j) {
        const auto numbers = numbers_of(fits[j], *root);
        if (numbers) {
            DeviationSample& sample = samples[of[j]];
            sample.distance_mm = numbers->root().norm();
            sample.flank1_mm = -numbers->normal[0].dot(numbers->root());
            sample.flank2_mm = -numbers->normal[1].dot(numbers->root());
            sample.sigma_mm = numbers->sigma(0);
            sample.covered = true;
            density[0][of[j]] = fits[j].density[0];
            density[1][of[j]] = fits[j].density[1];
        }
    }
}

}  // namespace seampath::detail
