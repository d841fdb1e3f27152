#include <cmath>

#include <gtest/gtest.h>

#include "stages/geometry/bending.hpp"
#include "tests/papers/parametrized.hpp"

namespace seampath {
namespace marin_test {

using Eigen::VectorXd;

TEST(Marin, TableOneInAllDigits) {
    const auto z = paper_column("marin_table_1.csv", 0);
    const Parametrization least = solved(as_points(z), Objective::exact);
    EXPECT_LT(worst_difference(least.t, paper_column("marin_table_1.csv", 1)), 5e-5);
    EXPECT_NEAR(least.exact_energy, 6564.8241, 5e-5);
    EXPECT_NEAR(least.max_acceleration[0], 140.3370, 5e-5);
    EXPECT_NEAR(solved(as_points(z), Objective::chord).exact_energy, 7895.1, 0.05);
}

TEST(Marin, TableOneBendsEquallyAtEveryTurn) {
    const auto z = paper_column("marin_table_1.csv", 0);
    const VectorXd h = closed_form_spacing(z);
    // G* = 3 S^4, theta'' = +-3 S^2 at the turns, S the sum of eps_j sqrt|D_j| (corollary 3); the data turn at 0.2,
    // 0.1, 0.4, ... everywhere but at 0.0 in the middle
    const std::vector<double> turns{0, 0.2, 0.1, 0.4, -0.1, 0, -0.3, 0.2, 0, 0.5, 0.4};
    double s = 0;
    for (std::size_t j = 1; j < turns.size(); ++j) {
        s += (j == 1 || j + 1 == turns.size() ? 1 : std::sqrt(2)) * std::sqrt(std::abs(turns[j] - turns[j - 1]));
    }
    const std::vector<double> one{1};
    const Bending bending(as_matrix(as_points(z)), one);
    EXPECT_NEAR(bending.exact(h) / (3 * std::pow(s, 4)), 1, 1e-12);
    EXPECT_NEAR(bending.largest(h)[0] / (3 * s * s), 1, 1e-12);
}

TEST(Marin, TableThreeAndBetter) {
    const Points points = paper_points("marin_table_2.csv");
    const Parametrization chord = solved(points, Objective::chord);
    const Parametrization exact = solved(points, Objective::exact);
    const Parametrization diagonal = solved(points, Objective::diagonal);
    EXPECT_LT(worst_difference(chord.t, paper_column("marin_table_3.csv", 0)), 5.1e-5);
    EXPECT_NEAR(chord.exact_energy, 247.9026, 5e-5);
    EXPECT_NEAR(exact.exact_energy, 173.511527, 5e-7);
    const auto printed = paper_column("marin_table_3.csv", 1);
    EXPECT_LT(worst_difference(exact.t, printed), 2.65e-4) << "the paper stopped early";
    EXPECT_EQ(within_a_digit(printed, exact.t), 13) << "of 20";
    EXPECT_NEAR(diagonal.diagonal_energy, 236.905843, 5e-7);
    EXPECT_LT(worst_difference(diagonal.t, paper_column("marin_table_3.csv", 2)), 1.25e-4);
    const std::vector<double> ones{1, 1};
    const Bending bending(as_matrix(points), ones);
    EXPECT_NEAR(bending.exact(spacing(paper_column("marin_table_3.csv", 1))), 173.5177, 5e-5) << "at the print";
    EXPECT_NEAR(bending.diagonal(spacing(paper_column("marin_table_3.csv", 2))), 236.9074, 5e-5) << "at the print";
}

TEST(Marin, TableSixAndBetter) {
    const Points points = paper_points("marin_table_4.csv");
    EXPECT_LT(worst_difference(solved(points, Objective::chord).t, paper_column("marin_table_6.csv", 0)), 5.5e-5)
        << "the angles are rounded, too";
    const Parametrization diagonal = solved(points, Objective::diagonal, kRobotWeights);
    EXPECT_NEAR(diagonal.diagonal_energy, 6414.5394, 5e-5);
    EXPECT_LT(worst_difference(diagonal.t, paper_column("marin_table_6.csv", 2)), 9.5e-5);
    EXPECT_NEAR(solved(points, Objective::exact, kRobotWeights).exact_energy, 6834.7495, 5e-5);
    const Bending bending(as_matrix(points), kRobotWeights);
    const VectorXd printed = spacing(paper_column("marin_table_6.csv", 2));
    EXPECT_NEAR(bending.diagonal(printed), 6414.563, 5e-4);
    EXPECT_NEAR(bending.exact(printed), 6967.73, 5e-3);
}

TEST(Marin, TableSevenToItsTwoDigits) {
    const Bending bending(as_matrix(paper_points("marin_table_4.csv")), kRobotWeights);
    for (std::size_t column = 0; column < 3; ++column) {
        const auto largest = bending.largest(spacing(paper_column("marin_table_6.csv", column)));
        const auto printed = paper_column("marin_table_7.csv", column);
        for (std::size_t axis = 0; axis < 6; ++axis) {
            const double digit = printed[axis] >= 1000 ? 100 : 10;
            const bool corrected = column == 2 && axis == 3;
            EXPECT_NEAR(largest[axis], printed[axis], corrected ? 0.5 : 0.5 * digit)
                << "column " << column << ", axis " << axis + 1;
        }
    }
}

TEST(Marin, WorkCentreParametersFollowFromTableFiveButForRowThree) {
    const WorkCentre centre = work_centre();
    EXPECT_LT(centre.worst, 1e-4) << "of 16 parameters";
    EXPECT_NEAR(centre.over_row_3, 0.826, 5e-4);
    EXPECT_NEAR(centre.over_row_3_by_t, 0.775, 5e-4);
}

TEST(Marin, PeaksAndTravelTimesOfThePrintedParameters) {
    const Bending bending(as_matrix(paper_points("marin_table_4.csv")), kRobotWeights);
    const std::vector<double> peaks{314.0, 381.3, 137.1}, times{17.72, 19.53, 11.71};
    for (std::size_t column = 0; column < 3; ++column) {
        const auto largest = bending.largest(spacing(paper_column("marin_table_6.csv", column)));
        double peak = 0;
        for (std::size_t axis = 0; axis < 6; ++axis) {
            peak = std::max(peak, largest[axis] / kRobotWeights[axis]);
        }
        EXPECT_NEAR(peak, peaks[column], 0.05) << column;
        EXPECT_NEAR(std::sqrt(peak), times[column], 5e-3) << column;
    }
}

TEST(Marin, LeastPeakShortensTheTravel) {
    const Points points = paper_points("marin_table_4.csv");
    const auto peak = [&](Objective objective) { return solved(points, objective, kRobotWeights).peak; };
    const double minimax = peak(Objective::minimax);
    EXPECT_LT(minimax, 80.77) << "found before by other means";
    EXPECT_NEAR(minimax, 80.25212, 2e-4) << "by sequential linear programming from 17 starts";
    EXPECT_NEAR(peak(Objective::exact), 121.3, 0.05);
    EXPECT_NEAR(std::sqrt(peak(Objective::exact)), 11.01, 5e-3);
    EXPECT_NEAR(peak(Objective::diagonal), 137.05, 0.05);
    EXPECT_NEAR(std::sqrt(minimax), 8.958, 5e-4) << "travel time in s for limits in rad/s^2";
    EXPECT_NEAR(1 - std::sqrt(minimax / peak(Objective::diagonal)), 0.235, 5e-4) << "of the paper's best is saved";
}

TEST(Marin, InOneDimensionLeastPeakAndLeastEnergyAgree) {
    const auto points = as_points(paper_column("marin_table_1.csv", 0));
    EXPECT_NEAR(solved(points, Objective::minimax).peak / solved(points, Objective::exact).peak, 1, 1e-5);
}

}  // namespace marin_test
}  // namespace seampath
