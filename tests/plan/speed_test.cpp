#include "stages/plan/speed.hpp"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/plan.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace speed_test {

using planning::Ramp;
using planning::SpeedProfile;
using planning::TorchPath;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Integral by tanh-sinh quadrature in long double (Takahasi & Mori 1974), which bears 1 / sqrt at an end.
template <class F>
long double integral(const F& f, long double a, long double b) {
    const long double half = 0.5L * (b - a), h = 1.0L / 64;
    long double sum = 0;
    for (int k = -256; k <= 256; ++k) {
        const long double t = k * h, u = 0.5L * M_PIl * std::sinh(t);
        const long double weight = 0.5L * M_PIl * std::cosh(t) / (std::cosh(u) * std::cosh(u));
        const long double x = half * std::tanh(u);
        if (half - std::abs(x) > 1e-17L * half && weight > 0) {
            sum += weight * f(0.5L * (a + b) + x);
        }
    }
    return h * half * sum;
}

SpeedProfile profile_of(const SeamModel& model, const PlanOptions& options) {
    const TorchPath path(model, 0, options);
    return {path, planning::sample(path, options.chord_tolerance_mm), options};
}

/// Fast over bends: the speed falls there.
PlanOptions fast() {
    PlanOptions options;
    options.speed_mm_s = 120;
    options.centripetal_mm_s2 = 300;
    options.acceleration_mm_s2 = 400;
    options.jerk_mm_s3 = 4000;
    return options;
}

// Phases by hand: v = 50, a = 100, j = 400: the acceleration grows for 0.25 s, is held for 0.25 s, falls for 0.25 s.
TEST(Ramp, IsThatOfThreePhases) {
    const Ramp ramp(50, 100, 400);
    EXPECT_NEAR(ramp.duration(), 0.75, 1e-15);
    EXPECT_NEAR(ramp.length(), 18.75, 1e-13);
    EXPECT_NEAR(ramp.speed(0.25), 12.5, 1e-13);
    EXPECT_NEAR(ramp.speed(0.5), 37.5, 1e-13);
    EXPECT_NEAR(ramp.way(0.25), 400.0 / 384, 1e-13);
    EXPECT_NEAR(ramp.way(0.75), 18.75, 1e-13);
    EXPECT_NEAR(ramp.acceleration(0.3), 100, 1e-13);
    const Ramp gentle(8, 500, 5000);  // never reaches 500 mm/s2
    EXPECT_NEAR(gentle.duration(), 2 * std::sqrt(8 / 5000.0), 1e-15);
    for (const Ramp& r : {ramp, gentle}) {
        double way = 0;
        const int steps = 40000;
        for (int k = 0; k < steps; ++k) {
            const double t = r.duration() * (k + 0.5) / steps, dt = r.duration() / steps;
            way += r.speed(t) * dt;
            EXPECT_NEAR(r.way(t + 0.5 * dt), way, 1e-6 * r.length());
            if (k % 100 == 0) {
                EXPECT_NEAR(r.time(r.way(t)), t, 1e-12);
            }
        }
    }
}

TEST(SpeedProfile, IsConstantWhereNothingAsksForLess) {
    PlanOptions options;
    options.speed_mm_s = 8.5;
    const SeamModel m = test::model_of(test::helix(35, 30), false, 120);
    const SpeedProfile profile = profile_of(m, options);
    for (int k = 0; k <= 1000; ++k) {
        const double s = m.length_mm * k / 1000;
        EXPECT_EQ(profile.speed(s), 8.5);
        EXPECT_EQ(profile.acceleration(s), 0);
        EXPECT_DOUBLE_EQ(profile.time(s), s / 8.5);
        EXPECT_NEAR(profile.station(s / 8.5), s, 1e-9);
    }
    EXPECT_TRUE(profile.changes().empty());
}

double tightest(const SeamModel& m) {
    double most = 0;
    for (int k = 0; k <= 20000; ++k) {
        most = std::max(most, curvature(m.curve, last_parameter(m.curve) * k / 20000));
    }
    return most;
}

// Straight sides at full speed, corners of radius 12, where the spline bends a little more than that, at some 57 mm/s.
TEST(SpeedProfile, SlowsDownInBendsSmoothlyAndAsFarAsNeeded) {
    for (const RunIn run_in : {RunIn::none, RunIn::within}) {
        PlanOptions options = fast();
        options.run_in = run_in;
        const SeamModel m = test::model_of(test::rounded_box(300, 12), true, 400);
        const SpeedProfile profile = profile_of(m, options);
        const ArcLength arc(m.curve);
        double slowest = 1e9, fastest = 0;
        for (int k = 1; k < 20000; ++k) {
            const double s = m.length_mm * k / 20000, v = profile.speed(s);
            EXPECT_LE(v * v * curvature(m.curve, arc.parameter(s)), 300 * 1.001) << s;
            fastest = std::max(fastest, v);
            if (s > 30 && s < m.length_mm - 30) {
                slowest = std::min(slowest, v);
            }
        }
        EXPECT_DOUBLE_EQ(fastest, 120) << "between the bends it is at full speed again";
        EXPECT_NEAR(slowest, std::sqrt(300 / tightest(m)), 0.2) << "and no slower in them than asked for";
        EXPECT_GE(profile.changes().size(), 8u * 4);
    }
}

// By differences over time, which know nothing of how the speed was made.
TEST(SpeedProfile, KeepsAccelerationAndJerk) {
    for (const RunIn run_in : {RunIn::none, RunIn::within}) {
        for (const double rate : {360.0, 40.0}) {
            PlanOptions options = fast();
            options.run_in = run_in;
            options.turn_rate_deg_s = rate;
            options.centripetal_mm_s2 = 90;
            const SeamModel m = test::model_of(test::s_curve(400, 40), false, 160);
            const SpeedProfile profile = profile_of(m, options);
            const int steps = 4000;
            const double dt = profile.duration() / steps;
            std::vector<double> v;
            for (int k = 0; k <= steps; ++k) {
                v.push_back(profile.speed(profile.station(k * dt)));
            }
            for (int k = 1; k < steps; ++k) {
                EXPECT_LE(std::abs(v[k + 1] - v[k]) / dt, 400 * 1.001) << k;
                EXPECT_LE(std::abs(v[k + 1] - 2 * v[k] + v[k - 1]) / (dt * dt), 4000 * 1.01) << k;
                EXPECT_NEAR((v[k + 1] - v[k - 1]) / (2 * dt), profile.acceleration(profile.station(k * dt)), 12) << k;
            }
            if (run_in == RunIn::within) {
                EXPECT_NEAR(v.front(), 0, 1e-6);
                EXPECT_NEAR(v.back(), 0, 1e-6);
            }
        }
    }
}

TEST(SpeedProfile, KeepsTheTorchsTurnRate) {
    PlanOptions options;
    options.speed_mm_s = 60;
    options.turn_rate_deg_s = 90;
    const SeamModel m = test::model_of(test::rounded_box(80, 12), true, 160);
    const TorchPath path(m, 0, options);
    const SpeedProfile profile(path, planning::sample(path, options.chord_tolerance_mm), options);
    const double dt = 1e-3;
    double most = 0;
    for (double t = dt; t < profile.duration(); t += dt) {
        const auto a = path.at_station(profile.station(t - dt)).q, b = path.at_station(profile.station(t)).q;
        most = std::max(most, rotation_angle(a, b) / dt * 180 / test::kPi);
    }
    EXPECT_LE(most, 90 * 1.005);
    EXPECT_GE(most, 90 * 0.97);
}

TEST(SpeedProfile, TimeIsTheIntegralOfDsOverSpeed) {
    for (const RunIn run_in : {RunIn::none, RunIn::within}) {
        PlanOptions options = fast();
        options.run_in = run_in;
        options.centripetal_mm_s2 = 80;
        const SeamModel m = test::model_of(test::s_curve(400, 60), false, 160);
        const SpeedProfile profile = profile_of(m, options);
        ASSERT_FALSE(profile.changes().empty());
        // From rest the way grows as the cube of the time: over x = s^(1/3) the integrand is smooth. The last ramp
        // can't be summed so, for s near the end has no digits left; it is the first one's mirror image.
        const double step = m.length_mm / 4000;
        long double time =
            integral([&](long double x) { return 3 * x * x / profile.speed(static_cast<double>(x * x * x)); }, 0,
                     std::cbrt(static_cast<long double>(step)));
        for (int k = 1; k < 3700; ++k) {
            if (k < 250) {
                time += integral([&](long double s) { return 1 / profile.speed(static_cast<double>(s)); }, k * step,
                                 (k + 1) * step);
            } else {
                for (int i = 0; i < 4; ++i) {  // two Gauss points for each quarter
                    const double h = step / 8, middle = k * step + (2 * i + 1) * h, off = h / std::sqrt(3.0);
                    time += h * (1.0L / profile.speed(middle - off) + 1.0L / profile.speed(middle + off));
                }
            }
            if (k % 100 == 99) {
                EXPECT_NEAR(profile.time((k + 1) * step), static_cast<double>(time), 1e-9) << k;
            }
        }
        for (double s = step; s < 0.1 * m.length_mm; s += step) {
            EXPECT_NEAR(profile.duration() - profile.time(m.length_mm - s), profile.time(s), 1e-7) << s;
        }
    }
}

TEST(SpeedProfile, RefusesAWeldShorterThanItsRamps) {
    PlanOptions options = fast();
    options.run_in = RunIn::within;
    const SeamModel m = test::model_of(test::line(20), false, 4);
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, options);
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("seam 0 is welded over 20 mm"), HasSubstr("run-in and run-out take"),
                                        HasSubstr("plan.run_in = none"))));
    options.run_in = RunIn::none;
    EXPECT_NO_THROW(plan({&m, 1}, options));
}

std::vector<Waypoint> weld_of(const Plan& plan) {
    std::vector<Waypoint> weld = plan.waypoints;
    weld.erase(weld.begin());
    weld.pop_back();
    return weld;
}

// A run-in is shorter than the way between two places that are told evenly.
TEST(Travel, ShowsHowTheTorchGetsToItsSpeed) {
    PlanOptions options;
    options.run_in = RunIn::within;
    const SeamModel m = test::model_of(test::helix(35, 30), false, 120);
    const std::vector<TravelSample> travel = plan({&m, 1}, options).travel;
    const Ramp ramp(options.speed_mm_s, options.acceleration_mm_s2, options.jerk_mm_s3);
    double forward = 0, back = 0;
    for (std::size_t k = 0; k < travel.size(); ++k) {
        forward = std::max(forward, travel[k].acceleration_mm_s2);
        back = std::min(back, travel[k].acceleration_mm_s2);
        EXPECT_TRUE(k == 0 || travel[k].station_mm > travel[k - 1].station_mm);
    }
    const double most = ramp.acceleration(0.5 * ramp.duration());
    EXPECT_GT(most, 100);
    EXPECT_NEAR(forward, most, 1e-6 * most);
    EXPECT_NEAR(back, -most, 1e-6 * most);
    EXPECT_NEAR(travel.front().speed_mm_s, 0, 1e-9);
    EXPECT_NEAR(travel.back().speed_mm_s, 0, 1e-9);
}

TEST(PlanOutput, EqualTimes) {
    for (const RunIn run_in : {RunIn::none, RunIn::within}) {
        PlanOptions options = fast();
        options.run_in = run_in;
        options.period_s = 0.004;
        const SeamModel m = test::model_of(test::s_curve(200, 12), false, 120);
        const std::vector<Waypoint> weld = weld_of(plan({&m, 1}, options));
        for (std::size_t k = 1; k + 1 < weld.size(); ++k) {
            EXPECT_NEAR(weld[k].time_s - weld[0].time_s, 0.004 * static_cast<double>(k), 1e-9);
        }
        const double last = weld.back().time_s - weld[weld.size() - 2].time_s;
        EXPECT_GT(last, 0);
        EXPECT_LE(last, 0.004 + 1e-9);
        EXPECT_DOUBLE_EQ(weld.back().station_mm, m.length_mm);
    }
}

TEST(PlanOutput, EqualDistances) {
    PlanOptions options;
    options.step_mm = 2.5;
    const SeamModel m = test::model_of(test::helix(35, 30), false, 120);
    const ArcLength arc(m.curve);
    const std::vector<Waypoint> weld = weld_of(plan({&m, 1}, options));
    ASSERT_EQ(weld.size(), static_cast<std::size_t>(std::floor(m.length_mm / 2.5)) + 2);
    for (std::size_t k = 0; k + 1 < weld.size(); ++k) {
        // Stations by another way than the one that found them: the foot point of the waypoint.
        const double u = nearest_parameter(m.curve, weld[k].p);
        EXPECT_NEAR(arc.station(u), 2.5 * static_cast<double>(k), 1e-9);
    }
}

TEST(PlanOutput, Knots) {
    PlanOptions options;
    options.at_knots = true;
    const SeamModel m = test::model_of(test::circle(40), true, 24);
    const std::vector<Waypoint> weld = weld_of(plan({&m, 1}, options));
    ASSERT_EQ(weld.size(), 25u);
    for (std::size_t k = 0; k < weld.size(); ++k) {
        EXPECT_LT((weld[k].p - position(m.curve, m.curve.knots[k])).norm(), 1e-9);
    }
}

// Where the speed falls, moves are written with their own mean speeds: a program that keeps them is in time.
TEST(PlanOutput, SpeedsOfMovesMakeTheTimes) {
    PlanOptions options = fast();
    const SeamModel m = test::model_of(test::rounded_box(300, 12), true, 400);
    const Plan result = plan({&m, 1}, options);
    const std::vector<Waypoint> weld = weld_of(result);
    double slowest = 1e9;
    for (std::size_t k = 1; k < weld.size(); ++k) {
        const double time = weld[k].time_s - weld[k - 1].time_s;
        EXPECT_NEAR(weld[k].speed_mm_s * time, weld[k].station_mm - weld[k - 1].station_mm, 1e-6);
        slowest = std::min(slowest, weld[k].speed_mm_s);
        EXPECT_LE(std::abs(weld[k].speed_mm_s - weld[k - 1].speed_mm_s), k > 1 ? 30 : 1e9) << k;
    }
    EXPECT_NEAR(slowest, std::sqrt(300 / tightest(m)), 1);
    EXPECT_LE(result.max_chord_error_mm, options.chord_tolerance_mm);
}

TEST(PlanOutput, OneSpacingOnly) {
    PlanOptions options;
    options.period_s = 0.01;
    EXPECT_TRUE(plan_problems(options).empty());
    options.step_mm = 1;
    EXPECT_THAT(plan_problems(options), testing::ElementsAre(HasSubstr("period_s: with step_mm or at_knots")));
    options.period_s.reset();
    options.step_mm = 0.001;
    const SeamModel m = test::model_of(test::line(5000), false, 4);
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, options);
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("plan.step_mm = 0.001 gives 5e+06"), HasSubstr("at most 1e+06"))));
}

}  // namespace speed_test
}  // namespace seampath
