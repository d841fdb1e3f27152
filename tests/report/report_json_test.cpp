#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/config.hpp"
#include "pipeline/digest.hpp"
#include "pipeline/report.hpp"
#include "pipeline/tables.hpp"
#include "stages/error.hpp"
#include "tests/report/example_part.hpp"

namespace seampath::test {
namespace report_json_test {

using Json = nlohmann::json;
using testing::Contains;
using testing::EndsWith;

Json report_of_example(bool pass = true) {
    return Json::parse(report_json(example_part(pass)));
}

Json find(const Json& rows, const std::string& name) {
    for (const Json& row : rows) {
        if (row.at("name") == name) {
            return row;
        }
    }
    ADD_FAILURE() << "no row " << name;
    return {};
}

TEST(ReportJson, GivesTheVerdictOfThePartAndOfEachSeam) {
    const Json passed = report_of_example(), failed = report_of_example(false);
    EXPECT_EQ(passed.at("verdict"), "pass");
    EXPECT_EQ(failed.at("verdict"), "fail");
    EXPECT_EQ(failed.at("seams")[0].at("verdict"), "pass");
    EXPECT_EQ(failed.at("seams")[1].at("verdict"), "fail");
    const PartResult part = example_part(false);
    const double used = (part.deviations[1].p997_mm + 2 * 0.004) / 0.1;  // all sigmas are 0.004, the tolerance 0.1
    EXPECT_EQ(failed.at("sentence"), "1 of 2 seams within tolerance of the scanned surfaces; the worst, seam 1, uses " +
                                         std::to_string(std::lround(100 * used)) + " % of its tolerance");
    EXPECT_EQ(find(failed.at("rows"), "seams_in_tolerance").at("verdict"), "fail");
    EXPECT_EQ(find(failed.at("seams")[1].at("rows"), "in_tolerance").at("verdict"), "fail");
}

TEST(ReportJson, SaysUpFrontThatAToleranceIsOnlyByNoise) {
    PartResult part = example_part();
    part.deviations[0].tolerance_mm = 4.2;
    const auto sentence = [&] { return Json::parse(report_json(part)).at("sentence").get<std::string>(); };
    EXPECT_NE(sentence().find("a tolerance of 4.20 mm is only what the scan's noise allows"), std::string::npos);
    part.config.validate.tolerance_mm = 4.2;
    EXPECT_EQ(sentence().find("noise"), std::string::npos) << "asked for";
}

TEST(ReportJson, NamesScanSettingsAndBuildByTheirHashes) {
    PartResult part = example_part();
    part.origin = {"tee.ply", std::string(64, 'a'), "2026-03-31 14:05 UTC"};
    const Json report = Json::parse(report_json(part));
    EXPECT_EQ(find(report.at("identity"), "scan_file").at("value"), "tee.ply");
    EXPECT_EQ(find(report.at("identity"), "scan_sha256").at("value"), std::string(64, 'a'));
    const std::string settings = find(report.at("identity"), "config_sha256").at("value");
    EXPECT_EQ(settings, sha256(config_json(part.config)));
    EXPECT_EQ(find(report.at("identity"), "build_sha256").at("value"), sha256_of_file("/proc/self/exe"));
    EXPECT_EQ(report.dump().find("2026-03-31"), std::string::npos) << "a copied scan gives the same numbers";
    part.config.plan.speed_mm_s = 7;
    EXPECT_NE(find(Json::parse(report_json(part)).at("identity"), "config_sha256").at("value"), settings);
}

TEST(ReportJson, ListsTheWorstPlacesOfEachSeam) {
    const PartResult part = example_part();
    for (std::size_t i = 0; i < 2; ++i) {
        const Json places = report_of_example().at("seams")[i].at("worst_places");
        ASSERT_EQ(places.size(), 3U);
        double most = 0;
        for (const DeviationSample& s : part.deviations[i].samples) {
            most = s.covered ? std::max(most, s.distance_mm) : most;
        }
        EXPECT_EQ(places[0].at("deviation_mm"), most);
        EXPECT_GE(places[1].at("deviation_mm"), places[2].at("deviation_mm"));
        for (const Json& place : places) {
            const auto& samples = part.deviations[i].samples;
            EXPECT_TRUE(std::any_of(samples.begin(), samples.end(), [&](const DeviationSample& s) {
                return place.at("station_mm") == s.station_mm && place.at("x_mm") == s.p.x() &&
                       place.at("flank2_mm") == s.flank2_mm;
            }));
        }
    }
}

TEST(ReportJson, EveryRowHasNameValueUnitAndVerdictAndNamesThatEndInTheUnit) {
    const Json report = report_of_example();
    const std::map<std::string, std::string> suffix{
        {"mm", "_mm"}, {"°", "_deg"}, {"s", "_s"}, {"%", "_percent"}, {"1/mm", "_per_mm"}};
    std::vector<Json> lists{report.at("identity"), report.at("rows"), report.at("scan").at("rows")};
    for (const char* group : {"seams", "programs"}) {
        for (const Json& entry : report.at(group)) {
            lists.push_back(entry.at("rows"));
        }
    }
    std::size_t with_unit = 0;
    for (const Json& rows : lists) {
        std::set<std::string> names;
        for (const Json& row : rows) {
            EXPECT_EQ(row.size(), 4U) << row;
            EXPECT_TRUE(names.insert(row.at("name")).second) << row;
            const std::string unit = row.at("unit");
            if (!unit.empty() && row.at("name") != "mm_per_unit") {
                EXPECT_THAT(row.at("name").get<std::string>(), EndsWith(suffix.at(unit))) << row;
                ++with_unit;
            }
        }
    }
    EXPECT_GT(with_unit, 40U);
}

TEST(ReportJson, SaysWhichModelASeamIsAndWhy) {
    const Json report = report_of_example();
    const Json& pipe = report.at("seams")[0].at("rows");
    EXPECT_EQ(find(pipe, "model").at("value"), "saddle");
    EXPECT_EQ(find(pipe, "model_reason").at("value"), "the pipe is round");
    EXPECT_EQ(find(pipe, "header").at("value"), "plane");
    EXPECT_EQ(find(pipe, "branch_radius_mm").at("value"), 30);
    EXPECT_EQ(find(pipe, "branch_radius_sigma_mm").at("value"), 0.004);
    EXPECT_NEAR(find(pipe, "branch_angle_deg").at("value").get<double>(), 90, 1e-12);
    EXPECT_NEAR(find(pipe, "branch_angle_sigma_deg").at("value").get<double>(), 0.0115, 1e-4);
    const Json& rib = report.at("seams")[1].at("rows");
    EXPECT_EQ(find(rib, "model").at("value"), "spline");
    for (const Json& row : rib) {
        EXPECT_NE(row.at("name"), "branch_radius_mm");
    }
    const Json seams = Json::parse(seams_json(example_part())).at("seams");
    EXPECT_EQ(seams[0].at("model").at("saddle").at("branch_radius_mm"), 30);
    EXPECT_EQ(seams[0].at("model").at("reason"), "the pipe is round");
    EXPECT_TRUE(seams[1].at("model").at("saddle").is_null());
}

TEST(ReportJson, TakesItsNumbersFromTheResultUnrounded) {
    const PartResult part = example_part();
    const Json report = Json::parse(report_json(part));
    const Json& rows = report.at("seams")[0].at("rows");
    EXPECT_EQ(find(rows, "deviation_signed_mean_mm").at("value"), -0.0012345678);
    EXPECT_EQ(find(rows, "deviation_max_mm").at("value"), part.deviations[0].max_mm);
    EXPECT_EQ(find(rows, "length_mm").at("value"), part.models[0].length_mm);
    EXPECT_EQ(find(rows, "nodes").at("value"), 30);
    EXPECT_EQ(find(rows, "closed").at("value"), true);
    EXPECT_EQ(find(report.at("rows"), "duration_s").at("value"), part.plan.duration_s);
    EXPECT_EQ(find(report.at("scan").at("rows"), "dropped_not_finite").at("value"), 17);
    EXPECT_EQ(report.at("stages")[1].at("summary"), "2 seams");
}

TEST(ReportJson, DoesNotDependOnHowLongTheStagesTook) {
    PartResult part = example_part();
    const std::string json = report_json(part);
    const std::string html = report_html(part);
    for (StageTiming& timing : part.timings) {
        timing.seconds += 1;
        timing.resumed = !timing.resumed;
    }
    EXPECT_EQ(report_json(part), json);
    EXPECT_EQ(report_html(part), html);
}

// 360 points on a circle of radius 30; 13 of them in a row are bridged, so 14 chords touch one of them.
TEST(ReportJson, MeasuresTheBridgedLength) {
    const double chord = 2 * 30 * std::sin(std::acos(-1.0) / 360);
    const Json report = report_of_example();
    EXPECT_NEAR(find(report.at("seams")[0].at("rows"), "modelled_length_mm").at("value").get<double>(), 14 * chord,
                1e-9);
    EXPECT_EQ(find(report.at("seams")[1].at("rows"), "modelled_length_mm").at("value"), 0);
    EXPECT_NEAR(find(report.at("seams")[0].at("rows"), "max_curvature_per_mm").at("value").get<double>(), 1 / 30.0,
                2e-4);
}

TEST(ReportJson, JudgesCoverageAndReadBackErrors) {
    PartResult part = example_part();
    part.config.validate.min_coverage = 0.99;
    part.programs[0].max_position_error_mm = 0.002;
    const Json report = Json::parse(report_json(part));
    EXPECT_EQ(find(report.at("seams")[0].at("rows"), "coverage_percent").at("verdict"), "fail");
    EXPECT_EQ(find(report.at("seams")[1].at("rows"), "coverage_percent").at("verdict"), "pass");
    EXPECT_EQ(find(report.at("programs")[0].at("rows"), "max_position_error_mm").at("verdict"), "fail");
    EXPECT_EQ(find(report.at("programs")[1].at("rows"), "max_position_error_mm").at("verdict"), "pass");
}

TEST(ReportJson, SaysSoWhenNothingWasFound) {
    const Json report = Json::parse(report_json(part_without_seams()));
    EXPECT_EQ(report.at("verdict"), "fail");
    EXPECT_EQ(report.at("sentence"), "No seam was found in this scan");
    EXPECT_TRUE(report.at("seams").empty());
    EXPECT_THAT(report.at("scan").at("remarks"), Contains("only one surface was found"));
}

TEST(ReportJson, WritesNumbersThatAreNotFiniteAsNullAndRepairsNames) {
    PartResult part = example_part();
    part.scan.name = "caf\xe9 \xe2\x82";
    part.deviations[0].max_mm = std::nan("");
    const Json report = Json::parse(report_json(part));
    EXPECT_EQ(report.at("part"), "caf\uFFFD \uFFFD\uFFFD");
    EXPECT_TRUE(find(report.at("seams")[0].at("rows"), "deviation_max_mm").at("value").is_null());
}

TEST(ReportJson, IsTheSameTwice) {
    EXPECT_EQ(report_json(example_part()), report_json(example_part()));
}

TEST(ReportJson, RefusesASeamWithoutDeviation) {
    PartResult part = example_part();
    part.deviations.pop_back();
    EXPECT_THROW(report_json(part), InternalError);
}

}  // namespace report_json_test
}  // namespace seampath::test
