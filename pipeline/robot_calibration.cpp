#include "pipeline/robot_calibration.hpp"

#include "pipeline/digest.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr std::array<std::string_view, 3> kMethodNames{"tcp", "hand-eye of a camera", "hand-eye of a profiler"};

std::string method_of(const RobotCalibration& c) {
    return std::string(kMethodNames[static_cast<std::size_t>(c.measured.method)]);
}

}  // namespace

RobotCalibration calibrate_robot(RobotMeasurement measured, const std::filesystem::path& file) {
    RobotCalibration c;
    c.inputs.push_back({file.string(), sha256_of_file(file)});
    switch (measured.method) {
        case RobotMethod::tcp:
            c.frame = calibrate_tcp(measured.tips, measured.options);
            break;
        case RobotMethod::camera:
            c.frame = calibrate_camera_mount(measured.boards, measured.mount, measured.options);
            break;
        case RobotMethod::profiler:
            c.frame = calibrate_profiler_mount(measured.profiles, measured.ball_diameter_mm / 2, measured.mount,
                                               measured.options);
            break;
    }
    c.inputs.insert(c.inputs.end(), measured.pictures.begin(), measured.pictures.end());
    c.measured = std::move(measured);
    return c;
}

void compare_with(const StoredRobotFrame& accepted, RobotCalibration& c) {
    if (accepted.name != c.measured.name || accepted.method != method_of(c)) {
        throw InputError("calibrate: the accepted calibration is the " + accepted.method + " of \"" + accepted.name +
                         "\", this one the " + method_of(c) + " of \"" + c.measured.name +
                         "\"; give each a folder of its own");
    }
    const Eigen::Vector3d& w = c.frame.work_point;
    const double moved = (c.frame.frame * w - accepted.frame * w).norm(), limit = c.measured.options.limit_mm;
    c.change = FrameChange{accepted.date, displacement(accepted.frame, c.frame.frame), {moved}, limit};
    if (moved > limit) {
        c.frame.faults.push_back("the work point has moved by " + fixed(moved, 3) +
                                 " mm since the calibration accepted on " + accepted.date + "; the limit is " +
                                 shortest(limit) + " mm");
    }
}

HistoryRow history_row(const RobotCalibration& c) {
    HistoryRow row;
    row.date = c.date;
    row.fixture = c.measured.name;
    row.method = method_of(c);
    row.pass = c.frame.pass();
    row.accepted = c.accepted.has_value();
    row.reason = c.accepted ? c.accepted->reason : "";
    row.base_from_part = c.frame.frame;
    row.expanded_mm = c.frame.expanded_mm;
    row.work_points = {{"work point", c.frame.work_point}};
    row.observations_sha256 = c.inputs.front().sha256;
    for (const auto& fault : c.frame.faults) {
        row.faults += (row.faults.empty() ? "" : "\n") + fault;
    }
    return row;
}

}  // namespace seampath
