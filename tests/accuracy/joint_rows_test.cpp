#include "tests/accuracy/joint_rows.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// The table of what every kind of joint must reach.
namespace seampath {
namespace joint_rows_test {

const JointRow& row_of(const std::vector<JointRow>& rows, const std::string& name) {
    return *std::find_if(rows.begin(), rows.end(), [&](const JointRow& row) { return row.name == name; });
}

TEST(JointRows, HaveEveryKindAndEveryScannerThatIsAskedFor) {
    std::vector<std::string> names;
    for (const JointRow& row : joint_rows()) {
        names.push_back(row.name);
    }
    EXPECT_THAT(names, testing::IsSupersetOf({"tee", "box-on-plate", "pipe-on-plate", "corner", "pipe-on-pipe-oblique",
                                              "s-curve", "lap on an s-curve", "butt on an arc", "v-groove on an arc",
                                              "phoxi_s, tee", "zivid2p_m60, butt", "gocator2440_robot, v-groove",
                                              "ljx8200_robot, lap", "rgbd, tee", "worst, lap", "sigma, saddle"}));
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

TEST(JointRows, AreMeasuredOverScansOfOtherSeeds) {
    const auto rows = joint_rows();
    const JointResult laps = measure_row(row_of(rows, "sigma, lap"), 2, 2);
    EXPECT_EQ(laps.scans, 2);
    EXPECT_EQ(laps.seams, 2u);
    EXPECT_EQ(laps.wrong, 0u);
    EXPECT_GE(laps.rms_mm, laps.all_rms_mm);
    EXPECT_LT(laps.rms_mm, 0.05);
    EXPECT_GT(laps.common_mm, 0.002);
    EXPECT_LT(std::abs(laps.all_rms_mm - std::hypot(laps.common_mm, laps.apart_mm)), 0.005);
    EXPECT_GT(laps.found, 0.97);
    EXPECT_EQ(laps.parameters, 0u);
    const JointResult saddle = measure_row(row_of(rows, "sigma, saddle"), 2, 1);
    EXPECT_EQ(saddle.parameters, 4u) << "two radii, angle and offset";
}

TEST(JointRows, NameEachLimitThatIsMissed) {
    JointResult r;
    r.rms_mm = 0.5;
    r.max_mm = 0.02;
    r.across_rms_mm = 0.01;
    r.depth_max_mm = 0.2;
    r.found = 0.9;
    r.false_share = 0.1;
    r.wrong = 1;
    r.within_1_sigma = 0.7;
    r.within_2_sigma = 0.99;
    r.parameters = 10;
    r.parameters_1_sigma = 5;
    r.parameters_2_sigma = 9;
    EXPECT_THAT(missed(r, {{{0.01, 0.03}}, {}, 0.99, 0.0}),
                testing::ElementsAre("rms 0.5000 > 0.010", "not found 0.1000 > 0.010", "false 0.1000 > 0.000",
                                     "1 passed and wrong"));
    EXPECT_THAT(missed(r, {{{0.01, 0.03}}, {{0.06, 0.15}}, 0.9, {}}),
                testing::ElementsAre("depth max 0.2000 > 0.150", "1 passed and wrong"));
    r.wrong = 0;
    EXPECT_THAT(missed(r, {{}, {}, 0, {}, true}),
                testing::ElementsAre("points within 2 sigma 0.990 not in 0.92 to 0.98",
                                     "parameters within 1 sigma 0.500 not in 0.60 to 0.76",
                                     "parameters within 2 sigma 0.900 not in 0.92 to 0.98"));
}

}  // namespace joint_rows_test
}  // namespace seampath
