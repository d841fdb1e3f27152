#include "stages/geometry/robust.hpp"

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "datasets/rng.hpp"

namespace seampath {
namespace {

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

}  // namespace
}  // namespace seampath
