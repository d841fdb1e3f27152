#include "tools/calibrate_robot.hpp"

#include <iostream>

#include "pipeline/files.hpp"
#include "pipeline/fixture_history.hpp"
#include "pipeline/robot_calibration.hpp"
#include "stages/error.hpp"
#include "tools/calibration_date.hpp"
#include "tools/pose_table.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAccepted = "result.json";
constexpr const char* kNotAccepted = "candidate.json";

int run_robot(const RobotArguments& given, RobotMeasurement measured) {
    check_acceptance(given.accept, given.reason);
    measured.options.limit_mm = given.limit_mm > 0 ? given.limit_mm : measured.options.limit_mm;
    const fs::path out = given.out;
    const auto last = accepted_robot_frame(out / kAccepted);
    RobotCalibration c = calibrate_robot(std::move(measured), given.file);
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
    const std::string json = robot_result_json(c);
    folder.write(takes_over ? kAccepted : kNotAccepted, json);
    if (takes_over) {
        folder.remove(kNotAccepted);
    }
    add_to_history(out / "history.db", history_row(c));
    std::cout << (given.json ? json : robot_result_text(c));
    std::cerr << (out / (takes_over ? kAccepted : kNotAccepted)).string() << " written"
              << (takes_over ? "" : "; the accepted calibration stays until --accept --reason TEXT") << "\n";
    return c.frame.pass() ? kPass : kOutOfTolerance;
}

void add_options(CLI::App& app, RobotArguments& given) {
    app.add_option("--out", given.out, "folder for result and history")->required();
    app.add_option("--limit", given.limit_mm,
                   "largest expanded uncertainty that passes, mm (default: as the file says)")
        ->check(CLI::PositiveNumber);
    app.add_option("--date", given.date, "when it was measured, UTC (default: now)");
    app.add_flag("--accept", given.accept, "make this the calibration that later ones are held against");
    app.add_option("--reason", given.reason, "why it is accepted");
    app.add_flag("--json", given.json, "print the result file");
}

}  // namespace

CLI::App* tcp_app(CLI::App& calibrate, RobotArguments& given) {
    CLI::App* app = calibrate.add_subcommand("tcp", "the tool's tip in the flange, from poses that touch one point");
    app->add_option("POSES", given.file, "table of base_from_flange (.csv: x_mm,y_mm,z_mm,qw,qx,qy,qz) or JSON")
        ->required();
    add_options(*app, given);
    app->footer(
        "A table's columns say its unit and rotations: x_mm,y_mm,z_mm or x_m,y_m,z_m, and qw,qx,qy,qz,\n"
        "rx_rad,ry_rad,rz_rad (UR), a_deg,b_deg,c_deg (KUKA) or w_deg,p_deg,r_deg (FANUC).\n\n"
        "Examples:\n"
        "  seampath calibrate tcp touched.csv --out cal/torch\n"
        "  seampath calibrate tcp touched.json --out cal/torch --accept --reason \"new nozzle\"\n"
        "  seampath calibrate tcp touched.csv --out cal/torch --limit 0.5 --json\n");
    return app;
}

CLI::App* hand_eye_app(CLI::App& calibrate, RobotArguments& given) {
    CLI::App* app = calibrate.add_subcommand("hand-eye", "a camera or line profiler on the arm or beside it");
    app->add_option("MEASURED", given.file, "JSON: poses, and the board or ball as seen in each")->required();
    add_options(*app, given);
    app->footer(
        "Examples:\n"
        "  seampath calibrate hand-eye camera.json --out cal/camera\n"
        "  seampath calibrate hand-eye profiler.json --out cal/profiler --accept --reason \"first\"\n"
        "  seampath calibrate hand-eye camera.json --out cal/camera --limit 0.2 --json\n");
    return app;
}

int run_tcp(const RobotArguments& given) {
    const fs::path file = given.file;
    return run_robot(given, file.extension() == ".json" ? read_tcp_poses(file) : read_pose_table(file));
}

int run_hand_eye(const RobotArguments& given) {
    return run_robot(given, read_hand_eye(given.file));
}

}  // namespace seampath
