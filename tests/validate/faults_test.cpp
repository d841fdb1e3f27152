#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "stages/geometry/bspline.hpp"
#include "stages/validate/validate.hpp"
#include "tests/geometry/clouds.hpp"
#include "tests/geometry/curves.hpp"

/// Faults planted in models and scans of a floor and a wall, on fine and on coarse sensors: right seams pass by their
/// default tolerance, seams with a fault do not.
namespace seampath {
namespace faults_test {

using Eigen::Vector3d;

/// A sensor, and a part of a size that it suits. The wall's foot is y = wave sin(2 pi x / length).
struct Bench {
    const char* name;
    double pitch, sigma, length, width, wave;
};

void PrintTo(const Bench& bench, std::ostream* out) {
    *out << bench.name;
}

constexpr std::uint64_t kSeeds = 6;

double foot(const Bench& b, double x) {
    return b.wave * std::sin(2 * kPi * x / b.length);
}

Vector3d wall_normal(const Bench& b, double x) {
    return Vector3d(-2 * kPi * b.wave / b.length * std::cos(2 * kPi * x / b.length), 1, 0).normalized();
}

/// Floor z = 0 and the wall on its foot, each `width` mm wide. `dent(x)`: how far the floor is raised up to half its
/// width from the seam.
Scan scan_of(const Bench& b, std::uint64_t seed, const std::function<double(double)>& dent) {
    std::vector<Eigen::Vector3f> points;
    const Sampling sampling{b.pitch, b.sigma, seed};
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), b.length, Vector3d::UnitY(), b.width, sampling);
    for (Eigen::Vector3f& p : points) {
        p.z() += p.y() < 0.5 * b.width ? static_cast<float>(dent(p.x())) : 0;
        p.y() += static_cast<float>(foot(b, p.x()));
    }
    const std::size_t floor = points.size();
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), b.length, Vector3d::UnitZ(), b.width, sampling);
    for (std::size_t i = floor; i < points.size(); ++i) {
        const Vector3d p = points[i].cast<double>();  // its noise is along y
        points[i] = (Vector3d(p.x(), foot(b, p.x()), p.z()) + p.y() * wall_normal(b, p.x())).cast<float>();
    }
    return scan_of_points(std::move(points));
}

/// The true seam moved by `moved(x)`: a spline with a control point every fifth of a millimetre or pitch.
SeamModel model_of(const Bench& b, const std::function<Vector3d(double)>& moved) {
    const auto count = static_cast<std::size_t>(std::lround(b.length / std::min(0.2, 0.2 * b.pitch)));
    SeamModel model;
    for (int k = 0; k < 3; ++k) {
        model.curve.knots.push_back(0);
    }
    for (std::size_t i = 0; i <= count; ++i) {
        model.curve.knots.push_back(b.length * static_cast<double>(i) / static_cast<double>(count));
    }
    for (int k = 0; k < 3; ++k) {
        model.curve.knots.push_back(b.length);
    }
    for (std::size_t i = 0; i + 4 < model.curve.knots.size(); ++i) {
        const auto& knots = model.curve.knots;
        const double x = (knots[i + 1] + knots[i + 2] + knots[i + 3]) / 3;
        model.curve.control.push_back(Vector3d(x, foot(b, x), 0) + moved(x));
    }
    const ArcLength arc(model.curve);
    model.length_mm = arc.length();
    for (double s = 0; s < arc.length(); s += b.pitch) {
        const double x = position(model.curve, arc.parameter(s)).x();
        model.flanks.push_back({s, wall_normal(b, x), Vector3d::UnitZ(), 0.01, false});
    }
    return model;
}

const auto nowhere = [](double) -> Vector3d { return Vector3d::Zero(); };
const auto flat = [](double) { return 0.0; };

class PlantedFaults : public testing::TestWithParam<Bench> {
protected:
    const Bench& b = GetParam();

    /// How many of the seeds pass.
    std::uint64_t passed(const SeamModel& model, const std::function<double(double)>& dent) const {
        std::uint64_t passes = 0;
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
            const Deviation deviation = validate(model, scan_of(b, seed, dent), {});
            passes += deviation.pass;
        }
        return passes;
    }
};

TEST_P(PlantedFaults, RightSeamPasses) {
    EXPECT_EQ(passed(model_of(b, nowhere), flat), kSeeds);
}

// By three sigmas of the scan's points, over six sample distances of a dense scan and one of a sparse one.
TEST_P(PlantedFaults, SeamShiftedOverAShortStretchFails) {
    const auto shift = [&](double x) {
        const double half = std::max(3 * b.pitch, 0.02 * b.length);
        return Vector3d(0, 0, std::abs(x - 0.43 * b.length) < half ? 3.3 * b.sigma : 0);
    };
    EXPECT_EQ(passed(model_of(b, shift), flat), 0u);
}

TEST_P(PlantedFaults, SeamShiftedAtItsEndFails) {
    const auto shift = [&](double x) {
        return 5 * b.sigma * std::max(0.0, x / (0.1 * b.length) - 9) * Vector3d::UnitY();
    };
    EXPECT_EQ(passed(model_of(b, shift), flat), 0u);
}

TEST_P(PlantedFaults, FlippedNormalFails) {
    SeamModel model = model_of(b, nowhere);
    for (FlankSample& flank : model.flanks) {
        if (flank.station_mm > 0.5 * b.length && flank.station_mm < 0.7 * b.length) {
            flank.n1 = -flank.n1;
        }
    }
    EXPECT_EQ(passed(model, flat), 0u);
}

TEST_P(PlantedFaults, SeamOnAFreeEdgeFails) {
    EXPECT_EQ(passed(model_of(b, [&](double) -> Vector3d { return b.width * Vector3d::UnitY(); }), flat), 0u);
}

// Flanks that stand out of their surface over a short stretch: the seam is there, wherever the rest of it lies.
TEST_P(PlantedFaults, PartThatIsBentLocallyFails) {
    const auto dent = [&](double x) { return std::abs(x - 0.6 * b.length) < 0.1 * b.length ? 6 * b.sigma : 0.0; };
    EXPECT_EQ(passed(model_of(b, nowhere), dent), 0u);
}

INSTANTIATE_TEST_SUITE_P(Sensors, PlantedFaults,
                         testing::Values(Bench{"dense", 0.3, 0.045, 70, 14, 0},
                                         Bench{"dense_bent", 0.3, 0.045, 70, 14, 4},
                                         Bench{"sparse", 2.5, 1, 300, 60, 0}, Bench{"sparse_bent", 2.5, 1, 300, 60, 12},
                                         Bench{"noisy", 1.5, 1.5, 200, 60, 0}),
                         [](const auto& at) { return std::string(at.param.name); });

}  // namespace faults_test
}  // namespace seampath
