#pragma once

#include <vector>

#include "stages/plan/chord.hpp"
#include "stages/plan/torch.hpp"

/// Private to the plan stage: how fast the torch is at any place of one seam, and when it is there.
namespace seampath::planning {

/// From rest to a speed with limited acceleration and jerk: the jerk is +j, 0, -j, and the acceleration at most a
/// (seven-phase profile, first half; e.g. Biagiotti & Melchiorri, Trajectory Planning for Automatic Machines, 3.4).
/// It takes T = v / a + a / j, or 2 sqrt(v / j) where a is not reached, over v T / 2.
class Ramp {
public:
    Ramp(double speed_mm_s, double acceleration_mm_s2, double jerk_mm_s3);
    double duration() const { return duration_; }
    double length() const { return 0.5 * speed_ * duration_; }
    double way(double time) const;    ///< mm since rest; time in 0..duration
    double speed(double time) const;  ///< mm/s
    double acceleration(double time) const;
    double time(double way) const;  ///< the inverse of way()

private:
    double speed_, jerk_, rise_, duration_;  ///< rise: time in which the acceleration grows
};

/// Speed along a seam: plan.speed_mm_s; less where v^2 kappa would exceed plan.centripetal_mm_s2 or the torch would
/// turn by more than plan.turn_rate_deg_s; from rest and to rest at the ends where plan.run_in is `within`.
///
/// With w = v^2 / 2 the acceleration along the seam is w' and the jerk v w'' (primes: by station). The lowest w that
/// the limits ask for within +-h is smoothed by a triangle of half width h, so that it is nowhere above what the limits
/// allow, |w'| <= R / h and |w''| <= 2 R / h^2 where R is by how much w must fall; h is the least at which these are
/// within plan.acceleration_mm_s2 and plan.jerk_mm_s3 / plan.speed_mm_s. w is quadratic on each of equal cells, and the
/// time the integral of ds / v: closed form where v is constant and in the ramps, else eight-point Gauss-Legendre sums
/// over cells in which v hardly changes, exact to rounding. The limits are looked at in 2000 cells, where the samples
/// of the seam come near them.
class SpeedProfile {
public:
    /// Throws InputError for a seam shorter than its run-in and run-out.
    SpeedProfile(const TorchPath& path, const Samples& samples, const PlanOptions& options);

    double length() const { return length_; }
    double duration() const { return time(length_); }
    double speed(double station) const;
    double acceleration(double station) const;  ///< along the seam, mm/s^2
    double time(double station) const;          ///< s since the start; to about 1e-13 of the duration
    double station(double time) const;          ///< the inverse, to 1e-10 mm

    /// What to command for the move from one station to another: its mean speed, run-in and run-out left out.
    double move_speed(double from, double to) const;

    /// Stations between which the speed between run-in and run-out changes by no more than an eighth of the largest:
    /// where it begins to change, and on the way.
    std::vector<double> changes() const;

    /// Stations that show how the torch gets to its speed and comes to rest: at equal times of run-in and run-out, that
    /// of the largest acceleration among them; and those of changes(). Ascending.
    std::vector<double> telling() const;

private:
    struct Cell {
        double from;            // station
        double w, slope, bend;  // w at tau = station - from is w + slope tau + bend tau^2 / 2
        double time;            // at `from`, as if there was no run-in
        bool constant() const { return slope == 0 && bend == 0; }
        double at(double tau) const { return w + tau * (slope + 0.5 * bend * tau); }
    };
    void slow_down(const TorchPath& path, const PlanOptions& options);
    void smooth(const std::vector<double>& ceiling, double step, int half);
    const Cell& cell(double station) const;
    double cell_time(const Cell& cell, double tau) const;
    double inner_time(double station) const;

    double length_, speed_;
    Ramp run_in_, run_out_;
    std::vector<Cell> cells_;
};

}  // namespace seampath::planning
