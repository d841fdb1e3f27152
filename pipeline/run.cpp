#include "pipeline/run.hpp"

#include <chrono>
#include <set>

#include "pipeline/arms.hpp"
#include "pipeline/digest.hpp"
#include "pipeline/files.hpp"
#include "pipeline/fixture_place.hpp"
#include "pipeline/pose_option.hpp"
#include "pipeline/report.hpp"
#include "pipeline/scan_input.hpp"
#include "pipeline/summary.hpp"
#include "pipeline/tables.hpp"
#include "pipeline/text.hpp"
#include "pipeline/walk.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

std::vector<int> seams_to_weld(const PartResult& part) {
    std::vector<int> seams;
    for (std::size_t i = 0; i < part.deviations.size(); ++i) {
        if (part.deviations[i].pass || part.config.export_.even_if_out_of_tolerance) {
            seams.push_back(static_cast<int>(i));
        }
    }
    return seams;
}

/// The arm of plan.arm and the fixture of plan.fixture in their places, and what a plan with them depends on beside the
/// plan's own options.
struct Cell {
    std::optional<ArmCell> arm;
    std::optional<StoredFixture> fixture;
    std::string input;
};

/// The config then says where the fixture stands.
Cell cell_of(Config& config) {
    Cell cell;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    cell.fixture = put_in_place(config, std::chrono::duration<double>(now).count());
    if (cell.fixture) {
        cell.input = place_key(*cell.fixture);
    }
    if (!config.plan.arm.empty()) {
        const ArmFile file = load_arm(config.plan.arm);
        cell.input += file.text;
        for (const double number : config.export_.base_from_scan) {
            cell.input += "\n" + shortest(number);
        }
        cell.arm = {file.arm, pose_of(config.export_.base_from_scan), pose_of(config.plan.flange_from_tool)};
    }
    return cell;
}

Plan plan_seams(const PartResult& part, const Cell& cell) {
    std::vector<SeamModel> models;
    for (const int i : part.planned_seams) {
        models.push_back(part.models.at(static_cast<std::size_t>(i)));
    }
    Plan made = models.empty() ? Plan() : plan(models, part.config.plan, cell.arm, &part.scan);
    if (cell.fixture) {
        add_place_sigma(*cell.fixture, made);
    }
    return made;
}

/// Whether anything may be written that a robot runs.
bool may_export(const PartResult& part) {
    const bool reached = !part.plan.arm || part.plan.arm->pass || part.config.export_.even_if_out_of_tolerance;
    return !part.plan.waypoints.empty() && reached;
}

/// What the arm says of itself where the options do not.
ExportOptions export_options(const Config& config, const Cell& cell) {
    ExportOptions options = config.export_;
    if (cell.arm && options.arm_robot.empty()) {
        options.arm_robot = robot_of_arm(config.plan.arm);
    }
    if (cell.arm && options.arm_joints.empty()) {
        std::vector<std::string_view> names;
        for (const ArmAxis& axis : cell.arm->arm.axes) {
            names.push_back(axis.name);
        }
        options.arm_joints = join(names);
    }
    return options;
}

/// From the models to the programs, for `part.planned_seams`.
void plan_and_export(PartResult& part, Walk& walk, const Cell& cell, const std::string& input) {
    walk.stage(
        "plan", part.plan, [&] { return plan_seams(part, cell); }, plan_summary, input + cell.input);

    walk.always(
        "export",
        [&] {
            part.programs = may_export(part) ? export_programs(part.plan, export_options(part.config, cell))
                                             : std::vector<ProgramFile>();
        },
        export_summary);
}

/// From the scan, or the photograph where there is one, to the programs, stage by stage.
void walk_stages(PartResult& part, Walk& walk, const std::optional<PhotoView>& photo = {}) {
    const Cell cell = cell_of(part.config);  // what is wrong with arm or fixture shows before the work
    const Config& config = part.config;
    const auto& seams = part.extraction.seams;
    walk.stage(
        "extract", part.extraction,
        [&] { return photo ? extract_photo(*photo, config.extract.joint) : extract(part.scan, config.extract); },
        extract_summary);

    const auto place_seam = [&](std::size_t i) { return place(seams[i], config.place); };
    walk.stage(
        "place", part.nodes, [&] { return walk.each(seams.size(), place_seam); }, place_summary);

    const auto fit_seam = [&](std::size_t i) { return fit(seams[i], part.nodes[i], config.fit); };
    walk.stage(
        "fit", part.models, [&] { return walk.each(seams.size(), fit_seam); }, fit_summary);

    const auto validate_seam = [&](std::size_t i) {
        return photo ? validate(part.models[i], *photo, config.validate)
                     : validate(part.models[i], part.scan, config.validate);
    };
    walk.stage(
        "validate", part.deviations, [&] { return walk.each(seams.size(), validate_seam); }, validate_summary);

    part.planned_seams = seams_to_weld(part);
    plan_and_export(part, walk, cell, config.export_.even_if_out_of_tolerance ? "all seams" : "seams in tolerance");
}

/// Programs and reports of an earlier run; they must not stand beside a config that they don't follow from.
void remove_products(const RunFolder& folder) {
    for (const auto* file : {"seam_points.csv", "groove.csv", "waypoints.csv", "passes.csv", "joints.csv", "seams.json",
                             "report.json", "report.html"}) {
        folder.remove(file);
    }
    for (const auto robot : kRobotNames) {
        folder.remove(fs::path("programs") / robot);
    }
}

void write_products(const PartResult& part, const Walk& walk, const std::vector<ReportImage>& images = {}) {
    if (!part.nominal) {
        walk.write("seam_points.csv", seam_points_csv(part.extraction.seams));
        const std::string grooves = groove_csv(part.extraction.seams);
        if (!grooves.empty()) {
            walk.write("groove.csv", grooves);
        }
    }
    walk.write("waypoints.csv", waypoints_csv(part.plan.waypoints, frame_of(part)));
    if (!part.plan.passes.empty()) {
        walk.write("passes.csv", passes_csv(part.plan.passes));
    }
    if (part.plan.arm && !part.plan.arm->samples.empty()) {
        walk.write("joints.csv", joints_csv(*part.plan.arm));
    }
    walk.write("seams.json", seams_json(part));
    std::set<std::string> robots;
    for (const auto& program : part.programs) {
        walk.write(fs::path("programs") / program.robot / program.file_name, program.content);
        robots.insert(program.robot);
    }
    for (const auto& robot : robots) {
        walk.write(fs::path("programs") / robot / "manifest.json", manifest_json(part.programs, robot));
    }
    walk.write("report.json", report_json(part));
    walk.write("report.html", report_html(part, images));
}

}  // namespace

PartResult run_part(const fs::path& scan_file, const fs::path& out, const Config& config, const Resume& resume,
                    const Progress& progress) {
    const RunFolder folder(out);
    PartResult part;
    part.config = config;
    Walk walk(part, progress, &folder, resume);

    ScanInput input;
    walk.always(
        "read",
        [&] {
            input = read_scan(scan_file, config.read);
            part.scan = std::move(input.scan);
        },
        read_summary);
    part.origin = {scan_file.filename().string(), scan_sha256(scan_file), time_written(scan_file)};
    const std::string& file_sha256 = part.origin.sha256;
    walk.depend_on("read", part.scan.name + "\n" + file_sha256);

    remove_products(folder);
    walk.write("config.resolved.json", config_json(config));
    walk.keep("read",
              encode(part.scan, ScanRecord{fs::relative(scan_file, folder.path()).generic_string(), file_sha256}));
    walk_stages(part, walk, input.photo);
    for (std::string& sentence : compare_with_profiles(input, part.extraction.seams)) {
        part.extraction.remarks.push_back(std::move(sentence));
    }
    walk.always(
        "report", [&] { write_products(part, walk, report_images(input, part.extraction.seams)); }, report_summary);
    return part;
}

PartResult run_part(Scan scan, const Config& config, const Progress& progress) {
    PartResult part;
    part.config = config;
    part.scan = std::move(scan);
    Walk walk(part, progress);
    walk_stages(part, walk);
    return part;
}

PartResult run_nominal(const std::string& name, std::vector<SeamModel> models, const fs::path& out,
                       const Config& config, const Progress& progress) {
    const RunFolder folder(out);
    PartResult part;
    part.config = config;
    part.nominal = true;
    part.scan.name = name;
    part.models = std::move(models);
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        part.planned_seams.push_back(static_cast<int>(i));
    }
    Walk walk(part, progress, &folder);
    remove_products(folder);
    walk.write("config.resolved.json", config_json(config));
    plan_and_export(part, walk, cell_of(part.config), encode(part.models));
    walk.always(
        "report", [&] { write_products(part, walk); }, report_summary);
    return part;
}

}  // namespace seampath
