#include <gtest/gtest.h>

#include "tests/fit/measured_saddle.hpp"
#include "tests/fit/models.hpp"

/// How good the smoothing spline is on a saddle, and how well it knows.
namespace seampath {
namespace band_test {

using Eigen::Vector3d;

double half_width_at(const SeamModel& model, double station) {
    const auto& band = model.band;
    const auto above = std::lower_bound(band.begin() + 1, band.end() - 1, station,
                                        [](const BandSample& sample, double s) { return sample.station_mm < s; });
    const BandSample &a = *(above - 1), &b = *above;
    const double share = std::clamp((station - a.station_mm) / (b.station_mm - a.station_mm), 0.0, 1.0);
    return (1 - share) * a.half_width_mm + share * b.half_width_mm;
}

/// Whether the band holds the truth at `kPlaces` places along the seam, counted over seeds.
constexpr int kPlaces = 24, kSeeds = 50;
struct Coverage {
    std::array<int, kPlaces> held{};
    double mean() const {
        double sum = 0;
        for (const int h : held) {
            sum += h;
        }
        return sum / (kPlaces * kSeeds);
    }
    int places_below(double share) const {
        return static_cast<int>(std::count_if(held.begin(), held.end(), [&](int h) { return h < share * kSeeds; }));
    }
};

template <class Curve>
Coverage coverage(const Curve& curve, bool closed, int points, double sigma, int share_errors_with = 1) {
    Coverage coverage;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        Seam seam = seam_along(curve, points, closed);
        const Random random(seed, 4);
        const auto error = [&](int i, int of) {  // of neighbours together, of variance 1
            double sum = 0;
            for (int k = 0; k < share_errors_with; ++k) {
                sum += random.normal(2 * static_cast<std::uint64_t>((i + k) % points) + static_cast<std::uint64_t>(of));
            }
            return sum / std::sqrt(share_errors_with);
        };
        for (int i = 0; i < points; ++i) {
            SeamPoint& point = seam.points[static_cast<std::size_t>(i)];
            point.p += sigma / std::sqrt(2.0) * (error(i, 0) * point.n1 + error(i, 1) * point.n2);
            point.sigma_mm = sigma;
        }
        const SeamModel model = fit(seam, {}, spline_model());
        const ArcLength arc(model.curve);
        for (int k = 0; k < kPlaces; ++k) {
            const Vector3d truth = curve((k + 0.5) / kPlaces);
            const double u = nearest_parameter(model.curve, truth);
            coverage.held[static_cast<std::size_t>(k)] +=
                (position(model.curve, u) - truth).norm() <= half_width_at(model, arc.station(u)) ? 1 : 0;
        }
    }
    return coverage;
}

TEST(Band, HoldsTheTruthAsOftenAsItSays) {
    const auto check = [](const Coverage& c, const char* what) {
        EXPECT_GE(c.mean(), 0.93) << what;
        EXPECT_LE(c.mean(), 0.975) << what;
        EXPECT_LE(c.places_below(0.85), kPlaces / 12) << what;
    };
    check(coverage(CircleCurve{30}, true, 250, 0.05), "circle");
    check(coverage(Straight{{0, 0, 0}, {90, 0, 0}}, false, 120, 0.05), "line");
    check(coverage(SineCurve{200, 18}, false, 300, 0.02), "sine");
}

// The crowns of nearly equal pipes, where a stiff curve is flatter than the seam: without its bias the band holds there
// in two scans of three.
TEST(Band, HoldsWhereTheSeamBendsHardest) {
    const SaddleCurve saddle = pipes(600, 588);
    constexpr int kScans = 60;
    constexpr double kCrowns[] = {0.25, 0.75};
    int held = 0;
    for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
        const SeamModel model = fit(measured_saddle(saddle, {}, seed), {}, spline_model());
        const ArcLength arc(model.curve);
        for (const double crown : kCrowns) {
            const Vector3d truth = saddle.at(2 * kPi * crown).p;
            const double u = nearest_parameter(model.curve, truth);
            held += (position(model.curve, u) - truth).norm() <= half_width_at(model, arc.station(u)) ? 1 : 0;
        }
    }
    EXPECT_GE(held, 0.86 * kScans * std::size(kCrowns));
}

// Windows of extraction overlap: neighbours are off together, and smoothing takes less of that away than it seems.
TEST(Band, HoldsWhereNeighboursShareTheirErrors) {
    EXPECT_GE(coverage(CircleCurve{30}, true, 250, 0.05, 12).mean(), 0.93);
    EXPECT_GE(coverage(Straight{{0, 0, 0}, {90, 0, 0}}, false, 120, 0.05, 12).mean(), 0.93);
}

TEST(Band, IsWideWherePointsAreMissing) {
    Seam seam = noisy(seam_along(CircleCurve{30}, 250, true), 0.02, 1);
    seam.points.erase(seam.points.begin() + 60, seam.points.begin() + 75);
    const SeamModel model = fit(seam, {}, spline_model());
    const double middle = 2 * kPi * 30 * 67.5 / 250;
    EXPECT_GT(half_width_at(model, middle), 1.3 * half_width_at(model, middle + 2 * kPi * 30 / 2));
}

SaddleErrors saddle_errors(const SaddleCurve& saddle, double off_share, std::uint64_t seed) {
    return errors_of(fit(measured_saddle(saddle, {.off_share = off_share}, seed), {}, spline_model()), saddle);
}

TEST(Fit, FollowsNoisySaddlesWithOutliers) {
    const SaddleCurve small = pipes(600, 150), large = pipes(600, 588);
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
        const SaddleErrors errors = saddle_errors(small, 0.05, seed);
        EXPECT_LE(errors.rms, 0.012) << seed;
        EXPECT_LE(errors.max, 0.03) << seed;
        EXPECT_LE(saddle_errors(large, 0.05, seed).rms, 0.035) << seed;
    }
}

// Smooth against its points: a curve as stiff as this is at the edge of what knots at every point can hold.
TEST(Fit, FollowsDensePointsWithoutOutliers) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        const SaddleErrors errors = saddle_errors(pipes(600, 150), 0, seed);
        EXPECT_LE(errors.rms, 0.012) << seed;
        EXPECT_LE(errors.max, 0.03) << seed;
    }
}

// Two or more points that are off side by side are taken for a bend by whatever follows them closely.
TEST(Fit, HoldsAgainstOutliersSideBySide) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        Seam seam = noisy(seam_along(CircleCurve{60}, 400, true), 0.05, seed);
        for (const std::size_t first : {20, 120, 220, 320}) {
            for (const std::size_t k : {first, first + 2}) {
                seam.points[k].p += 3 * seam.points[k].n1;
            }
        }
        EXPECT_LT(largest_error(fit(seam, {}, spline_model()), CircleCurve{60}), 0.06) << seed;
    }
}

}  // namespace band_test
}  // namespace seampath
