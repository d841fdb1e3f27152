#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/fixtures/fixture_scenes.hpp"
#include "pipeline/camera_json.hpp"
#include "pipeline/fixture_calibration.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/report/page.hpp"

/// The program as a user calls it.
namespace seampath {
namespace fixture_cli_test {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class FixtureCli : public testing::Test {
protected:
    TestFolder folder;
    fs::path nominal = folder.path() / "jig.json", touched = folder.path() / "touched.csv", out = folder.path() / "out";

    void SetUp() override {
        write(nominal, R"({
  "name": "jig", "method": "points", "sigma_mm": 0.01,  // touch probe
  "points": [{"name": "P1", "p_mm": [0, 0, 40]}, {"name": "P2", "p_mm": [400, 0, 70]},
             {"name": "P3", "p_mm": [370, 290, 45]}, {"name": "P4", "p_mm": [40, 240, 130]}],
  "work_points": [{"name": "nozzle", "p_mm": [200, 150, 60]}], "limit_mm": 0.1, "change_limit_mm": 0.2
})");
        write(touched, "name,x,y,z\nP1,1000,0,40\nP2,1400,0,70\nP3,1370,290,45\nP4,1040,240,130\n");
    }
    static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
    void shift_all(const std::string& x_offset_row) { write(touched, "name,x,y,z\n" + x_offset_row); }
    Outcome calibrate(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> words{"calibrate", "fixture", touched,  "--nominal",           nominal,
                                       "--out",     out,       "--date", "2026-11-26T05:00:00Z"};
        words.insert(words.end(), more.begin(), more.end());
        return seampath_program(words);
    }
};

TEST_F(FixtureCli, WritesResultFramesAndHistory) {
    const Outcome run = calibrate();
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, AllOf(HasSubstr("jig: pass"), HasSubstr("1000.0000 0.0000 0.0000"), HasSubstr("nozzle")));
    const auto json = nlohmann::json::parse(text_of(out / "result.json"));
    EXPECT_EQ(json.at("verdict"), "pass");
    EXPECT_EQ(json.at("inputs").size(), 2u);
    EXPECT_EQ(json.at("inputs")[0].at("sha256").get<std::string>().size(), 64u);
    for (const char* file : {"abb/frame.mod", "kuka/frame.dat", "fanuc/frame.ls", "ur/frame.script",
                             "yaskawa/UFRAME.CND", "json/frame.json", "urdf/frame.urdf"}) {
        EXPECT_TRUE(fs::exists(out / "frames" / file)) << file;
    }
    const std::string page = text_of(out / "report.html");
    EXPECT_TRUE(test::holds(page, "data-verdict=\"pass\""));
    EXPECT_GE(test::expect_numbers_equal(page, json), 4 * 5 + 4);
    EXPECT_FALSE(test::holds(page, "http://") || test::holds(page, "src=\"")) << "it needs a network";
    const StoredFixture stored = read_fixture_result(out / "result.json");
    EXPECT_TRUE(stored.pass);
    EXPECT_FALSE(stored.accepted);
    EXPECT_THAT(seampath_program({"calibrate", "history", out}).out, HasSubstr("2026-11-26T05:00:00Z"));
}

TEST_F(FixtureCli, SameInputGivesSameBytes) {
    calibrate();
    const std::string first = text_of(out / "result.json");
    calibrate();
    EXPECT_EQ(text_of(out / "result.json"), first);
}

TEST_F(FixtureCli, AnAcceptedOneStaysUntilAReasonIsGiven) {
    EXPECT_EQ(calibrate({"--accept", "--reason", "first"}).status, 0);
    const std::string accepted = text_of(out / "result.json");
    shift_all("P1,1000.5,0,40\nP2,1400.5,0,70\nP3,1370.5,290,45\nP4,1040.5,240,130\n");
    const Outcome moved = calibrate();
    EXPECT_EQ(moved.status, 1);
    EXPECT_THAT(moved.out, HasSubstr("work point nozzle has moved by 0.500 mm"));
    EXPECT_EQ(text_of(out / "result.json"), accepted);
    const auto candidate = nlohmann::json::parse(text_of(out / "candidate.json"));
    EXPECT_NEAR(candidate.at("change").at("x_mm").get<double>(), 0.5, 1e-9);
    EXPECT_EQ(calibrate({"--accept"}).status, 2);
    EXPECT_EQ(calibrate({"--accept", "--reason", "jig moved on purpose"}).status, 0);
    EXPECT_EQ(read_fixture_result(out / "result.json").accepted->reason, "jig moved on purpose");
    EXPECT_FALSE(fs::exists(out / "candidate.json"));
}

TEST_F(FixtureCli, AFailedOneCanNotBeAcceptedAndGivesNoFrames) {
    shift_all("P1,1000,0,40\nP2,1400,0,70\nP3,1370,290,45.3\nP4,1040,240,130\n");
    const Outcome run = calibrate();
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.out, HasSubstr("the features disagree"));
    EXPECT_FALSE(fs::exists(out / "frames"));
    const Outcome accept = calibrate({"--accept", "--reason", "please"});
    EXPECT_EQ(accept.status, 2);
    EXPECT_THAT(accept.err, HasSubstr("did not pass and can't be accepted"));
}

TEST_F(FixtureCli, StudyCountsRepeatsAndDrift) {
    for (int i = 0; i < 8; ++i) {
        const std::string x = "." + std::to_string(100 + 20 * i + (i % 2));
        shift_all("P1,1000" + x + ",0,40\nP2,1400" + x + ",0,70\nP3,1370" + x + ",290,45\nP4,1040" + x + ",240,130\n");
        EXPECT_EQ(calibrate().status, 0);
    }
    const Outcome study = seampath_program({"calibrate", "study", out, "--limit", "0.5"});
    EXPECT_EQ(study.status, 1);
    EXPECT_THAT(study.out, AllOf(HasSubstr("8 runs"), HasSubstr("ALARM: nozzle, x drifts by 0.020")));
}

// The jig is shifted by 1000 mm along x; what the points are unsure of joins the waypoints' own sigma.
TEST_F(FixtureCli, TheProgramOfARunMovesWithTheFixture) {
    ASSERT_EQ(calibrate().status, 0);
    const auto waypoints = [&](const std::string& name, const std::vector<std::string>& more) {
        std::vector<std::string> words{"--robot", "json,abb"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome run = seampath_program(run_small_tee(folder.path() / name, words));
        EXPECT_EQ(run.status, 0) << run.err;
        return nlohmann::json::parse(text_of(folder.path() / name / "programs/json/waypoints.json")).at("waypoints");
    };
    const std::vector<std::string> placed{"--fixture", out / "result.json"};
    const auto loose = waypoints("loose", {}), moved = waypoints("moved", placed);
    ASSERT_EQ(loose.size(), moved.size());
    for (std::size_t i = 0; i < loose.size(); ++i) {
        EXPECT_NEAR(moved[i].at("x").get<double>() - loose[i].at("x").get<double>(), 1000, 2e-3);
        EXPECT_NEAR(moved[i].at("y").get<double>(), loose[i].at("y").get<double>(), 2e-3);
        if (loose[i].at("kind") == "weld") {
            EXPECT_GT(moved[i].at("sigma_mm").get<double>(), loose[i].at("sigma_mm").get<double>());
        }
    }
    std::string program;
    for (const auto& [name, text] : contents(folder.path() / "moved/programs/abb")) {
        program += text;
    }
    EXPECT_THAT(program, HasSubstr("1-sigma of base_from_scan"));
    const Outcome old = seampath_program(run_small_tee(
        folder.path() / "old", {"--fixture", out / "result.json", "--set", "plan.fixture_max_age_h=0.001"}));
    EXPECT_EQ(old.status, 2);
    EXPECT_THAT(old.err, HasSubstr("plan.fixture_max_age_h"));
    shift_all("P1,1000,0,40\nP2,1400,0,70\nP3,1370,290,45.3\nP4,1040,240,130\n");
    ASSERT_EQ(calibrate().status, 1);
    const Outcome failed = seampath_program(run_small_tee(folder.path() / "failed", placed));
    EXPECT_EQ(failed.status, 2);
    EXPECT_THAT(failed.err, HasSubstr("did not pass"));
}

TEST_F(FixtureCli, ProbesDatumPlanesInAScan) {
    const ProbedPart part = make_probed_part(2);
    touched = folder.path() / "scan.xyz";
    std::ofstream scan(touched);
    scan.precision(9);
    for (const Eigen::Vector3f& p : part.scan.points) {
        scan << (part.scan.origin_mm + p.cast<double>()).transpose() << "\n";
    }
    scan.close();
    nlohmann::ordered_json json{{"name", "corner"},
                                {"method", "planes"},
                                {"near", pose_numbers(part.near)},
                                {"work_points", {{{"name", "nozzle"}, {"p_mm", {150, 100, 40}}}}}};
    for (const DatumPlane& plane : part.planes) {
        nlohmann::ordered_json points;
        for (const TouchedPoint& place : plane.touched) {
            const Eigen::Vector3d& p = place.nominal;
            points.push_back({{"name", plane.name + std::to_string(points.size() + 1)}, {"p_mm", {p[0], p[1], p[2]}}});
        }
        const Eigen::Vector3d& n = plane.normal;
        json["planes"].push_back(
            {{"name", plane.name}, {"normal", {n[0], n[1], n[2]}}, {"offset_mm", plane.offset_mm}, {"points", points}});
    }
    write(nominal, json.dump());
    const Outcome run = calibrate({"--unit", "mm"});
    EXPECT_EQ(run.status, 0) << run.err;
    const StoredFixture stored = read_fixture_result(out / "result.json");
    const Eigen::Vector3d nozzle(150, 100, 40);
    EXPECT_LT((stored.base_from_part * nozzle - part.base_from_part * nozzle).norm(), 0.02);
    EXPECT_THAT(text_of(out / "result.json"), HasSubstr("A1: noise of its points"));
    json["neer"] = json["near"];
    json.erase("near");
    write(nominal, json.dump());
    EXPECT_THAT(calibrate({"--unit", "mm"}).err, AllOf(HasSubstr("/neer: there is no such key"), HasSubstr("near")));
    json["near"] = json["neer"];
    json.erase("neer");
    json["near"][0] = json["near"][0].get<double>() + 500;
    write(nominal, json.dump());
    const Outcome far = calibrate({"--unit", "mm"});
    EXPECT_EQ(far.status, 2);
    EXPECT_THAT(far.err, HasSubstr("datum plane A: about (20, 20, 0) the scan shows too little of it"));
}

TEST_F(FixtureCli, BadInputIsOneClearLineEach) {
    const auto error = [&](const fs::path& file, const std::string& text) {
        SetUp();
        write(file, text);
        const Outcome run = calibrate();
        EXPECT_EQ(run.status, 2) << run.err;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
        return run.err;
    };
    EXPECT_THAT(error(nominal, R"({"name": "jig", "method": "pionts"})"), HasSubstr("did you mean \"points\"?"));
    EXPECT_THAT(error(nominal, R"({"name": "jig", "method": "points", "points": [], "limit": 1})"),
                HasSubstr("/limit: there is no such key; did you mean \"limit_mm\"?"));
    EXPECT_THAT(error(nominal, "{"), HasSubstr("jig.json: /: "));
    EXPECT_THAT(error(touched, "name,x,y,z\nP1,1,2,3\n"), HasSubstr("\"P2\" was not touched"));
    EXPECT_THAT(error(touched, "name,x,y,z\nP1,1,2,a\n"),
                HasSubstr("touched.csv:2: column z: \"a\" is no finite number"));
    EXPECT_THAT(error(touched, "# unit: furlong\nname,x,y,z\nP1,1,2,3\n"), HasSubstr("\"furlong\" is unknown"));
    EXPECT_THAT(error(touched, "name,x,y\nP1,1,2\n"), HasSubstr("no column \"z\""));
    EXPECT_THAT(error(touched, ""), HasSubstr("there is no touched point"));
    write(touched, "name,x,y,z\nP1,1,2,3\nP1,1,2,3\n");
    EXPECT_THAT(calibrate().err, HasSubstr("\"P1\" stands twice"));
    EXPECT_EQ(seampath_program({"calibrate", "history", folder.path()}).status, 2);
}

TEST_F(FixtureCli, CollinearPointsNameWhatIsOpen) {
    write(nominal, R"({"name": "jig", "method": "points", "sigma_mm": 0.01,
  "points": [{"name": "P1", "p_mm": [0, 0, 0]}, {"name": "P2", "p_mm": [100, 0, 0]}, {"name": "P3", "p_mm": [400, 0, 0]}]})");
    shift_all("P1,0,0,0\nP2,100,0,0\nP3,400,0,0\n");
    const Outcome run = calibrate();
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.out, HasSubstr("the features do not hold: turn about (1.000, 0.000, 0.000)"));
}

}  // namespace fixture_cli_test
}  // namespace seampath
