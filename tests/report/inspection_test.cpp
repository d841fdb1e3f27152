#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/report_checks.hpp"
#include "pipeline/report_sections.hpp"
#include "pipeline/report_torch.hpp"
#include "stages/angle.hpp"
#include "stages/plan/plan.hpp"
#include "tests/report/example_part.hpp"

/// What the report lists, plots and cuts of a seam, against the formulas of the example.
namespace seampath::test {
namespace inspection_test {

TEST(Inspection, ACharacteristicIsOutByAsMuchAsItAndItsGuardExceedTheTolerance) {
    PartResult part = example_part();
    Deviation& deviation = part.deviations[0];
    deviation.p997_mm = 0.095;  // all sigmas are 0.004: a guard of 0.008
    deviation.tolerance_mm = 0.1;
    deviation.coverage = 0.8;
    part.config.validate.min_coverage = 0.85;
    const auto list = characteristics(part, 0);
    ASSERT_EQ(list.size(), 2U);
    EXPECT_NEAR(*list[0].uncertainty, 0.008, 1e-12);
    EXPECT_NEAR(*list[0].out_of_tolerance, 0.003, 1e-12);
    EXPECT_EQ(list[0].verdict(), "fail");
    EXPECT_NEAR(*list[1].deviation(), -20, 1e-12);
    EXPECT_NEAR(*list[1].tolerance, 15, 1e-12);
    EXPECT_NEAR(*list[1].out_of_tolerance, 5, 1e-12);
    EXPECT_NEAR(tolerance_used(deviation), 1.03, 1e-12);

    deviation.p997_mm = 0.09;
    EXPECT_EQ(characteristics(part, 0)[0].verdict(), "pass");
    EXPECT_EQ(*characteristics(part, 0)[0].out_of_tolerance, 0);
}

TEST(Inspection, ADimensionThatIsKnownBeforehandIsTheNominal) {
    PartResult part = example_part();
    EXPECT_EQ(characteristics(part, 0).size(), 2U) << "nothing is known";
    part.config.fit.branch_radius_mm = {29.9, 0.1};
    const auto list = characteristics(part, 0);
    ASSERT_EQ(list.size(), 3U);
    EXPECT_EQ(list[2].name, "branch_radius_mm");
    EXPECT_NEAR(*list[2].deviation(), 0.1, 1e-12);
    EXPECT_EQ(*list[2].uncertainty, 0.004);
    EXPECT_EQ(list[2].verdict(), "") << "it was not toleranced";
}

TEST(Inspection, WorstPlacesAreCheckedOnesATenthOfTheSeamApart) {
    SeamModel model;
    model.closed = true;
    model.length_mm = 100;
    Deviation deviation;
    for (int i = 0; i < 100; ++i) {
        DeviationSample s;
        s.p = {static_cast<double>(i), 0, 0};
        s.station_mm = i + 0.5;
        s.distance_mm = 0.001 * i;
        s.covered = i != 99;
        deviation.samples.push_back(s);
    }
    // 98 is the worst that was checked; 88 the next at a tenth; then 78. Round the end, 0 to 8 are near to 98.
    deviation.samples[3].distance_mm = 0.0975;
    EXPECT_EQ(worst_samples(deviation, model), (std::vector<std::size_t>{98, 88, 78}));
    model.closed = false;
    EXPECT_EQ(worst_samples(deviation, model), (std::vector<std::size_t>{98, 3, 88}));
    for (DeviationSample& s : deviation.samples) {
        s.covered = false;
    }
    EXPECT_TRUE(worst_samples(deviation, model).empty());
}

TEST(Inspection, TorchAnglesAreThoseThatThePlanWasAskedFor) {
    PartResult part = example_part();
    PlanOptions options;
    options.work_angle_deg = 12;
    options.travel_angle_deg = -7;
    part.plan = plan(part.models, options);
    ASSERT_GT(part.plan.travel.size(), 6U);
    for (const TravelSample& s : part.plan.travel) {
        EXPECT_NEAR(s.work_rad, 12 * kDegree, 1e-6);
        EXPECT_NEAR(s.travel_rad, -7 * kDegree, 1e-6);
    }
    EXPECT_NE(torch_plots(part, 0).find("Torch angles"), std::string::npos);
    part.planned_seams = {1};
    part.plan = {};
    EXPECT_EQ(torch_plots(part, 0), "");
}

/// The rib of the example is a wall along x on a plate, both with waves of 0.05 mm; the seam's section shows them as
/// two straight lines at right angles, turned by 45 degrees.
TEST(Inspection, SectionsHoldTheScanAndEndTheTracesOnTheFlanks) {
    const PartResult part = example_part();
    const auto seams = seam_sections(part);
    ASSERT_EQ(seams.size(), 2U);
    const SeamSections& rib = seams[1];
    ASSERT_GT(rib.sections.size(), 50U);
    EXPECT_LT(rib.sections.front().sample.station_mm, 1);
    EXPECT_GT(rib.sections.back().sample.station_mm, 115);
    const float half = std::sqrt(0.5F);
    const Eigen::Vector2f wall(-half, half), plate(half, half);  // normals: y and z; travel is x
    for (const SeamSection& section : rib.sections) {
        ASSERT_GT(section.points.size(), 100U);
        for (const Eigen::Vector2f& p : section.points) {
            EXPECT_LT(std::min(std::abs(p.dot(wall)), std::abs(p.dot(plate))), 0.06F) << p.transpose();
            EXPECT_LE(p.norm(), static_cast<float>(rib.reach_mm) + 1e-4F);
        }
        ASSERT_EQ(section.traces.size(), 2U);
        for (std::size_t k = 0; k < 2; ++k) {
            const double offset = k == 0 ? section.sample.flank1_mm : section.sample.flank2_mm;
            const Eigen::Vector2f& n = k == 0 ? wall : plate;
            for (const Eigen::Vector2f& q : section.traces[k]) {
                EXPECT_NEAR(static_cast<double>(q.dot(n)), -offset, 1e-5);
            }
            EXPECT_GT(section.traces[k].back().norm(), 0.8F * static_cast<float>(rib.reach_mm));
        }
    }
}

TEST(Inspection, SectionsOfManySeamsShareTheirRoomInThePage) {
    PartResult part = example_part();
    for (int i = 0; i < 40; ++i) {
        part.extraction.seams.push_back(part.extraction.seams[1]);
        part.models.push_back(part.models[1]);
        part.deviations.push_back(part.deviations[1]);
    }
    std::size_t sections = 0;
    for (const SeamSections& seam : seam_sections(part)) {
        EXPECT_GE(seam.sections.size(), 3U);
        sections += seam.sections.size();
    }
    EXPECT_LE(sections, 300 + 3 * part.models.size());
}

}  // namespace inspection_test
}  // namespace seampath::test
