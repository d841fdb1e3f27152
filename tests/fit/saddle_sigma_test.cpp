#include <numbers>

#include <gtest/gtest.h>

#include "stages/extract/extract.hpp"
#include "stages/fit/fit.hpp"
#include "tests/fit/pipes.hpp"

/// A saddle's parameters, from scan to model, keep their sigmas where every view is shifted by an error of its own.
namespace seampath {
namespace saddle_sigma_test {

struct Tally {
    int one = 0, two = 0, all = 0;
    void add(const std::optional<Measured>& measured, double truth) {
        ASSERT_TRUE(measured);
        const double off = std::abs(measured->value - truth);
        one += off < measured->sigma;
        two += off < 2 * measured->sigma;
        ++all;
    }
};

TEST(SaddleSigma, HoldsForEveryParameterOverManyScans) {
    constexpr std::uint64_t kScans = SEAMPATH_SLOWDOWN > 1 ? 4 : 36;
    Tally tally;
    for (const std::optional<double> header : {std::optional<double>(), std::optional(30.0)}) {
        for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
            PipeScene scene;
            scene.header_radius = header;
            scene.offset = header ? 4 : 0;
            scene.registration = 0.015;
            scene.sampling.seed = seed;
            const Extraction extraction = extract(scan_of(scene), {});
            ASSERT_EQ(extraction.seams.size(), 1u) << seed;
            EXPECT_EQ(extraction.views, scene.views) << seed;
            const SeamModel model = fit(extraction.seams.front(), {}, {});
            ASSERT_EQ(model.model, "saddle") << model.reason << ", seed " << seed;
            tally.add(model.saddle->branch_radius_mm, scene.radius);
            tally.add(model.saddle->angle_rad, std::numbers::pi / 2 - scene.lean);
            if (header) {
                tally.add(model.saddle->header_radius_mm, *header);
                tally.add(model.saddle->offset_mm, scene.offset);
            }
        }
    }
    if (SEAMPATH_SLOWDOWN > 1)
        GTEST_SKIP() << "ran, but shares need more scans than instrumented code has time for";
    EXPECT_GT(tally.one, 0.60 * tally.all);
    EXPECT_LT(tally.one, 0.76 * tally.all);
    EXPECT_GT(tally.two, 0.92 * tally.all);
    EXPECT_LT(tally.two, 0.98 * tally.all);
}

}  // namespace saddle_sigma_test
}  // namespace seampath
