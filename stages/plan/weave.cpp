#include "stages/plan/weave.hpp"

#include <algorithm>
#include <cmath>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/plan/text.hpp"

namespace seampath::planning {
namespace {

using Eigen::Vector3d;

// What a swing's moves may be off it, as a share of the chord tolerance; the seam's own has the rest.
constexpr double kWeaveShare = 0.5;

// In units of the amplitude: across, and along where it goes there.
struct Swing {
    double along, across, up;
};
Swing swing(WeaveShape shape, double phase, double half_opening) {
    const double phi = kTurn * phase, out = std::min(1 / std::tan(half_opening), 1e3);
    switch (shape) {
        case WeaveShape::sine:
            return {0, std::sin(phi), 0};
        case WeaveShape::zigzag:
            return {0, phase < 0.25 ? 4 * phase : phase < 0.75 ? 2 - 4 * phase : 4 * phase - 4, 0};
        case WeaveShape::triangle:
            return phase < 1.0 / 3   ? Swing{0, 3 * phase, 3 * phase * out}
                   : phase < 2.0 / 3 ? Swing{0, 3 - 6 * phase, out}
                                     : Swing{0, 3 * phase - 3, 3 * (1 - phase) * out};
        case WeaveShape::circle:
            return {std::cos(phi) - 1, std::sin(phi), 0};
        case WeaveShape::figure_eight:
            return {0.5 * std::sin(2 * phi), std::sin(phi), 0};
        case WeaveShape::none:
            break;
    }
    return {0, 0, 0};
}

// Largest second derivative by phase, in units of the amplitude; 0 for straight lines.
double bend(WeaveShape shape) {
    return shape == WeaveShape::sine || shape == WeaveShape::circle ? kTurn * kTurn
           : shape == WeaveShape::figure_eight                      ? std::sqrt(5.0) * kTurn * kTurn
                                                                    : 0;
}

}  // namespace

Weave::Weave(const TorchPath& path, const PlanOptions& o) : options_(o) {
    const double asked = o.weave_frequency_hz ? o.speed_mm_s / *o.weave_frequency_hz : o.weave_pitch_mm;
    const double length = path.arc().length();
    if (length < 0.5 * asked) {
        throw InputError(seam_text(path.seam()) + " is welded over " + number(length) +
                         " mm at a time, less than half of a swing of " + number(asked) +
                         " mm; a shorter plan.weave_pitch_mm or a longer weld is needed");
    }
    const double swings = std::max(1.0, std::round(length / asked));
    pitch_ = length / swings;
    dwell_ = std::min(0.49, o.weave_dwell_s * o.speed_mm_s / pitch_);
    side_ = o.weave == WeaveShape::triangle ? 1.0 / 3 : 0.25;
    std::vector<double> phases{side_, 1 - side_};
    const double curve = bend(o.weave) * o.weave_amplitude_mm / 8;
    const double pieces = 4 * std::max(1.0, std::ceil(0.25 * std::sqrt(curve / (kWeaveShare * o.chord_tolerance_mm))));
    error_ = curve / (pieces * pieces);
    for (double k = 0; k < pieces && curve > 0; ++k) {
        phases.push_back(k / pieces);
    }
    phases.push_back(0);
    std::vector<double> shares;
    for (const double f : phases) {
        shares.push_back(share(f));
        if (dwell_ > 0 && (f == side_ || f == 1 - side_)) {
            shares.push_back(share(f) + dwell_);
        }
    }
    std::sort(shares.begin(), shares.end());
    shares.erase(std::unique(shares.begin(), shares.end()), shares.end());
    for (double k = 0; k < swings; ++k) {
        for (const double part : shares) {
            stations_.push_back((k + part) * pitch_);
        }
    }
    stations_.push_back(length);
}

// Of a swing's way along the seam that has gone by before a phase is reached.
double Weave::share(double f) const {
    return f * (1 - 2 * dwell_) + (f > side_ ? dwell_ : 0) + (f > 1 - side_ ? dwell_ : 0);
}

double Weave::phase(double part) const {
    const double moving = 1 - 2 * dwell_, first = side_ * moving, second = (1 - side_) * moving + dwell_;
    return part <= first             ? part / moving
           : part <= first + dwell_  ? side_
           : part <= second          ? (part - dwell_) / moving
           : part <= second + dwell_ ? 1 - side_
                                     : (part - 2 * dwell_) / moving;
}

Vector3d Weave::offset(const TorchPath& path, const TorchPose& pose) const {
    const double swings = pose.station_mm / pitch_, part = swings - std::floor(swings);
    const double psi = options_.weave == WeaveShape::triangle ? path.half_opening(pose.u, pose.station_mm) : kTurn / 4;
    const Swing off = swing(options_.weave, std::clamp(phase(part), 0.0, 1.0), psi);
    return options_.weave_amplitude_mm * Vector3d(off.along, off.across, -off.up);
}

}  // namespace seampath::planning
