#include "tools/calibrate_optics.hpp"

#include <iostream>

#include "pipeline/files.hpp"
#include "pipeline/optics_files.hpp"
#include "tools/calibration_date.hpp"

namespace seampath {
namespace {

void add_optics_options(CLI::App& app, OpticsArguments& given) {
    app.add_option("--out", given.out, "folder for result.json")->required();
    app.add_option("--date", given.date, "when it was measured, UTC (default: now)");
    app.add_flag("--json", given.json, "print the result file");
}

int finish(const OpticsArguments& given, const std::string& json, const std::string& text, bool pass) {
    const RunFolder folder(given.out);
    folder.write("result.json", json);
    std::cout << (given.json ? json : text);
    std::cerr << (folder.path() / "result.json").string() << " written\n";
    return pass ? kPass : kOutOfTolerance;
}

}  // namespace

CLI::App* camera_app(CLI::App& calibrate, OpticsArguments& given) {
    CLI::App* app = calibrate.add_subcommand("camera", "focal lengths, centre and distortion from views of a board");
    app->add_option("VIEWS", given.file, "JSON: the board and its pictures (grey PNG)")->required();
    add_optics_options(*app, given);
    app->footer(
        "Examples:\n"
        "  seampath calibrate camera views.json --out cal/top-camera\n"
        "  seampath calibrate camera views.json --out cal/top-camera --json\n"
        "  seampath calibrate camera views.json --out cal/top-camera --date 2026-11-26T05:00:00Z\n");
    return app;
}

CLI::App* laser_app(CLI::App& calibrate, OpticsArguments& given) {
    CLI::App* app = calibrate.add_subcommand("laser", "the plane of a laser from its line on a board");
    app->add_option("VIEWS", given.file, "JSON: camera, board, and pictures of board and line (grey PNG)")->required();
    add_optics_options(*app, given);
    app->footer(
        "Examples:\n"
        "  seampath calibrate laser lines.json --out cal/top-laser\n"
        "  seampath calibrate laser lines.json --out cal/top-laser --json\n"
        "  seampath calibrate laser lines.json --out cal/top-laser --date 2026-11-26T05:00:00Z\n");
    return app;
}

int run_camera(const OpticsArguments& given) {
    CameraRun run = calibrate_camera_file(given.file);
    run.date = date_of(given.date);
    return finish(given, camera_result_json(run), camera_result_text(run), run.result.pass());
}

int run_laser(const OpticsArguments& given) {
    LaserRun run = calibrate_laser_file(given.file);
    run.date = date_of(given.date);
    return finish(given, laser_result_json(run), laser_result_text(run), run.result.pass());
}

}  // namespace seampath
