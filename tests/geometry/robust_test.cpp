#include "stages/geometry/robust.hpp"

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "datasets/rng.hpp"

namespace seampath {
namespace robust_test {

using Coefficients = QuadraticFit::Coefficients;

const Coefficients kTrue = (Coefficients() << 0.3, -0.2, 0.15, 0.4, -0.1, 0.25).finished();

struct Data {
    Eigen::MatrixXd rows;
    Eigen::VectorXd z;
};

/// Samples of the true quadric with noise; every fifth is `outlier` off when that is not 0.
Data samples(int count, double sigma, double outlier) {
    const Random random(11, 0);
    Data data{Eigen::MatrixXd(count, 6), Eigen::VectorXd(count)};
    for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::uint64_t>(i);
        const double u = random.uniform(8 * k, 0, 1), s = random.uniform(8 * k + 1, -1, 1);
        data.rows.row(i) = QuadraticFit::row(u, s).transpose();
        data.z[i] = data.rows.row(i) * kTrue + sigma * random.normal(4 * k + 1) + (i % 5 == 0 ? outlier : 0);
    }
    return data;
}

QuadraticFit fit_of(const Data& data, double least_scale) {
    QuadraticFit fit;
    fit.begin(static_cast<std::size_t>(data.z.size()));
    for (int i = 0; i < data.z.size(); ++i) {
        fit.add(data.rows(i, 1), data.rows(i, 2), data.z[i]);
    }
    EXPECT_TRUE(fit.solve(least_scale));
    return fit;
}

Coefficients by_qr(const Data& data) {
    return data.rows.colPivHouseholderQr().solve(data.z);
}

TEST(QuadraticFit, OfExactDataIsExact) {
    EXPECT_LT((fit_of(samples(200, 0, 0), 0).coefficients() - kTrue).norm(), 1e-12);
}

TEST(QuadraticFit, EqualsQrWhereNothingIsWeighedDown) {
    // A scale far above the noise leaves all weights at 1.
    const Data data = samples(300, 0.02, 0);
    EXPECT_LT((fit_of(data, 1e6).coefficients() - by_qr(data)).norm(), 1e-10);
}

TEST(QuadraticFit, OfNoisyDataIsNearlyLeastSquaresAndKnowsItsNoise) {
    const Data data = samples(4000, 0.02, 0);
    const QuadraticFit fit = fit_of(data, 0);
    EXPECT_NEAR(fit.scale(), 0.02, 0.001);
    // What 95 % efficiency leaves between the two is a small part of the standard error.
    for (int k = 0; k < 6; ++k) {
        const double standard_error = 0.02 * std::sqrt(fit.cofactors()(k, k));
        EXPECT_NEAR(fit.coefficients()[k], by_qr(data)[k], 0.6 * standard_error) << "coefficient " << k;
        EXPECT_NEAR(fit.coefficients()[k], kTrue[k], 4 * standard_error) << "coefficient " << k;
    }
}

TEST(QuadraticFit, HoldsAgainstAFifthOfOutliers) {
    const Data clean = samples(1000, 0.02, 0), spoilt = samples(1000, 0.02, 0.5);
    const QuadraticFit fit = fit_of(spoilt, 0);
    for (int k = 0; k < 6; ++k) {
        EXPECT_NEAR(fit.coefficients()[k], kTrue[k], 5 * 0.02 * std::sqrt(fit.cofactors()(k, k)))
            << "coefficient " << k;
    }
    EXPECT_GT(std::abs(by_qr(spoilt)[0] - kTrue[0]), 0.05)
        << "plain least squares is not fooled: the outliers test nothing";
    for (std::size_t i = 0; i < fit.size(); ++i) {
        if (i % 5 == 0) {
            EXPECT_EQ(fit.weight(i), 0) << "outlier " << i;
        }
    }
    EXPECT_NEAR(fit.scale(), fit_of(clean, 0).scale(), 0.01);
}

TEST(QuadraticFit, ResidualsAreThoseOfItsCoefficients) {
    const Data data = samples(100, 0.02, 0.5);
    const QuadraticFit fit = fit_of(data, 0);
    for (int i = 0; i < 100; ++i) {
        // Of the last but one round: off by no more than the last step of the weights.
        EXPECT_NEAR(fit.residual(static_cast<std::size_t>(i)), data.z[i] - fit.value(data.rows(i, 1), data.rows(i, 2)),
                    1e-3);
    }
}

/// Noise-free points of a convex round surface of radius 20 that touches z = 0.3 at the origin and is seen from a frame
/// that is `tilt` off; `u`, `s` in lengths of 12 and 9.
QuadraticFit fit_of_round_surface(bool sphere, const Eigen::Vector2d& tilt, bool lengths_known) {
    const double radius = 20, along = 0.6;  // the cylinder's axis lies at this angle to u
    const Eigen::Vector3d up = Eigen::Vector3d(-tilt.x(), -tilt.y(), 1).normalized(),
                          centre = Eigen::Vector3d(0, 0, 0.3) - radius * up;
    const Eigen::Vector3d axis =
        sphere ? Eigen::Vector3d::Zero() : up.cross(Eigen::Vector3d(std::cos(along), std::sin(along), 0)).normalized();
    QuadraticFit fit;
    fit.begin(0, lengths_known ? 12 : 0, lengths_known ? 9 : 0);
    for (double u = -0.2; u <= 1; u += 0.05) {
        for (double s = -1; s <= 1; s += 0.05) {
            // (v + z e)^2 without its part along the axis is radius^2: a quadratic in z.
            const auto across = [&](const Eigen::Vector3d& v) { return Eigen::Vector3d(v - v.dot(axis) * axis); };
            const Eigen::Vector3d v = across(Eigen::Vector3d(12 * u, 9 * s, 0) - centre),
                                  e = across(Eigen::Vector3d::UnitZ());
            const double b = v.dot(e) / e.squaredNorm(), c = (v.squaredNorm() - radius * radius) / e.squaredNorm();
            fit.add(u, s, -b + std::sqrt(b * b - c));
        }
    }
    EXPECT_TRUE(fit.solve(1e-6));
    return fit;
}

TEST(QuadraticFit, KnowsCylindersAndSpheresBeyondTheirParabola) {
    for (const bool sphere : {false, true}) {
        for (const Eigen::Vector2d& tilt :
             {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.03, 0), Eigen::Vector2d(-0.02, 0.03)}) {
            const double parabola = std::abs(fit_of_round_surface(sphere, tilt, false).value(0, 0) - 0.3);
            const QuadraticFit fit = fit_of_round_surface(sphere, tilt, true);
            EXPECT_GT(parabola, 5e-3) << "a parabola does as well: nothing is tested";
            EXPECT_NEAR(fit.value(0, 0), 0.3, 0.1 * parabola) << "sphere " << sphere << " tilt " << tilt.transpose();
            EXPECT_NEAR(fit.coefficients()[1] / 12, tilt.x(), 1e-3);
            EXPECT_NEAR(fit.coefficients()[2] / 9, tilt.y(), 1e-3);
        }
    }
}

TEST(QuadraticFit, RefusesWhatDoesNotDetermineIt) {
    QuadraticFit few, line;
    few.begin(11);
    line.begin(100);
    for (int i = 0; i < 11; ++i) {
        few.add(0.1 * i, std::cos(i), 1);
    }
    for (int i = 0; i < 100; ++i) {
        line.add(0.01 * i, 0.02 * i, 1);
    }
    EXPECT_FALSE(few.solve(0));
    EXPECT_FALSE(line.solve(0));
}

TEST(Quantile, IsByRank) {
    std::vector<double> none, values{5, 1, 4, 2, 3};
    EXPECT_EQ(quantile(none, 0.5), 0);
    EXPECT_EQ(quantile(values, 0), 1);
    EXPECT_EQ(quantile(values, 0.5), 3);
    EXPECT_EQ(quantile(values, 1), 5);
}

// What a sample brackets, and what it does not: values that repeat, values in order, a few that dwarf the rest.
TEST(Quantile, OfManyValuesIsTheOneThatSortingFinds) {
    const Random random(12, 0);
    std::vector<std::vector<double>> sets(4, std::vector<double>(20000));
    for (std::size_t i = 0; i < 20000; ++i) {
        sets[0][i] = random.normal(i);
        sets[1][i] = std::floor(3 * random.uniform(i));
        sets[2][i] = static_cast<double>(i);
        sets[3][i] = i % 79 == 0 ? random.uniform(i) * 1e9 : 0;  // those that the sample takes stand apart
    }
    for (const std::vector<double>& values : sets) {
        std::vector<double> sorted = values;
        std::sort(sorted.begin(), sorted.end());
        for (const double q : {0.0, 1e-4, 0.1, 0.5, 0.997, 0.9999, 1.0}) {
            std::vector<double> reordered = values;
            EXPECT_EQ(quantile(reordered, q), sorted[static_cast<std::size_t>(std::lround(q * 19999))]) << q;
            std::sort(reordered.begin(), reordered.end());
            EXPECT_EQ(reordered, sorted) << "the values are no longer the same";
        }
    }
}

}  // namespace robust_test
}  // namespace seampath
