#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stages/extract/extract.hpp"
#include "tests/accuracy/measure.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/geometry/curves.hpp"
#include "tools/interpolation_seams.hpp"

namespace seampath {
namespace interpolate_run_test {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::json;

/// The small tee, scanned once, run once.
const std::filesystem::path& run_folder() {
    static const TestFolder folder;
    static const bool done = [] {
        const Outcome run = seampath_program(run_small_tee(folder.path() / "out"));
        EXPECT_EQ(run.status, 0) << run.err;
        return true;
    }();
    static const std::filesystem::path out = folder.path() / "out";
    EXPECT_TRUE(done);
    return out;
}

TEST(InterpolateRun, RanksTheMethodsOnEachSeam) {
    const TestFolder folder;
    const auto svg = folder.path() / "methods.svg";
    const auto before = contents(run_folder());
    const Outcome run = seampath_program({"interpolate", run_folder(), "--nodes", "6,12", "--out", svg, "--json"});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(contents(run_folder()), before) << "the run stays as it is";
    const Json seams = Json::parse(run.out).at("seams");
    ASSERT_EQ(seams.size(), 2u);
    for (const Json& seam : seams) {
        EXPECT_TRUE(seam.at("best").at("pass").get<bool>());
        for (const auto* part : {"equal", "curvature"}) {
            const Json& methods = seam.at(part).at("methods");
            EXPECT_EQ(methods.size(), part == std::string("equal") ? 17u : 13u);
            for (std::size_t i = 0; i < methods.size(); ++i) {
                ASSERT_EQ(methods[i].at("trials").size(), 2u);
                EXPECT_GT(methods[i].at("trials")[0].at("rms_mm").get<double>(), 0);
                EXPECT_LE(methods[i].at("trials")[0].at("rms_mm"), methods[i].at("trials")[0].at("max_mm"));
                EXPECT_TRUE(i == 0 || methods[i - 1].at("mean_rms_mm") <= methods[i].at("mean_rms_mm"));
            }
            EXPECT_EQ(seam.at("equal").at("left_out")[0].at("method"), "periodic");
        }
    }
    EXPECT_THAT(text_of(svg), AllOf(testing::StartsWith("<svg xmlns"), HasSubstr(">parametric (exact)</text>"),
                                    HasSubstr("seam 1, nodes by curvature"), testing::Not(HasSubstr("nan"))));
    EXPECT_THAT(run.err, HasSubstr("places measured; least rms: "));
    const Outcome text = seampath_program({"interpolate", run_folder(), "--nodes", "6"});
    EXPECT_THAT(text.out, AllOf(HasSubstr("seam 1: fillet, open"), HasSubstr("nodes equally spaced"),
                                HasSubstr("left out: periodic"), HasSubstr("validated: pass")));
}

TEST(InterpolateRun, SaysWhatIsWrong) {
    const TestFolder empty;
    const std::string run = run_folder(),
                      table = std::string(SEAMPATH_SOURCE_DIR) + "/tests/papers/minejeva_table_2.csv";
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
        {{empty.path()}, "a folder that \"seampath run\" wrote was needed"},
        {{run, "--nodes", "3"}, "--nodes: 3; numbers from 4 on, ascending, were needed"},
        {{run, "--nodes", "8,8"}, "--nodes: 8; numbers from 4 on, ascending"},
        {{run, "--scan", table}, "is not the scan of"},
        {{run, "--at", "1"}, "--at: is for a table, not for the folder of a run"},
        {{table, "--nodes", "8"}, "--nodes: is for the folder of a run, not for a table"}};
    for (auto [words, message] : cases) {
        words.insert(words.begin(), "interpolate");
        const Outcome outcome = seampath_program(words);
        EXPECT_EQ(outcome.status, 2) << message;
        EXPECT_THAT(outcome.err, HasSubstr(message));
        EXPECT_EQ(outcome.out, "") << message;
    }
}

TEST(InterpolateRun, NodesAreAsMany) {
    const Seam wave = seam_along(SineCurve{120, 10}, 160, false), ring = seam_along(CircleCurve{20}, 120, true);
    for (const Seam& seam : {wave, ring}) {
        for (const std::size_t count : {6u, 11u, 24u}) {
            const Nodes equal = equal_nodes(seam, count), curvature = curvature_nodes(seam, count);
            EXPECT_EQ(equal.index.size(), count);
            EXPECT_LE(curvature.index.size(), count);
            EXPECT_GE(curvature.index.size() + 2, count);
            EXPECT_EQ(seam.closed || equal.index.back() == seam.points.size() - 1, true);
            EXPECT_EQ(seam.closed || curvature.index.back() == seam.points.size() - 1, true);
        }
    }
    // Where the wave bends most, nodes are closer than where it runs straight.
    const Nodes nodes = curvature_nodes(wave, 14);
    std::vector<double> gap;
    for (std::size_t k = 1; k < nodes.index.size(); ++k) {
        gap.push_back(wave.points[nodes.index[k]].p.x() - wave.points[nodes.index[k - 1]].p.x());
    }
    EXPECT_GT(*std::max_element(gap.begin(), gap.end()), 1.3 * *std::min_element(gap.begin(), gap.end()));
}

// The places lie on the scan's own seam: the spline's distances from them are those that its validation gives.
TEST(InterpolateRun, PlacesAreThoseOfTheValidation) {
    SceneOptions scene;
    scene.length_mm = 40;
    scene.margin_mm = 15;
    ScannerOptions scanner;
    scanner.pitch_x_mm = scanner.pitch_y_mm = 0.5;
    const Dataset dataset = make_dataset(scene, scanner, 1);
    const Scan scan = scan_of(dataset);
    const Seam seam = extract(scan, {}).seams.at(0);
    const MeasuredSeam measured = measure_seam(seam, scan, {});
    ASSERT_GT(measured.p.size(), 10u);
    std::size_t k = 0;
    for (const DeviationSample& sample : measured.deviation.samples) {
        if (sample.covered) {
            EXPECT_NEAR((measured.p.at(k++) - sample.p).norm(), sample.distance_mm, 2e-3) << sample.station_mm;
        }
    }
    const std::vector<std::size_t> counts{8};
    const SeamComparison comparison = compare_methods(seam, measured, counts);
    EXPECT_NEAR(comparison.spline.rms_mm, measured.deviation.rms_mm, 2e-3);
    EXPECT_EQ(comparison.best.rms_mm, std::min(comparison.equal.best.rms_mm, comparison.curvature.best.rms_mm));
}

}  // namespace interpolate_run_test
}  // namespace seampath
