#include <gtest/gtest.h>

#include "tests/fit/models.hpp"

namespace seampath {
namespace {

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

// Known miss: at some seeds an arc is taken for outliers and cut by up to 0.25 mm.
TEST(Fit, DISABLED_FollowsTheCornersOfABox) {
    const RoundedBox box{110, 80, 10};
    const int points = static_cast<int>(box.perimeter() / 0.95);
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
        EXPECT_LT(largest_error(model_of(noisy(seam_along(box, points, true), 0.02, seed)), box), 0.1)
            << "seed " << seed;
    }
}

}  // namespace
}  // namespace seampath
