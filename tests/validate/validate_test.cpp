#include "stages/validate/validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/fit/fit.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/place/place.hpp"
#include "tests/geometry/boxes.hpp"
#include "tests/geometry/clouds.hpp"
#include "tests/geometry/curves.hpp"

namespace seampath {
namespace validate_test {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double kLength = 100;

/// Floor z = 0 and a wall through the x axis that makes the opening angle with it.
Scan wedge(double opening, double sigma) {
    std::vector<Eigen::Vector3f> points;
    const Sampling sampling{0.3, sigma, 7};
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), kLength, Vector3d::UnitY(), 25, sampling);
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), kLength, Vector3d(0, std::cos(opening), std::sin(opening)), 25,
                  sampling);
    return scan_of_points(std::move(points));
}

/// The wedge's seam, moved. Flank 1 is the wall, flank 2 the floor.
SeamModel wedge_model(double opening, const Vector3d& moved) {
    Seam seam;
    for (double x = 0; x <= kLength; x += 1) {
        seam.points.push_back(
            {Vector3d(x, 0, 0) + moved, {0, std::sin(opening), -std::cos(opening)}, {0, 0, 1}, 0.01, false});
    }
    return fit(seam, place(seam, {}), {});
}

TEST(Validate, ModelMovedAlongAFlankNormalIsOffByThatMuch) {
    for (const double degrees : {60.0, 90.0, 120.0}) {
        const double opening = degrees * kPi / 180;
        const Scan scan = wedge(opening, 0);
        const Vector3d wall(0, std::sin(opening), -std::cos(opening)), floor(0, 0, 1);
        for (const double d : {-0.3, 0.05, 0.4}) {
            const Deviation off_wall = validate(wedge_model(opening, d * wall), scan, {});
            const Deviation off_floor = validate(wedge_model(opening, d * floor), scan, {});
            for (const DeviationSample& s : off_wall.samples) {
                ASSERT_TRUE(s.covered);
                EXPECT_NEAR(s.flank1_mm, d, 1e-4) << degrees;
                EXPECT_NEAR(s.flank2_mm, d * wall.dot(floor), 1e-4) << degrees;
                EXPECT_NEAR(s.distance_mm, std::abs(d), 1e-4);
            }
            EXPECT_NEAR(off_wall.max_mm, std::abs(d), 1e-4);
            EXPECT_NEAR(off_floor.rms_mm, std::abs(d), 1e-4);
            EXPECT_NEAR(off_floor.signed_mean_mm, d * (1 + wall.dot(floor)) / 2, 1e-4);
        }
    }
}

TEST(Validate, PerfectModelOfANoisyScanPasses) {
    // Its nearest scan points are a good part of the spacing away: distances to surfaces must not show that.
    const Deviation deviation = validate(wedge_model(kPi / 2, {0, 0, 0}), wedge(kPi / 2, 0.045), {});
    EXPECT_TRUE(deviation.pass) << deviation.verdict;
    EXPECT_LT(deviation.rms_mm, 0.015);
    EXPECT_DOUBLE_EQ(deviation.coverage, 1);
    EXPECT_NEAR(deviation.tolerance_mm, 3 * 0.045, 0.015) << "three sigmas of a point";
    EXPECT_THAT(deviation.verdict, StartsWith("pass: p99.7 "));
    EXPECT_THAT(deviation.verdict, HasSubstr("100.0 % of the seam measured"));
}

TEST(Validate, SaysThatAToleranceByNoiseAloneIsWide) {
    const SeamModel model = wedge_model(kPi / 2, {0, 0, 0});
    EXPECT_THAT(validate(model, wedge(kPi / 2, 0.4), {}).verdict, HasSubstr("set validate.tolerance_mm"));
    EXPECT_THAT(validate(model, wedge(kPi / 2, 0.4), {1.2, 0.9}).verdict, Not(HasSubstr("validate.tolerance_mm")));
    EXPECT_THAT(validate(model, wedge(kPi / 2, 0.045), {}).verdict, Not(HasSubstr("validate.tolerance_mm")));
}

TEST(Validate, SigmaSpeaksOfTheErrorsThatAreMade) {
    const Deviation deviation = validate(wedge_model(kPi / 2, {0, 0, 0}), wedge(kPi / 2, 0.045), {});
    double squares = 0;
    for (const DeviationSample& s : deviation.samples) {
        squares += std::pow(s.distance_mm / s.sigma_mm, 2) / static_cast<double>(deviation.samples.size());
    }
    // Neighbouring samples share most of their points: the mean of few independent values.
    EXPECT_GT(squares, 0.3);
    EXPECT_LT(squares, 2.5);
}

TEST(Validate, ModelBeyondToleranceFails) {
    const Scan scan = wedge(kPi / 2, 0.02);
    const Deviation deviation = validate(wedge_model(kPi / 2, {0, 0.2, 0}), scan, {});
    EXPECT_FALSE(deviation.pass);
    EXPECT_DOUBLE_EQ(deviation.tolerance_mm, 0.1) << "the least that welding asks for";
    EXPECT_THAT(deviation.verdict, StartsWith("fail: p99.7 0.2"));
    EXPECT_THAT(deviation.verdict, HasSubstr("exceeds tolerance 0.100 mm"));
    const Deviation lenient = validate(wedge_model(kPi / 2, {0, 0.2, 0}), scan, {0.5, 0.9});
    EXPECT_TRUE(lenient.pass) << lenient.verdict;
    EXPECT_THAT(lenient.verdict, HasSubstr("within tolerance 0.500 mm"));
}

TEST(Validate, GuardIsTakenOffTheTolerance) {
    const Scan scan = wedge(kPi / 2, 0.045);
    const Deviation measured = validate(wedge_model(kPi / 2, {0, 0, 0.1}), scan, {1, 0.9});
    const double guard = 1e-4 + 0.5 * measured.samples[measured.samples.size() / 2].sigma_mm;
    EXPECT_FALSE(validate(wedge_model(kPi / 2, {0, 0, 0.1}), scan, {measured.p997_mm + guard, 0.9}).pass);
}

TEST(Validate, GapInOneFlankIsNotCovered) {
    Scan scan = wedge(kPi / 2, 0.02);
    std::erase_if(scan.points, [](const Eigen::Vector3f& p) { return p.z() > 1 && p.x() > 40 && p.x() < 60; });
    const Deviation deviation = validate(wedge_model(kPi / 2, {0, 0, 0}), scan, {});
    EXPECT_NEAR(deviation.coverage, 0.8, 0.06);
    EXPECT_FALSE(deviation.pass);
    EXPECT_THAT(deviation.verdict, HasSubstr("less than 90.0 %"));
    EXPECT_TRUE(validate(wedge_model(kPi / 2, {0, 0, 0}), scan, {0, 0.7}).pass);
    for (const DeviationSample& s : deviation.samples) {
        if (s.station_mm > 46 && s.station_mm < 54) {
            EXPECT_FALSE(s.covered) << s.station_mm;
        }
        if (s.station_mm < 34 || s.station_mm > 66) {
            EXPECT_TRUE(s.covered) << s.station_mm;
        }
    }
}

TEST(Validate, ModelAwayFromTheScanIsNotMeasured) {
    const Deviation deviation = validate(wedge_model(kPi / 2, {0, 300, 0}), wedge(kPi / 2, 0.02), {});
    EXPECT_EQ(deviation.coverage, 0);
    EXPECT_FALSE(deviation.pass);
    EXPECT_EQ(deviation.max_mm, 0);
}

TEST(Validate, StatisticsAreThoseOfTheSamples) {
    const Deviation d = validate(wedge_model(kPi / 2, {0, 0.02, 0.03}), wedge(kPi / 2, 0.045), {});
    std::vector<double> distance;
    double squares = 0, sum = 0;
    for (const DeviationSample& s : d.samples) {
        distance.push_back(s.distance_mm);
        squares += s.distance_mm * s.distance_mm;
        sum += 0.5 * (s.flank1_mm + s.flank2_mm);
    }
    std::sort(distance.begin(), distance.end());
    const auto n = static_cast<double>(distance.size());
    EXPECT_NEAR(d.rms_mm, std::sqrt(squares / n), 1e-12);
    EXPECT_NEAR(d.signed_mean_mm, sum / n, 1e-12);
    EXPECT_EQ(d.max_mm, distance.back());
    EXPECT_EQ(d.p50_mm, distance[static_cast<std::size_t>(std::lround(0.5 * (n - 1)))]);
    EXPECT_EQ(d.p95_mm, distance[static_cast<std::size_t>(std::lround(0.95 * (n - 1)))]);
}

TEST(Validate, SamplesAreSpreadOverTheWholeSeam) {
    const Deviation d = validate(wedge_model(kPi / 2, {0, 0, 0}), wedge(kPi / 2, 0.02), {});
    const double step = kLength / static_cast<double>(d.samples.size());
    EXPECT_LT(step, 2);
    for (std::size_t i = 0; i < d.samples.size(); ++i) {
        EXPECT_NEAR(d.samples[i].station_mm, (static_cast<double>(i) + 0.5) * step, 1e-3);
        EXPECT_NEAR(d.samples[i].p.x(), d.samples[i].station_mm, 1e-3);
    }
}

TEST(Validate, ClosedSeamOfAPipeOnAPlate) {
    std::vector<Eigen::Vector3f> points;
    add_cylinder(points, 30, 25, {0.3, 0.02, 3});
    add_rectangle(points, {-60, -60, 0}, Vector3d::UnitX(), 120, Vector3d::UnitY(), 120, {0.3, 0.02, 4});
    std::erase_if(points, [](const Eigen::Vector3f& p) { return p.z() < 0.2f && p.head<2>().norm() < 29.9f; });
    const Scan scan = scan_of_points(std::move(points));
    Seam seam;
    seam.closed = true;
    for (int i = 0; i < 200; ++i) {
        const Vector3d out(std::cos(2 * kPi * i / 200), std::sin(2 * kPi * i / 200), 0);
        seam.points.push_back({30 * out, Vector3d::UnitZ(), out, 0.01, false});
    }
    std::reverse(seam.points.begin(), seam.points.end());
    for (SeamPoint& point : seam.points) {
        std::swap(point.n1, point.n2);
    }
    const Deviation exact = validate(fit(seam, place(seam, {}), {}), scan, {});
    EXPECT_TRUE(exact.pass) << exact.verdict;
    EXPECT_LT(exact.rms_mm, 0.012);
    for (SeamPoint& point : seam.points) {
        point.p.z() += 0.25;
    }
    const Deviation raised = validate(fit(seam, place(seam, {}), {}), scan, {});
    EXPECT_FALSE(raised.pass);
    EXPECT_NEAR(raised.rms_mm, 0.25, 0.012);
    EXPECT_NEAR(raised.signed_mean_mm, 0.125, 0.01);
}

TEST(Validate, OriginOfTheScanDoesNotMatter) {
    Scan scan = wedge(kPi / 2, 0.02);
    const Deviation here = validate(wedge_model(kPi / 2, {0, 0.05, 0}), scan, {});
    scan.origin_mm = {5000, -3000, 2000};
    const Deviation there = validate(wedge_model(kPi / 2, scan.origin_mm + Vector3d(0, 0.05, 0)), scan, {});
    EXPECT_NEAR(here.rms_mm, there.rms_mm, 1e-6);
    EXPECT_NEAR(here.signed_mean_mm, there.signed_mean_mm, 1e-6);
    EXPECT_EQ(here.coverage, there.coverage);
}

TEST(Validate, RefusesAScanWithoutSurfaces) {
    EXPECT_THAT(
        [] {
            validate(wedge_model(kPi / 2, {0, 0, 0}), scan_of_points({{1, 2, 3}, {4, 5, 6}}), {});
        },
        testing::ThrowsMessage<InputError>(StartsWith("validate: the scan has 2 points")));
}

TEST(Validate, MeasuresEachSideOfACornerByItsOwnFlanks) {
    const SharpBox box = tilted_box();
    const Scan scan = box.scan(0.03, 5);
    Seam seam = box.seam(1, 0, 1);
    const Vector3d up = seam.points.front().n1;
    for (const double raised : {0.0, 0.3}) {
        Seam moved = seam;
        for (SeamPoint& point : moved.points) {
            point.p += raised * up;
        }
        const Deviation d = validate(fit(moved, place(moved, {}), {}), scan, {});
        EXPECT_GT(d.coverage, 0.98);
        EXPECT_EQ(d.pass, raised == 0) << d.verdict;
        for (std::size_t k = 1; k < d.samples.size(); ++k) {
            EXPECT_GT(d.samples[k].station_mm, d.samples[k - 1].station_mm);
        }
        for (const DeviationSample& s : d.samples) {
            if (s.covered) {
                EXPECT_NEAR(s.distance_mm, raised, 0.03) << s.station_mm;
            }
        }
    }
}

}  // namespace validate_test
}  // namespace seampath
