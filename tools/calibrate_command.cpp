#include <iostream>
#include <memory>

#include "pipeline/digest.hpp"
#include "pipeline/files.hpp"
#include "pipeline/fixture_calibration.hpp"
#include "pipeline/fixture_history.hpp"
#include "pipeline/fixture_page.hpp"
#include "pipeline/frame_files.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "tools/calibrate_optics.hpp"
#include "tools/calibrate_robot.hpp"
#include "tools/calibrate_study.hpp"
#include "tools/calibration_date.hpp"
#include "tools/choice.hpp"
#include "tools/commands.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr const char* kResult = "result.json";
constexpr const char* kCandidate = "candidate.json";
constexpr const char* kPage = "report.html";
constexpr const char* kCandidatePage = "candidate.html";
constexpr const char* kHistory = "history.db";

struct FixtureArguments {
    std::string observations, nominal, out;
    std::string unit = "auto";
    std::string date, reason, appraiser, part;
    bool accept = false, json = false;
    int number = 1;
};

/// The accepted calibration of the folder, if there is one.
std::optional<StoredFixture> accepted_in(const fs::path& out) {
    if (!fs::exists(out / kResult)) {
        return std::nullopt;
    }
    StoredFixture stored = read_fixture_result(out / kResult);
    return stored.accepted ? std::optional(stored) : std::nullopt;
}

int fixture(const FixtureArguments& given) {
    check_acceptance(given.accept, given.reason);
    ReadOptions read_options;
    read_options.unit = static_cast<Unit>(choice("--unit", given.unit, kUnitNames));
    const fs::path out = given.out;
    const auto last = accepted_in(out);
    FixtureCalibration c = calibrate_fixture(given.observations, given.nominal, read_options);
    c.date = date_of(given.date);
    const bool measured_well = c.frame.pass();
    if (last) {
        compare_with(*last, c);
    }
    if (given.accept) {
        accept(c, measured_well, given.reason);
    }
    const RunFolder folder(out);
    const bool takes_over = !last || given.accept;
    const std::string json = fixture_result_json(c);
    folder.write(takes_over ? kResult : kCandidate, json);
    if (takes_over) {
        folder.remove(kCandidate);
        folder.remove(kCandidatePage);
        folder.remove("frames");
    }
    if (takes_over && c.frame.pass()) {  // no robot file for a frame that can't be trusted
        for (const FrameFile& file : frame_files(c.frame.base_from_part, c.nominal.name, given.number)) {
            folder.write(fs::path("frames") / file.format / file.name, file.text);
        }
    }
    HistoryRow row = history_row(c);
    row.appraiser = given.appraiser;
    row.part = given.part;
    add_to_history(out / kHistory, row);
    folder.write(takes_over ? kPage : kCandidatePage, fixture_page(c, read_history(out / kHistory)));
    std::cout << (given.json ? json : fixture_result_text(c));
    std::cerr << (out / (takes_over ? kResult : kCandidate)).string() << " written"
              << (takes_over ? "" : "; the accepted calibration stays until --accept --reason TEXT") << "\n";
    return c.frame.pass() ? kPass : kOutOfTolerance;
}

CLI::App* fixture_app(CLI::App& calibrate, FixtureArguments& given) {
    CLI::App* app = calibrate.add_subcommand("fixture", "where a part or fixture sits, and how sure that is");
    app->add_option("OBSERVATIONS", given.observations,
                    "scan (balls, best-fit, planes with near), table name,x,y,z (points, planes), folder of a run "
                    "(seams), or picture (boards)")
        ->required();
    app->add_option("--nominal", given.nominal, "JSON: where the features are on the part")->required();
    app->add_option("--out", given.out, "folder for result, history and robot files")->required();
    app->add_option("--unit", given.unit, "of the scan: " + join(kUnitNames))->capture_default_str();
    app->add_option("--date", given.date, "when it was measured, UTC (default: now)");
    app->add_option("--number", given.number, "of the base, user frame or register in robot files")
        ->capture_default_str()
        ->check(CLI::Range(1, 63));
    app->add_option("--appraiser", given.appraiser, "who measured; for the study");
    app->add_option("--part", given.part, "which of several like parts; for the study");
    app->add_flag("--accept", given.accept, "make this the calibration that later ones are held against");
    app->add_option("--reason", given.reason, "why it is accepted");
    app->add_flag("--json", given.json, "print the result file");
    app->footer(
        "Examples:\n"
        "  seampath calibrate fixture scan.ply --nominal jig7.json --out cal/jig7\n"
        "  seampath calibrate fixture touched.csv --nominal corner.json --out cal/corner --accept --reason \"first\"\n"
        "  seampath calibrate fixture scan.ply --nominal jig7.json --out cal/jig7 --json\n");
    return app;
}

}  // namespace

Command calibrate_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("calibrate", "fixtures, tools, cameras and lasers, with their uncertainty");
    app->require_subcommand(1);
    app->footer(
        "Examples:\n"
        "  seampath calibrate fixture scan.ply --nominal jig7.json --out cal/jig7\n"
        "  seampath calibrate history cal/jig7\n"
        "  seampath calibrate study cal/jig7 --limit 0.1\n");
    const auto given = std::make_shared<FixtureArguments>();
    const auto study = std::make_shared<StudyArguments>();
    const CLI::App* fixture_chosen = fixture_app(*app, *given);
    const CLI::App* history_chosen = history_app(*app, *study);
    study_app(*app, *study);
    const auto robot = std::make_shared<RobotArguments>();
    const CLI::App* tcp_chosen = tcp_app(*app, *robot);
    const CLI::App* hand_eye_chosen = hand_eye_app(*app, *robot);
    const auto optics = std::make_shared<OpticsArguments>();
    const CLI::App* camera_chosen = camera_app(*app, *optics);
    const CLI::App* laser_chosen = laser_app(*app, *optics);
    return {app, [=]() -> int {
                if (camera_chosen->parsed()) {
                    return run_camera(*optics);
                }
                if (laser_chosen->parsed()) {
                    return run_laser(*optics);
                }
                if (tcp_chosen->parsed()) {
                    return run_tcp(*robot);
                }
                if (hand_eye_chosen->parsed()) {
                    return run_hand_eye(*robot);
                }
                if (fixture_chosen->parsed()) {
                    return fixture(*given);
                }
                return history_chosen->parsed() ? print_history(*study) : print_study(*study);
            }};
}

}  // namespace seampath
