#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/dataset.hpp"
#include "datasets/score.hpp"
#include "pipeline/tables.hpp"
#include "stages/fit/fit.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/place/place.hpp"
#include "stages/validate/validate.hpp"
#include "tests/accuracy/measure.hpp"
#include "tests/extract/support.hpp"

namespace seampath {
namespace groove_test {

constexpr double kDegree = std::numbers::pi / 180;

struct Case {
    const char* name;
    SceneOptions scene;
};

SceneOptions plates(double gap, double mismatch, double root_face, double included, bool single = false,
                    Course course = Course::straight) {
    SceneOptions o;
    o.kind = SceneKind::v_groove;
    o.vary = false;
    o.length_mm = 60;
    o.margin_mm = 25;
    o.course_radius_mm = 150;
    o.gap_mm = gap;
    o.mismatch_mm = mismatch;
    o.root_face_mm = root_face;
    o.included_angle_deg = included;
    o.single_bevel = single;
    o.course = course;
    return o;
}

/// The number's median over the stations lies as near to the truth as its sigmas say.
void expect_number(const Seam& seam, Measured GrooveStation::*number, double truth, const char* what) {
    std::vector<double> value, sigma;
    for (const GrooveStation& station : seam.groove) {
        value.push_back((station.*number).value);
        sigma.push_back((station.*number).sigma);
    }
    const double typical = quantile(sigma, 0.5);
    EXPECT_GT(typical, 0) << what;
    EXPECT_NEAR(quantile(value, 0.5), truth, 3 * typical) << what;
}

void expect_groove(const Seam& seam, const Groove& truth, const SeamPoint& first, const TruthPoint& true_first) {
    // Found from either end: then sides 1 and 2 have changed places.
    const bool turned = first.n1.cross(first.n2).dot(true_first.tangent) < 0;
    expect_number(seam, &GrooveStation::gap_mm, truth.gap_mm, "gap");
    expect_number(seam, &GrooveStation::mismatch_mm, (turned ? -1 : 1) * truth.mismatch_mm, "mismatch");
    expect_number(seam, &GrooveStation::bevel1_rad, (turned ? truth.bevel_2_deg : truth.bevel_1_deg) * kDegree, "1");
    expect_number(seam, &GrooveStation::bevel2_rad, (turned ? truth.bevel_1_deg : truth.bevel_2_deg) * kDegree, "2");
    expect_number(seam, &GrooveStation::included_angle_rad, truth.included_angle_deg * kDegree, "included angle");
    expect_number(seam, &GrooveStation::depth_mm, truth.depth_mm, "depth");
    // Ours ends at the root, the truth's at the underside.
    expect_number(seam, &GrooveStation::area_mm2, truth.area_mm2 - truth.gap_mm * truth.root_face_mm, "area");
}

class GrooveScene : public ::testing::TestWithParam<Case> {};

TEST_P(GrooveScene, IsMeasured) {
    const Dataset data = make_dataset(GetParam().scene, preset("standard"), 3);
    const Extraction found = extract(scan_of_points(data.points), {});
    ASSERT_EQ(found.seams.size(), 1u);
    const Seam& seam = found.seams.front();
    EXPECT_EQ(seam.kind, JointKind::v_groove);
    EXPECT_NE(seam.kind_reason.find("bevel"), std::string::npos);
    ASSERT_EQ(seam.groove.size(), seam.points.size());
    const Score result = score(found.seams, data.truth);
    EXPECT_LT(result.rms_mm, 0.06);
    EXPECT_LT(result.max_mm, 0.15);
    EXPECT_GT(result.found, 0.97);
    EXPECT_EQ(result.false_share, 0);
    EXPECT_EQ(result.repeated_share, 0);
    EXPECT_EQ(result.wrong_kind_share, 0);
    expect_groove(seam, *data.truth.seams.front().groove, seam.points.front(), data.truth.seams.front().points.front());
}

INSTANTIATE_TEST_SUITE_P(Extract, GrooveScene,
                         ::testing::Values(Case{"GapAndFace", plates(2, 0, 1.5, 70)},
                                           Case{"NoGapNoFace", plates(0, 0, 0, 70)},
                                           Case{"Mismatch", plates(1.5, 1, 1, 80)},
                                           Case{"SingleBevel", plates(2, 0.4, 1.5, 50, true)},
                                           Case{"Arc", plates(2, 0.3, 1.5, 80, false, Course::arc)}),
                         [](const auto& tested) { return tested.param.name; });

// Deep and narrow: no view reaches the root (12, 28), or one bevel's end only (20), and a bevel seems to end where a
// shadow begins. Such a seam must say that it is unsure, and get no program.
class DeepGroove : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Grooves, DeepGroove, testing::Values(12, 20, 28), testing::PrintToStringParamName());

TEST_P(DeepGroove, WithoutASecondWitnessIsNotSure) {
    SceneOptions scene;
    scene.kind = SceneKind::v_groove;
    scene.length_mm = 70;
    scene.margin_mm = 18;
    const Dataset dataset = make_dataset(scene, {}, GetParam());
    const Scan scan = scan_of(dataset);
    const Extraction extraction = extract(scan, {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    const Seam& seam = extraction.seams.front();
    std::size_t kept = 0;
    for (const SeamPoint& point : seam.points) {
        double off = 1e300;
        for (const TruthPoint& t : dataset.truth.seams.front().points) {
            off = std::min(off, (point.p - t.p).norm());
        }
        kept += off < 2 * point.sigma_mm;
    }
    EXPECT_GE(kept, 0.92 * static_cast<double>(seam.points.size()));
    EXPECT_THAT(seam.kind_reason, testing::HasSubstr("shadow"));
    EXPECT_FALSE(validate(fit(seam, place(seam, {}), {}), scan, {}).pass);
}

// A line profiler that looks down into the groove sees the bevels turn into the root faces: they end there, though the
// faces' first points still lie close to the bevels' lines, and nothing need confirm it.
class GrooveWithRootFaces : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Grooves, GrooveWithRootFaces, testing::Values(3, 5, 6, 7, 8),
                         testing::PrintToStringParamName());

TEST_P(GrooveWithRootFaces, EndsWhereItTurns) {
    SceneOptions scene;
    scene.kind = SceneKind::v_groove;
    scene.length_mm = 14;
    scene.margin_mm = 8;
    scene.plate_thickness_mm = 6;
    ScannerOptions scanner = preset("gocator2440_robot");
    scanner.views = 3;
    const Dataset dataset = make_dataset(scene, scanner, GetParam());
    const Extraction extraction = extract(scan_of(dataset), {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    const Score result = score(extraction.seams, dataset.truth);
    EXPECT_LT(result.rms_mm, 0.06);
    EXPECT_LT(result.max_mm, 0.1);
    EXPECT_THAT(extraction.seams.front().kind_reason, testing::Not(testing::HasSubstr("shadow")));
}

TEST(Grooves, AreNoneInAFillet) {
    SceneOptions o;
    o.length_mm = 60;
    const Dataset data = make_dataset(o, preset("standard"), 1);
    ExtractOptions options;
    const Extraction found = extract(scan_of_points(data.points), options);
    ASSERT_EQ(found.seams.size(), 2u);
    for (const Seam& seam : found.seams) {
        EXPECT_EQ(seam.kind, JointKind::fillet);
        EXPECT_TRUE(seam.groove.empty());
    }
    options.joint = JointChoice::v_groove;
    const Extraction none = extract(scan_of_points(data.points), options);
    EXPECT_TRUE(none.seams.empty());
    ASSERT_FALSE(none.remarks.empty());
    EXPECT_NE(none.remarks.front().find("the scan shows a fillet"), std::string::npos);
}

TEST(Grooves, AreSaidToBeThereWhenAnotherJointIsAskedFor) {
    const Dataset data = make_dataset(plates(0, 0, 0, 70), preset("standard"), 3);
    ExtractOptions options;
    options.joint = JointChoice::fillet;
    const Extraction found = extract(scan_of_points(data.points), options);
    for (const Seam& seam : found.seams) {
        EXPECT_EQ(seam.kind, JointKind::fillet);
    }
    EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) {
        return remark.find("shows a v-groove") != std::string::npos;
    }));
}

/// The deviation of a model is that which it was moved by, whatever the extracted points say.
TEST(Grooves, AreValidatedByTheirScan) {
    const Dataset data = make_dataset(plates(2, 0.3, 1.5, 75), preset("standard"), 4);
    const Extraction found = extract(scan_of_points(data.points), {});
    ASSERT_EQ(found.seams.size(), 1u);
    SeamModel model = fit(found.seams.front(), place(found.seams.front(), {}), {});
    const Deviation right = validate(model, scan_of_points(data.points), {});
    EXPECT_TRUE(right.pass) << right.verdict;
    EXPECT_GT(right.coverage, 0.98);
    EXPECT_LT(right.rms_mm, 0.06);
    const SeamPoint& middle = found.seams.front().points[found.seams.front().points.size() / 2];
    const Eigen::Vector3d up = (middle.n1 + middle.n2).normalized();
    for (Eigen::Vector3d& control : model.curve.control) {
        control += 0.4 * up;
    }
    const Deviation moved = validate(model, scan_of_points(data.points), {});
    EXPECT_FALSE(moved.pass);
    EXPECT_NEAR(moved.p50_mm, 0.4, 0.08);
    EXPECT_NEAR(moved.signed_mean_mm, 0.4 * up.dot(0.5 * (middle.n1 + middle.n2)), 0.06);
}

// Bevels of a few point distances, beside tops that hold many more points; and a plate not much longer than the window
// that tells a bevel's place, up to whose ends the seam is to be measured.
struct SmallGroove {
    const char* name;
    double length_mm, plate_mm, root_face_mm, gap_mm, mismatch_mm, included_angle_deg;
    const char* preset;
};
class SmallGrooves : public testing::TestWithParam<SmallGroove> {};
INSTANTIATE_TEST_SUITE_P(Grooves, SmallGrooves,
                         testing::Values(SmallGroove{"ShallowBevels", 40, 6, 2.7, 2.2, 1.3, 63, "standard"},
                                         SmallGroove{"ShortPlate", 14, 4, 1.7, 1.2, 0.2, 74, "gocator2440_robot"},
                                         SmallGroove{"ShortSteepPlate", 14, 4, 1.6, 1.2, 0.9, 76, "ljx8200_robot"}),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(SmallGrooves, AreValidatedUpToTheirEnds) {
    const SmallGroove& groove = GetParam();
    SceneOptions scene = plates(groove.gap_mm, groove.mismatch_mm, groove.root_face_mm, groove.included_angle_deg);
    scene.length_mm = groove.length_mm;
    scene.plate_thickness_mm = groove.plate_mm;
    scene.margin_mm = 9;
    for (const std::uint64_t seed : {3, 4}) {
        const Scan scan = scan_of(make_dataset(scene, preset(groove.preset), seed));
        const Extraction extraction = extract(scan, {});
        ASSERT_EQ(extraction.seams.size(), 1u) << seed;
        const Seam& seam = extraction.seams.front();
        const Deviation deviation = validate(fit(seam, place(seam, {}), {}), scan, {});
        EXPECT_TRUE(deviation.pass) << seed << ": " << deviation.verdict;
        EXPECT_EQ(deviation.coverage, 1) << seed;
        EXPECT_LT(deviation.max_mm, 0.1) << seed;
    }
}

TEST(GrooveCsv, HasANumberAndItsSigmaAtEveryPointAndAnEmptyCellWhereNotSeen) {
    Seam seam;
    seam.kind = JointKind::v_groove;
    for (int i = 0; i < 2; ++i) {
        seam.points.push_back({{2.0 * i, 0, 0}, {0, 0, 1}, {0, 1, 0}, 0.02});
        GrooveStation station;
        station.gap_mm = {1.5, 0.25};
        station.bevel1_rad = {30 * kDegree, kDegree};
        seam.groove.push_back(station);
    }
    const std::string csv = groove_csv({Seam{}, seam});
    EXPECT_TRUE(
        csv.starts_with("seam,index,station_mm,gap_mm,gap_sigma_mm,mismatch_mm,mismatch_sigma_mm,"
                        "included_angle_deg,included_angle_sigma_deg,bevel_1_deg,bevel_1_sigma_deg,"
                        "bevel_2_deg,bevel_2_sigma_deg,depth_mm,depth_sigma_mm,root_face_mm,"
                        "root_face_sigma_mm,area_mm2,area_sigma_mm2\n"))
        << csv;
    EXPECT_NE(csv.find("\n1,1,2,1.5,0.25,,,,,"), std::string::npos) << csv;
    EXPECT_TRUE(groove_csv({Seam{}}).empty());
}

}  // namespace groove_test
}  // namespace seampath
