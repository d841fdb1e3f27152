#include <gtest/gtest.h>

#include "tests/extract/support.hpp"

/// Views of one part are shifted against each other: a seam lies at the mean of the shifts, whatever each view saw
/// most.
namespace seampath {
namespace view_shifts_test {

using Eigen::Vector3d;

/// A view of a corner along the x axis with points `pitch` mm apart; of its wall only what is nearer than `height`.
void add_view(std::vector<Eigen::Vector3f>& points, double pitch, double height, const Vector3d& shift,
              std::uint64_t seed, const Vector3d& up_the_wall = Vector3d::UnitZ()) {
    const std::size_t begin = points.size();
    for (double x = 0; x < 60; x += pitch) {
        const Sampling sampling{pitch, 0.03, seed};
        add_rectangle(points, {x, 0, 0}, Vector3d::UnitX(), pitch, Vector3d::UnitY(), 20, sampling);
        add_rectangle(points, {x, 0, 0}, Vector3d::UnitX(), pitch, up_the_wall, height, sampling);
    }
    std::for_each(points.begin() + static_cast<std::ptrdiff_t>(begin), points.end(),
                  [&](auto& p) { p += shift.cast<float>(); });
}

Vector3d mean_of_seam(const std::vector<Eigen::Vector3f>& points, std::size_t views) {
    const Extraction extraction = extract(scan_of_points(points), {});
    EXPECT_EQ(extraction.seams.size(), 1u);
    EXPECT_EQ(extraction.views, static_cast<int>(views));
    Vector3d mean = Vector3d::Zero();
    for (const SeamPoint& point : extraction.seams.at(0).points) {
        mean += point.p / static_cast<double>(extraction.seams[0].points.size());
    }
    return mean;
}

// By their points the first view would count for two thirds, and the seam lie at (0.02, -0.02).
TEST(ViewShifts, AViewOfMorePointsCountsForNoMore) {
    std::vector<Eigen::Vector3f> points;
    add_view(points, 0.25, 20, {0, 0.04, -0.04}, 1);
    add_view(points, 0.5, 20, {0, -0.02, 0.02}, 2);
    add_view(points, 0.5, 20, {0, -0.02, 0.02}, 3);
    const Vector3d seam = mean_of_seam(points, 3);
    EXPECT_NEAR(seam.y(), 0, 0.006);
    EXPECT_NEAR(seam.z(), 0, 0.006);
}

// Only the first two views see enough of the wall; what the plate tells of the others must not move it.
TEST(ViewShifts, WhatOneFlankTellsIsNotTakenForTheOther) {
    std::vector<Eigen::Vector3f> points;
    add_view(points, 0.4, 20, {0, 0.03, 0.03}, 1);
    add_view(points, 0.4, 20, {0, -0.03, -0.03}, 2);
    add_view(points, 0.4, 0.4, {0, 0.05, 0.03}, 3);
    add_view(points, 0.4, 0.4, {0, 0.05, -0.03}, 4);
    const Vector3d seam = mean_of_seam(points, 4);
    EXPECT_NEAR(seam.y(), 0, 0.006);
    EXPECT_NEAR(seam.z(), 0, 0.006);
}

// Where a wall leans, a shift of its normal alone would move the seam further; but what shifts a view moves plate and
// wall together, and the seam by no more than the view.
TEST(ViewShifts, MoveBothFlanksOfAnOpenCornerTogether) {
    const auto sigma = [](const Vector3d& up_the_wall) {
        std::vector<Eigen::Vector3f> points;
        for (std::uint64_t view = 0; view < 6; ++view) {
            const Random random(7, view);
            const Vector3d shift = 0.03 * Vector3d(random.normal(0), random.normal(1), random.normal(2));
            add_view(points, 0.5, 20, shift, view, up_the_wall);
        }
        const Extraction extraction = extract(scan_of_points(points), {});
        EXPECT_EQ(extraction.views, 6);
        EXPECT_EQ(extraction.seams.size(), 1u);
        const auto& seam = extraction.seams.at(0).points;
        return seam.at(seam.size() / 2).sigma_mm / extraction.registration_mm;
    };
    const double square = sigma(Vector3d::UnitZ());
    EXPECT_NEAR(sigma(Vector3d(0, -1, 1).normalized()) / square, 1, 0.15);
    EXPECT_NEAR(square, std::sqrt(2.0 / 6), 0.15);
}

}  // namespace view_shifts_test
}  // namespace seampath
