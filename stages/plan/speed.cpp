#include "stages/plan/speed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/gauss_legendre.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/text.hpp"

namespace seampath::planning {
namespace {

// Cells in which the limits are looked at, and how many of them at least a change of speed is spread over.
constexpr int kSpeedCells = 2000, kCellsOfChange = 8;

// A speed that falls by less than this share is kept.
constexpr double kSameSpeed = 1e-12;

// Moves over a change of speed, from rest to full speed.
constexpr double kSpeedSteps = 8;

constexpr int kIterations = 100;

// The samples of a seam come near a limit: they tell the turn of the torch between them only, and the bend at the ends
// of each span, where c'' is largest.
constexpr double kNear = 0.75;

double half_square(double v) {
    return 0.5 * v * v;
}

// The largest w in each cell; the path beyond its ends is as at them.
std::vector<double> ceiling_of(const TorchPath& path, const PlanOptions& o, int count, double step) {
    std::vector<double> ceiling;
    TorchPose from = path.at_station(0);
    for (int k = 0; k < count; ++k) {
        const double end = std::min((k + 1) * step, path.arc().length()), way = end - from.station_mm;
        const TorchPose to = path.at_station(end), middle = path.at_station(from.station_mm + 0.5 * way);
        double w = half_square(o.speed_mm_s);
        for (const double u : {from.u, middle.u, to.u}) {
            const double bend = curvature(path.arc().curve(), u);
            w = bend * 2 * w > o.centripetal_mm_s2 ? 0.5 * o.centripetal_mm_s2 / bend : w;
        }
        const double turn = std::max(rotation_angle(from.q, middle.q), rotation_angle(middle.q, to.q));
        const double most = o.turn_rate_deg_s * kDegree * 0.5 * way;
        w = turn * std::sqrt(2 * w) > most ? half_square(most / turn) : w;
        ceiling.push_back(w);
        from = to;
    }
    return ceiling;
}

// Whether the speed may have to fall anywhere.
bool near_limits(const TorchPath& path, const Samples& samples, const PlanOptions& o) {
    for (std::size_t k = 0; k < samples.pose.size(); ++k) {
        const TorchPose& to = samples.pose[k];
        if (curvature(path.arc().curve(), to.u) * o.speed_mm_s * o.speed_mm_s > kNear * o.centripetal_mm_s2) {
            return true;
        }
        if (k > 0 && rotation_angle(samples.pose[k - 1].q, to.q) * o.speed_mm_s >
                         kNear * o.turn_rate_deg_s * kDegree * (to.station_mm - samples.pose[k - 1].station_mm)) {
            return true;
        }
    }
    return false;
}

}  // namespace

Ramp::Ramp(double speed, double acceleration, double jerk) : speed_(speed), jerk_(jerk) {
    const bool reached = speed * jerk >= acceleration * acceleration;
    rise_ = reached ? acceleration / jerk : std::sqrt(speed / jerk);
    duration_ = speed > 0 ? speed / (jerk * rise_) + rise_ : 0;
}

double Ramp::way(double t) const {
    const double left = duration_ - t, first = jerk_ * rise_ * rise_ / 2;
    return t <= rise_      ? jerk_ * t * t * t / 6
           : left <= rise_ ? length() - speed_ * left + jerk_ * left * left * left / 6
                           : first * rise_ / 3 + (t - rise_) * (first + jerk_ * rise_ * (t - rise_) / 2);
}

double Ramp::speed(double t) const {
    const double left = duration_ - t;
    return t <= rise_      ? jerk_ * t * t / 2
           : left <= rise_ ? speed_ - jerk_ * left * left / 2
                           : jerk_ * rise_ * (t - 0.5 * rise_);
}

double Ramp::acceleration(double t) const {
    return jerk_ * std::max(0.0, std::min({t, duration_ - t, rise_}));
}

// Newton's method, kept between bounds by bisection.
double Ramp::time(double way_mm) const {
    double low = 0, high = duration_;
    double t = std::min(std::cbrt(6 * way_mm / jerk_), duration_);
    for (int i = 0; i < kIterations; ++i) {
        const double off = way(t) - way_mm, v = speed(t);
        (off > 0 ? high : low) = t;
        double next = v > 0 ? t - off / v : 0.5 * (low + high);
        next = next < low || next > high ? 0.5 * (low + high) : next;
        if (std::abs(next - t) <= 1e-16 * duration_) {
            return next;
        }
        t = next;
    }
    return t;
}

SpeedProfile::SpeedProfile(const TorchPath& path, const Samples& samples, const PlanOptions& o)
    : length_(path.arc().length()), speed_(o.speed_mm_s), run_in_(0, 1, 1), run_out_(0, 1, 1) {
    const Ramp ramp(o.speed_mm_s, o.acceleration_mm_s2, o.jerk_mm_s3);
    if (o.run_in == RunIn::within && 2 * ramp.length() > length_) {
        throw InputError(seam_text(path.seam()) + " is welded over " + number(length_) +
                         " mm at a time, and its run-in and run-out take " + number(2 * ramp.length()) +
                         " mm; a longer weld is needed, a lower plan.speed_mm_s, a higher plan.acceleration_mm_s2 and "
                         "plan.jerk_mm_s3, or plan.run_in = none");
    }
    cells_ = {{0, half_square(o.speed_mm_s), 0, 0, 0}};
    if (near_limits(path, samples, o)) {
        slow_down(path, o);
    }
    if (o.run_in == RunIn::within) {
        run_in_ = Ramp(std::sqrt(2 * cells_.front().w), o.acceleration_mm_s2, o.jerk_mm_s3);
        run_out_ = Ramp(std::sqrt(2 * cells_.back().w), o.acceleration_mm_s2, o.jerk_mm_s3);
    }
}

void SpeedProfile::slow_down(const TorchPath& path, const PlanOptions& o) {
    const double w = half_square(o.speed_mm_s);
    std::vector<double> ceiling = ceiling_of(path, o, kSpeedCells, length_ / kSpeedCells);
    const double fall = w - *std::min_element(ceiling.begin(), ceiling.end());
    if (fall <= kSameSpeed * w) {
        return;
    }
    const double reach = std::max(fall / o.acceleration_mm_s2, std::sqrt(2 * fall * o.speed_mm_s / o.jerk_mm_s3));
    // Even, so that both boxes that make the triangle end between cells.
    const int half =
        2 *
        static_cast<int>(std::ceil(std::max(0.5 * kCellsOfChange, 0.5 * kSpeedCells * std::min(1.0, reach / length_))));
    const double step = std::max(reach / half, length_ / kSpeedCells);
    ceiling = ceiling_of(path, o, static_cast<int>(std::ceil(length_ / step)), step);
    if (o.run_in == RunIn::within) {  // one speed for as long as run-in and run-out take
        const double ramp = Ramp(o.speed_mm_s, o.acceleration_mm_s2, o.jerk_mm_s3).length();
        const std::ptrdiff_t ends = static_cast<std::ptrdiff_t>(std::ceil(ramp / step)) + 2 * std::ptrdiff_t{half} + 1;
        const std::ptrdiff_t whole = std::ssize(ceiling), part = 2 * ends < whole ? ends : whole;
        std::fill_n(ceiling.begin(), part, *std::min_element(ceiling.begin(), ceiling.begin() + part));
        std::fill_n(ceiling.rbegin(), part, *std::min_element(ceiling.rbegin(), ceiling.rbegin() + part));
    }
    cells_.clear();
    smooth(ceiling, step, half);
}

void SpeedProfile::smooth(const std::vector<double>& ceiling, double step, int half) {
    const int count = static_cast<int>(ceiling.size());
    const auto inside = [count](int k) { return static_cast<std::size_t>(std::clamp(k, 0, count - 1)); };
    std::vector<double> least;  // within +-half cells
    for (int k = 0; k < count; ++k) {
        const auto first = ceiling.begin() + static_cast<std::ptrdiff_t>(inside(k - half));
        least.push_back(*std::min_element(first, ceiling.begin() + static_cast<std::ptrdiff_t>(inside(k + half)) + 1));
    }
    // The mean over `half` cells, at every node from half / 2 before the first to half / 2 behind the last.
    std::vector<double> once;
    for (int node = -half / 2; node <= count + half / 2; ++node) {
        double sum = 0;
        for (int k = node - half / 2; k < node + half / 2; ++k) {
            sum += least[inside(k)];
        }
        once.push_back(sum / half);
    }
    double time = 0;
    double slope = (once[static_cast<std::size_t>(half)] - once[0]) / (half * step);
    for (int k = 0; k < count; ++k) {
        const auto first = static_cast<std::size_t>(k), last = first + static_cast<std::size_t>(half);
        double twice = 0.5 * (once[first] + once[last]);
        for (std::size_t i = first + 1; i < last; ++i) {
            twice += once[i];
        }
        const double next = (once[last + 1] - once[first + 1]) / (half * step);
        Cell made{k * step, twice / half, slope, (next - slope) / step, time};
        slope = next;
        if (std::max(std::abs(made.slope), std::abs(next)) * step <= kSameSpeed * made.w) {
            made.slope = made.bend = 0;
            made.w = std::abs(made.w - half_square(speed_)) <= kSameSpeed * made.w ? half_square(speed_) : made.w;
        }
        time += cell_time(made, step);
        const bool goes_on = !cells_.empty() && cells_.back().constant() && made.constant() &&
                             std::abs(cells_.back().w - made.w) <= kSameSpeed * made.w;
        if (!goes_on) {
            cells_.push_back(made);
        }
    }
}

const SpeedProfile::Cell& SpeedProfile::cell(double station) const {
    const auto above =
        std::upper_bound(cells_.begin() + 1, cells_.end(), station, [](double s, const Cell& c) { return s < c.from; });
    return *(above - 1);
}

double SpeedProfile::cell_time(const Cell& cell, double tau) const {
    if (cell.constant()) {
        return tau / (cell.w == half_square(speed_) ? speed_ : std::sqrt(2 * cell.w));
    }
    return gauss_legendre([&cell](double at) { return 1 / std::sqrt(2 * cell.at(at)); }, 0.0, tau);
}

double SpeedProfile::inner_time(double station) const {
    const Cell& in = cell(station);
    return in.time + cell_time(in, station - in.from);
}

double SpeedProfile::speed(double station) const {
    if (station < run_in_.length()) {
        return run_in_.speed(run_in_.time(station));
    }
    if (length_ - station < run_out_.length()) {
        return run_out_.speed(run_out_.time(std::max(0.0, length_ - station)));
    }
    const Cell& in = cell(station);
    return in.constant() && in.w == half_square(speed_) ? speed_ : std::sqrt(2 * in.at(station - in.from));
}

double SpeedProfile::acceleration(double station) const {
    if (station < run_in_.length()) {
        return run_in_.acceleration(run_in_.time(station));
    }
    if (length_ - station < run_out_.length()) {
        return -run_out_.acceleration(run_out_.time(std::max(0.0, length_ - station)));
    }
    const Cell& in = cell(station);
    return in.slope + in.bend * (station - in.from);
}

double SpeedProfile::time(double station) const {
    const double late = run_in_.duration() - inner_time(run_in_.length());
    if (station < run_in_.length()) {
        return run_in_.time(station);
    }
    if (length_ - station < run_out_.length()) {
        const double begin = late + inner_time(length_ - run_out_.length());
        return begin + run_out_.duration() - run_out_.time(std::max(0.0, length_ - station));
    }
    return late + inner_time(station);
}

double SpeedProfile::station(double t) const {
    double low = 0, high = length_, s = std::clamp(t / duration(), 0.0, 1.0) * length_;
    for (int i = 0; i < kIterations && high - low > 1e-13 * length_; ++i) {
        const double off = time(s) - t, v = speed(s);
        (off > 0 ? high : low) = s;
        double next = s - off * v;
        next = !(next > low && next < high) ? 0.5 * (low + high) : next;
        if (std::abs(next - s) <= 1e-14 * length_) {
            return next;
        }
        s = next;
    }
    return s;
}

double SpeedProfile::move_speed(double from, double to) const {
    double a = std::max(from, run_in_.length()), b = std::min(to, length_ - run_out_.length());
    if (b <= a) {
        a = from;
        b = to;
    }
    const double mean = (b - a) / (time(b) - time(a));
    return std::abs(mean - speed_) <= 1e-9 * speed_ ? speed_ : mean;
}

std::vector<double> SpeedProfile::telling() const {
    constexpr int kMoments = 16;  // even: the acceleration is largest half way
    std::vector<double> stations = changes();
    for (int k = 1; k <= kMoments; ++k) {
        const double share = static_cast<double>(k) / kMoments;
        stations.push_back(run_in_.way(share * run_in_.duration()));
        stations.push_back(length_ - run_out_.way(share * run_out_.duration()));
    }
    std::sort(stations.begin(), stations.end());
    return stations;
}

std::vector<double> SpeedProfile::changes() const {
    std::vector<double> stations;
    double told = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < cells_.size(); ++k) {
        const double v = std::sqrt(2 * cells_[k].w);
        const bool border = k > 0 && cells_[k].constant() != cells_[k - 1].constant();
        if (k > 0 && (border || std::abs(v - told) > speed_ / kSpeedSteps)) {
            stations.push_back(cells_[k].from);
            told = v;
        }
        told = k == 0 ? v : told;
    }
    return stations;
}

}  // namespace seampath::planning
