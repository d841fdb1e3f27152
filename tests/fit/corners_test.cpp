#include <gtest/gtest.h>

#include "tests/fit/models.hpp"

namespace seampath {
namespace corners_test {

using Eigen::Vector3d;

/// A rectangle with rounded corners, once round.
struct RoundedBox {
    double length, width, radius;
    double turn() const { return radius * kPi / 2; }
    double perimeter() const { return 2 * (length + width) - 8 * radius + 4 * turn(); }
    Vector3d operator()(double x) const {
        double s = (x - std::floor(x)) * perimeter();
        Eigen::Vector2d at(radius, 0), ahead(1, 0);
        for (int side = 0;; ++side) {
            const double straight = (side % 2 == 0 ? length : width) - 2 * radius;
            const Eigen::Vector2d left(-ahead.y(), ahead.x());
            if (s <= straight || side == 4) {
                return Vector3d(at.x() + s * ahead.x(), at.y() + s * ahead.y(), 0);
            }
            at += straight * ahead;
            s -= straight;
            const double angle = std::min(s, turn()) / radius;
            at += radius * (std::sin(angle) * ahead + (1 - std::cos(angle)) * left);
            if (s < turn()) {
                return Vector3d(at.x(), at.y(), 0);
            }
            s -= turn();
            ahead = left;
        }
    }
};

Seam points_of(const RoundedBox& box, double spacing, double sigma, std::uint64_t seed) {
    return noisy(seam_along(box, static_cast<int>(box.perimeter() / spacing), true), sigma, seed);
}

TEST(Fit, FollowsTheCornersOfABox) {
    const RoundedBox box{110, 80, 10};
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
        EXPECT_LT(largest_error(model_of(points_of(box, 0.95, 0.02, seed)), box), 0.1) << "seed " << seed;
    }
}

TEST(Fit, FollowsCornersOfAnyRadius) {
    for (const double radius : {3.0, 5.0, 10.0, 20.0}) {
        for (const double spacing : {0.5, 1.0, 1.5, 2.0}) {
            for (const std::uint64_t seed : {1, 2}) {
                const RoundedBox box{110, 80, radius};
                EXPECT_LT(largest_error(model_of(points_of(box, spacing, 0.02, seed)), box), 0.1)
                    << "radius " << radius << ", spacing " << spacing << ", seed " << seed;
            }
        }
    }
}

// The better the points, the more a corner looks as if it were off.
TEST(Fit, FollowsCornersOfPrecisePoints) {
    for (const double radius : {3.0, 10.0}) {
        for (const double sigma : {0.001, 0.005}) {
            const RoundedBox box{110, 80, radius};
            EXPECT_LT(largest_error(model_of(points_of(box, 1, sigma, 3)), box), 0.02)
                << "radius " << radius << ", sigma " << sigma;
        }
    }
}

// On an arc that turns by 11 degrees from point to point, one that is off by little could as well be right.
TEST(Fit, HoldsAgainstSingleOutliersAtCornersToo) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        const RoundedBox box{110, 80, 5};
        Seam seam = points_of(box, 0.95, 0.02, seed);
        const Random random(seed, 9);
        std::size_t outliers = 0;
        for (std::size_t i = 0; i < seam.points.size(); i += 15 + random.bits(i) % 11) {  // one in twenty
            const double direction = random.uniform(3 * i + 1000, 0, 2 * kPi),
                         length = random.uniform(3 * i + 1001, 0.5, 2);
            seam.points[i].p +=
                length * (std::cos(direction) * seam.points[i].n1 + std::sin(direction) * seam.points[i].n2);
            ++outliers;
        }
        EXPECT_GT(outliers, seam.points.size() / 25);
        EXPECT_LT(largest_error(model_of(seam), box), 0.15) << "seed " << seed;
    }
}

}  // namespace corners_test
}  // namespace seampath
