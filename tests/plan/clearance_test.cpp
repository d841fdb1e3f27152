#include "stages/plan/clearance.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/geometry/pose.hpp"
#include "stages/plan/plan.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace clearance_test {

using Eigen::Vector3d;
using planning::Clearance;
using planning::TorchShape;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kDeg = test::kPi / 180;

/// A joint that opens by `opening` about +Z, along X.
test::Course wedge(double length, double opening) {
    const double c = std::cos(0.5 * opening), s = std::sin(0.5 * opening);
    return [=](double t) { return test::Place{{length * t, 0, 0}, {0, c, s}, {0, -c, s}}; };
}

void add(Scan& scan, const Vector3d& p) {
    scan.points.push_back(p.cast<float>());
}

/// Its two flanks, 90 mm high, flank 1 on the side of -Y.
Scan wedge_scan(double length, double opening, double noise_mm = 0, double spacing = 0.5) {
    std::mt19937 generator(1);
    std::normal_distribution<double> noise(0, noise_mm > 0 ? noise_mm : 1);
    Scan scan;
    const double c = std::cos(0.5 * opening), s = std::sin(0.5 * opening);
    for (double x = -30; x <= length + 30; x += spacing) {
        for (double along = 0; along <= 90; along += spacing) {
            for (const double side : {-1.0, 1.0}) {
                const double off = noise_mm > 0 ? noise(generator) : 0;
                add(scan, {x, side * (along * s - off * c), along * c + off * s});
            }
        }
    }
    return scan;
}

PlanOptions with_torch(double tip_mm) {
    PlanOptions options;
    options.nozzle_tip_mm = tip_mm;
    return options;
}

Plan plan_in(const SeamModel& model, const PlanOptions& options, const Scan& scan) {
    return plan({&model, 1}, options, {}, &scan);
}

// Against points all over its surface, and the plain rule of what is inside.
TEST(TorchShape, DistanceIsToTheNearestPointOfTheSurface) {
    PlanOptions options = with_torch(15);
    options.neck_angle_deg = 35;
    const TorchShape torch(options);
    const double bend = 35 * kDeg;
    const Vector3d along(-std::sin(bend), 0, -std::cos(bend)), joint(0, 0, -75);
    const Vector3d side = Vector3d::UnitY(), other = along.cross(side);
    const auto inside = [&](const Vector3d& p) {
        const double h = -p.z() - 15, t = (p - joint).dot(along);
        const bool nozzle = h >= 0 && h <= 60 && std::hypot(p.x(), p.y()) <= 7.5 + 5 * h / 60;
        return nozzle || (t >= 0 && t <= 120 && (p - joint - t * along).norm() <= 20);
    };
    std::vector<Vector3d> surface;
    for (double turn = 0; turn < 2 * test::kPi; turn += 0.04) {
        const double c = std::cos(turn), s = std::sin(turn);
        for (double share = 0; share <= 1; share += 1.0 / 80) {
            const double r = 7.5 + 5 * share;
            surface.emplace_back(r * c, r * s, -15 - 60 * share);
            surface.emplace_back(7.5 * share * c, 7.5 * share * s, -15);
            for (double t = 0; t < 1.5; t += 0.5) {  // three rows, for the body is twice as long
                surface.push_back(joint + std::min(120.0, 120 * share + t) * along + 20 * (c * side + s * other));
            }
            surface.push_back(joint + 20 * share * (c * side + s * other));
            surface.push_back(joint + 120 * along + 20 * share * (c * side + s * other));
        }
    }
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> at(-60, 60);
    int within = 0;
    for (int k = 0; k < 400; ++k) {
        const Vector3d p(at(generator) - 30, at(generator), at(generator) - 75);
        double nearest = 1e9;
        for (const Vector3d& q : surface) {
            // What of one part lies in the other is no surface; of points inside that is left out of account.
            nearest = std::min(nearest, (p - q).norm());
        }
        EXPECT_EQ(torch.distance(p) < 0, inside(p)) << p.transpose();
        within += inside(p) ? 1 : 0;
        if (!inside(p)) {
            EXPECT_NEAR(torch.distance(p), nearest, 0.6) << p.transpose();
        } else {
            EXPECT_LE(-torch.distance(p), 20);
        }
    }
    EXPECT_GT(within, 20);
    EXPECT_NEAR(torch.distance({0, 0, -15}), 0, 1e-12);
    EXPECT_NEAR(torch.distance({0, 0, -20}), -5, 1e-12);
    EXPECT_NEAR(torch.distance({0, 0, 0}), 15, 1e-12);
    EXPECT_NEAR(torch.distance(joint + 60 * along + 18 * side), -2, 1e-12);
}

TEST(Clearance, DepthIsThatOfAllPoints) {
    Scan scan = wedge_scan(60, 60 * kDeg, 0.2, 0.7);
    scan.origin_mm = {100, -50, 20};
    const SeamModel model = test::model_of(
        [](double t) {
            return test::Place{Vector3d(100 + 60 * t, -50, 20), {0, 1, 1}, {0, -1, 1}};
        },
        false, 4);
    PlanOptions options = with_torch(18);
    options.neck_angle_deg = 22;
    const Clearance clearance(scan, {&model, 1}, options);
    const TorchShape torch(options);
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> at(-1, 1);
    int touching = 0;
    for (int k = 0; k < 40; ++k) {
        const Vector3d p(130 + 40 * at(generator), -50 + 6 * at(generator), 26 + 6 * at(generator));
        const Eigen::Quaterniond q =
            Eigen::Quaterniond(0, 1, 0, 0) *
            Eigen::Quaterniond(1, 0.4 * at(generator), 0.4 * at(generator), at(generator)).normalized();
        std::vector<double> depths;
        for (std::size_t i = 0; i < scan.points.size(); ++i) {
            depths.push_back(0.5 - torch.distance(q.conjugate() * (scan.position(i) - p)));
        }
        std::nth_element(depths.begin(), depths.begin() + 2, depths.end(), std::greater<>());
        EXPECT_NEAR(clearance.depth(p, q), std::max(0.0, depths[2]), 1e-4) << k;
        EXPECT_EQ(clearance.touches(p, q), depths[2] > 0);
        touching += depths[2] > 0 ? 1 : 0;
    }
    EXPECT_GT(touching, 10);
    EXPECT_LT(touching, 38);
}

// The nozzle's mouth is the first to touch: at stick-out h its rim of radius R is h sin - R cos of half the opening off
// each flank. No lean helps where both sides are alike.
TEST(PlanClearance, WedgeIsFreeUpToTheRimThatTouchesIt) {
    for (const double opening : {60.0, 100.0}) {
        const double half = 0.5 * opening * kDeg;
        const double rim = (15 * std::sin(half) - 0.5) / std::cos(half);
        const SeamModel model = test::model_of(wedge(30, opening * kDeg), false, 4);
        const Scan scan = wedge_scan(30, opening * kDeg, 0, 0.25);
        for (const double off : {-0.05, 0.5}) {
            PlanOptions options = with_torch(2 * (rim + off));
            options.nozzle_base_mm = std::max(25.0, 2 * rim + 1);
            const Plan result = plan_in(model, options, scan);
            EXPECT_EQ(result.refused.empty(), off < 0) << opening;
            EXPECT_EQ(result.waypoints.empty(), off > 0);
            if (off < 0) {
                const Plan without = plan({&model, 1}, options);
                ASSERT_EQ(result.waypoints.size(), without.waypoints.size());
                for (std::size_t k = 0; k < without.waypoints.size(); ++k) {
                    EXPECT_EQ(result.waypoints[k].q.coeffs(), without.waypoints[k].q.coeffs()) << "it stays as it was";
                }
                continue;
            }
            ASSERT_EQ(result.refused.size(), 1u) << opening;
            EXPECT_EQ(result.refused[0].seam, 0);
            EXPECT_LE(result.refused[0].depth_mm, off * std::cos(half) + 1e-5);
            EXPECT_GE(result.refused[0].depth_mm, off * std::cos(half) - 0.1) << "but for the points' spacing";
        }
    }
}

TEST(PlanClearance, FilletOf90DegIsFreeInNoiseAndAnAcuteOneRefused) {
    const SeamModel square = test::model_of(wedge(60, 90 * kDeg), false, 4);
    EXPECT_TRUE(plan_in(square, with_torch(15), wedge_scan(60, 90 * kDeg, 0.3)).refused.empty());
    const SeamModel acute = test::model_of(wedge(60, 30 * kDeg), false, 4);
    const Plan refused = plan_in(acute, with_torch(15), wedge_scan(60, 30 * kDeg, 0.1));
    ASSERT_EQ(refused.refused.size(), 1u);
    EXPECT_THAT(refused.refused[0].reason,
                AllOf(HasSubstr("seam 0 is refused: at station "), HasSubstr(" mm the scan reaches "),
                      HasSubstr("mm into the torch"), HasSubstr("leaned aside by up to 20 deg"),
                      HasSubstr("a longer plan.stick_out_mm")));
    EXPECT_EQ(refused.duration_s, 0);
}

/// An edge along X from 40 to 60 mm, 60 mm up and 8 mm from the bisector on the side of flank 1: it touches the nozzle,
/// whose radius there is 11.25.
Scan with_edge() {
    Scan scan = wedge_scan(120, 90 * kDeg);
    for (double x = 40; x <= 60; x += 0.1) {
        add(scan, {x, -8, 60});
    }
    return scan;
}

/// By how much the edge is off the nozzle's side when the torch leans from it by that angle.
double off_edge(double lean) {
    const double r = 8 * std::cos(lean) + 60 * std::sin(lean), h = 60 * std::cos(lean) - 8 * std::sin(lean);
    const double slope = 5.0 / 60;
    return (r - 7.5 - slope * (h - 15)) / std::hypot(1, slope);
}

TEST(PlanClearance, LeansAsideAsLittleAsFreesIt) {
    ASSERT_LT(off_edge(3 * kDeg), 0.5);
    ASSERT_GT(off_edge(4 * kDeg), 0.5);
    const SeamModel model = test::model_of(wedge(120, 90 * kDeg), false, 4);
    const Scan scan = with_edge();
    PlanOptions options = with_torch(15);
    options.step_mm = 1;
    const Plan result = plan_in(model, options, scan);
    ASSERT_TRUE(result.refused.empty()) << result.refused[0].reason;
    const Clearance clearance(scan, {&model, 1}, options);
    double most = 0, before = 0;
    for (const TravelSample& s : result.travel) {
        EXPECT_LE(s.work_rad, 1e-9) << "away from flank 1";
        EXPECT_GE(s.work_rad, -4 * kDeg - 1e-9) << "no further than it takes";
        most = std::max(most, -s.work_rad);
        if (s.station_mm > 42 && s.station_mm < 58) {
            EXPECT_NEAR(s.work_rad, -4 * kDeg, 1e-9);
        } else if (s.station_mm < 20 || s.station_mm > 80) {
            EXPECT_NEAR(s.work_rad, 0, 1e-9);
        }
        EXPECT_LE(std::abs(s.work_rad - before), 1.0 * kDeg * 120 / 200 + 1e-9) << "a degree a millimetre";
        before = s.work_rad;
    }
    for (const Waypoint& w : result.waypoints) {
        EXPECT_EQ(clearance.depth(w.p, w.q), 0) << w.station_mm;
    }
    options.max_free_angle_deg = 3;
    const Plan refused = plan_in(model, options, scan);
    ASSERT_EQ(refused.refused.size(), 1u);
    EXPECT_NEAR(refused.refused[0].station_mm, 50, 10.5) << "where the edge is";
    EXPECT_NEAR(refused.refused[0].depth_mm, 0.5 - off_edge(3 * kDeg), 0.01);
}

TEST(PlanClearance, TwoStraysInTheAirAreNoObstacle) {
    const SeamModel model = test::model_of(wedge(60, 90 * kDeg), false, 4);
    Scan scan = wedge_scan(60, 90 * kDeg);
    add(scan, {30, 0, 18});
    add(scan, {30, 0, 18.1});
    EXPECT_TRUE(plan_in(model, with_torch(15), scan).refused.empty());
    add(scan, {30, 0.1, 18.1});
    add(scan, {30, -0.1, 18.1});
    EXPECT_FALSE(plan_in(model, with_torch(15), scan).refused.empty()) << "so near to the mouth no lean frees it";
}

// A wall across the seam's beginning, 30 mm behind it: the body that is bent back stands in it.
TEST(PlanClearance, TurnsABentNeckAboutItsWire) {
    const SeamModel model = test::model_of(wedge(200, 90 * kDeg), false, 4);
    Scan scan = wedge_scan(200, 90 * kDeg);
    for (double y = -150; y <= 150; y += 1) {
        for (double z = 0; z <= 200; z += 1) {
            add(scan, {-30, y, z});
        }
    }
    PlanOptions options = with_torch(15);
    options.neck_angle_deg = 45;
    options.step_mm = 5;
    const Plan result = plan_in(model, options, scan);
    ASSERT_TRUE(result.refused.empty()) << result.refused[0].reason;
    const Clearance clearance(scan, {&model, 1}, options);
    for (const Waypoint& w : result.waypoints) {
        EXPECT_EQ(clearance.depth(w.p, w.q), 0) << w.station_mm;
    }
    const auto roll = [](const Waypoint& w) { return std::abs(std::asin((w.q * Vector3d::UnitX()).y())) / kDeg; };
    EXPECT_GT(roll(result.waypoints[1]), 30);
    EXPECT_NEAR(roll(result.waypoints.back()), 0, 1e-6) << "as planned where the wall is far";
    options.neck_angle_deg = 0;
    EXPECT_TRUE(plan_in(model, options, scan).refused.empty());
}

// A post between two seams that stand in a row: straight over is barred.
TEST(PlanClearance, GoesOverWhatStandsBetweenSeams) {
    const SeamModel first = test::model_of(wedge(60, 90 * kDeg), false, 4);
    Eigen::Isometry3d ahead = Eigen::Isometry3d::Identity();
    ahead.translation() = Vector3d(160, 0, 0);
    const std::vector<SeamModel> both{first, test::model_of(test::moved(wedge(60, 90 * kDeg), ahead), false, 4)};
    Scan scan = wedge_scan(220, 90 * kDeg);
    for (double y = -20; y <= 20; y += 0.5) {
        for (double z = 0; z <= 90; z += 0.5) {
            add(scan, {110, y, z});
        }
    }
    const PlanOptions options = with_torch(15);
    const Plan without = plan(both, options), result = plan(both, options, {}, &scan);
    ASSERT_TRUE(result.refused.empty()) << result.refused[0].reason;
    EXPECT_EQ(result.waypoints.size(), without.waypoints.size() + 1);
    const Clearance clearance(scan, both, options);
    for (std::size_t k = 1; k < result.waypoints.size(); ++k) {
        EXPECT_TRUE(clearance.way_is_free(result.waypoints[k - 1], result.waypoints[k])) << k;
    }
}

// A roof over the seam's start bars the way straight back.
TEST(PlanClearance, ApproachesUnderARoof) {
    const SeamModel model = test::model_of(wedge(60, 90 * kDeg), false, 4);
    Scan scan = wedge_scan(60, 90 * kDeg);
    for (double x = -15; x <= 30; x += 0.5) {
        for (double y = -15; y <= 15; y += 0.5) {
            add(scan, {x, y, 215});  // the torch ends at 195
        }
    }
    const PlanOptions options = with_torch(15);
    const Plan result = plan_in(model, options, scan);
    ASSERT_TRUE(result.refused.empty()) << result.refused[0].reason;
    const Clearance clearance(scan, {&model, 1}, options);
    const Waypoint &approach = result.waypoints[0], &start = result.waypoints[1];
    EXPECT_NEAR((approach.p - start.p).norm(), 30, 1e-9);
    EXPECT_LT((approach.p - start.p).z(), 29) << "not straight up";
    EXPECT_TRUE(clearance.way_is_free(approach, start));
}

}  // namespace clearance_test
}  // namespace seampath
