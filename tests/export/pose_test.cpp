#include "stages/geometry/pose.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace seampath {
namespace pose_test {

constexpr double kPi = std::numbers::pi;

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

TEST(Pose, RotationAngleIsExactWhereACosineIsNot) {
    const Eigen::Quaterniond start = about({1, 2, 3}, 0.7);
    for (const double angle : {0.0, 1e-12, 1e-9, 1e-4, 0.5, kPi / 2, 3.0, kPi - 1e-9, kPi}) {
        const Eigen::Quaterniond turned = start * about({-2, 1, 0.3}, angle);
        EXPECT_NEAR(rotation_angle(start, turned), angle, 1e-15 + 1e-9 * (angle > 3)) << angle;
        EXPECT_NEAR(rotation_angle(start, Eigen::Quaterniond(-turned.coeffs())), angle, 1e-15 + 1e-9 * (angle > 3));
    }
}

TEST(Pose, RotationVectorGoesBack) {
    std::mt19937_64 generator(3);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector3d axis(normal(generator), normal(generator), normal(generator));
        const double angle = i < 200   ? std::pow(10, -1 - i / 16.0)
                             : i < 400 ? kPi - std::pow(10, -1 - (i - 200) / 16.0)
                                       : kPi * i / 2000;
        const Eigen::Vector3d vector = rotation_vector(about(axis, angle));
        EXPECT_LT((vector - angle * axis.normalized()).norm(), 1e-14 + 4e-16 * angle) << angle;
        EXPECT_LT((rotation_vector(Eigen::Quaterniond(-about(axis, angle).coeffs())) - vector).norm(), 1e-15);
    }
}

TEST(Pose, RotationVectorAtItsEnds) {
    EXPECT_EQ(rotation_vector(Eigen::Quaterniond::Identity()), Eigen::Vector3d::Zero());
    EXPECT_EQ(rotation_vector(Eigen::Quaterniond(-1, 0, 0, 0)), Eigen::Vector3d::Zero());
    EXPECT_EQ(rotation_vector(Eigen::Quaterniond(0, 1, 0, 0)), Eigen::Vector3d(kPi, 0, 0));
    EXPECT_EQ(rotation_vector(Eigen::Quaterniond(0, 0, -1, 0)), Eigen::Vector3d(0, -kPi, 0));
}

TEST(Pose, NearestSignNeverLooksAway) {
    const Eigen::Quaterniond q = about({1, 0, 1}, 2), away(-q.coeffs());
    EXPECT_EQ(nearest_sign(away, q).coeffs(), q.coeffs());
    EXPECT_EQ(nearest_sign(q, q).coeffs(), q.coeffs());
}

TEST(Pose, DistanceToSegment) {
    const Eigen::Vector3d a(0, 0, 0), b(10, 0, 0);
    EXPECT_EQ(distance_to_segment({5, 3, 4}, a, b), 5);
    EXPECT_EQ(distance_to_segment({-3, 4, 0}, a, b), 5) << "before the start";
    EXPECT_EQ(distance_to_segment({13, 0, 4}, a, b), 5) << "beyond the end";
    EXPECT_EQ(distance_to_segment({0, 3, 4}, a, a), 5) << "no length";
}

}  // namespace pose_test
}  // namespace seampath
