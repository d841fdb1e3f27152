#include "pipeline/run.hpp"

#include <set>

#include "pipeline/digest.hpp"
#include "pipeline/report.hpp"
#include "pipeline/summary.hpp"
#include "pipeline/tables.hpp"
#include "pipeline/walk.hpp"

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

Plan plan_seams(const PartResult& part) {
    std::vector<SeamModel> models;
    for (const int i : part.planned_seams) {
        models.push_back(part.models.at(static_cast<std::size_t>(i)));
    }
    return models.empty() ? Plan() : plan(models, part.config.plan);
}

/// From the models to the programs, for `part.planned_seams`.
void plan_and_export(PartResult& part, Walk& walk, const std::string& input) {
    walk.stage(
        "plan", part.plan, [&] { return plan_seams(part); }, plan_summary, input);

    walk.always(
        "export",
        [&] {
            part.programs = part.planned_seams.empty() ? std::vector<ProgramFile>()
                                                       : export_programs(part.plan, part.config.export_);
        },
        export_summary);
}

/// From the scan to the programs, stage by stage.
void walk_stages(PartResult& part, Walk& walk) {
    const Config& config = part.config;
    const auto& seams = part.extraction.seams;
    walk.stage(
        "extract", part.extraction, [&] { return extract(part.scan, config.extract); }, extract_summary);

    const auto place_seam = [&](std::size_t i) { return place(seams[i], config.place); };
    walk.stage(
        "place", part.nodes, [&] { return walk.each(seams.size(), place_seam); }, place_summary);

    const auto fit_seam = [&](std::size_t i) { return fit(seams[i], part.nodes[i], config.fit); };
    walk.stage(
        "fit", part.models, [&] { return walk.each(seams.size(), fit_seam); }, fit_summary);

    const auto validate_seam = [&](std::size_t i) { return validate(part.models[i], part.scan, config.validate); };
    walk.stage(
        "validate", part.deviations, [&] { return walk.each(seams.size(), validate_seam); }, validate_summary);

    part.planned_seams = seams_to_weld(part);
    plan_and_export(part, walk, config.export_.even_if_out_of_tolerance ? "all seams" : "seams in tolerance");
}

/// Programs and reports of an earlier run; they must not stand beside a config that they don't follow from.
void remove_products(const RunFolder& folder) {
    for (const auto* file :
         {"seam_points.csv", "groove.csv", "waypoints.csv", "seams.json", "report.json", "report.html"}) {
        folder.remove(file);
    }
    for (const auto robot : kRobotNames) {
        folder.remove(fs::path("programs") / robot);
    }
}

void write_products(const PartResult& part, const Walk& walk) {
    if (!part.nominal) {
        walk.write("seam_points.csv", seam_points_csv(part.extraction.seams));
        const std::string grooves = groove_csv(part.extraction.seams);
        if (!grooves.empty()) {
            walk.write("groove.csv", grooves);
        }
    }
    walk.write("waypoints.csv", waypoints_csv(part.plan.waypoints, frame_of(part)));
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
    walk.write("report.html", report_html(part));
}

}  // namespace

PartResult run_part(const fs::path& scan_file, const fs::path& out, const Config& config, const Resume& resume,
                    const Progress& progress) {
    const RunFolder folder(out);
    PartResult part;
    part.config = config;
    Walk walk(part, progress, &folder, resume);

    walk.always(
        "read", [&] { part.scan = read(scan_file, config.read); }, read_summary);
    const std::string file_sha256 = sha256_of_file(scan_file);
    walk.depend_on("read", part.scan.name + "\n" + file_sha256);

    remove_products(folder);
    walk.write("config.resolved.json", config_json(config));
    walk.keep("read",
              encode(part.scan, ScanRecord{fs::relative(scan_file, folder.path()).generic_string(), file_sha256}));
    walk_stages(part, walk);
    walk.always(
        "report", [&] { write_products(part, walk); }, report_summary);
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
    plan_and_export(part, walk, encode(part.models));
    walk.always(
        "report", [&] { write_products(part, walk); }, report_summary);
    return part;
}

}  // namespace seampath
