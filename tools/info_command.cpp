#include <algorithm>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "datasets/dataset.hpp"
#include "pipeline/codec.hpp"
#include "pipeline/config.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/run.hpp"
#include "pipeline/scan_input.hpp"
#include "stages/error.hpp"
#include "tools/commands.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 31;

Json vector_json(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

Json scan_info(const fs::path& file, const ReadOptions& options) {
    const Scan scan = read_scan(file, options).scan;
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        box.extend(scan.position(i));
    }
    Json info{{"what", "scan"},
              {"format", scan.format},
              {"points", scan.points.size()},
              {"points_in_file", scan.points_in_file},
              {"dropped_not_finite", scan.dropped_not_finite},
              {"mm_per_unit", scan.mm_per_unit},
              {"unit_reason", scan.unit_reason},
              {"normals", !scan.normals.empty()}};
    if (scan.width > 0) {
        info["raster"] = {scan.width, scan.height};
    }
    if (scan.sensor_mm) {
        info["sensor_mm"] = vector_json(*scan.sensor_mm);
    }
    if (!scan.points.empty()) {
        info["min_mm"] = vector_json(box.min());
        info["max_mm"] = vector_json(box.max());
        info["size_mm"] = vector_json(box.sizes());
    }
    return info;
}

/// Lists of numbers and of objects become their count, so that a page of text tells what a file of megabytes holds.
Json shortened(const Json& value) {
    if (value.is_array() && value.size() > 8) {
        return std::to_string(value.size()) + " values";
    }
    if (!value.is_structured()) {
        return value;
    }
    Json copy = value.is_array() ? Json::array() : Json::object();
    for (const auto& [key, member] : value.items()) {
        if (value.is_array()) {
            copy.push_back(shortened(member));
        } else {
            copy[key] = shortened(member);
        }
    }
    return copy;
}

Json truth_info(const fs::path& file, const Json& root) {
    Json seams = Json::array();
    for (const TruthSeam& seam : read_truth(file).seams) {
        double length_mm = 0;
        for (std::size_t i = seam.closed ? 0 : 1; i < seam.points.size(); ++i) {
            length_mm += (seam.points[i].p - seam.points[i == 0 ? seam.points.size() - 1 : i - 1].p).norm();
        }
        seams.push_back({{"closed", seam.closed}, {"points", seam.points.size()}, {"length_mm", length_mm}});
    }
    Json info = shortened(root);
    info["seams"] = std::move(seams);
    return info;
}

bool has(const Json& root, std::initializer_list<const char*> keys) {
    return std::all_of(keys.begin(), keys.end(), [&](const char* key) { return root.contains(key); });
}

Json json_info(const fs::path& file, const ReadOptions& options) {
    const std::string text = read_file(file, kMaxJsonBytes, "info");
    Json root;
    try {
        root = parse_json(text);
    } catch (const JsonError& error) {
        throw InputError("info: " + file.string() + ": " + error.what() + "; a JSON file was expected; check the file");
    }
    if (!root.is_object()) {
        throw InputError("info: " + file.string() +
                         " holds no JSON object; a config, artefact, truth or report was expected");
    }
    std::string what = "JSON";
    if (root.value("format", Json()) == "seampath truth") {
        return Json{{"what", "truth of a data set"}, {"content", truth_info(file, root)}};
    }
    if (has(root, {"kind", "camera"})) {
        return scan_info(file, options);
    }
    if (has(root, {"stage", "key", "sha256", "content"})) {
        what = "artefact of a stage";
    } else if (has(root, {"part", "verdict", "rows", "seams"})) {
        what = "report";
    } else if (std::all_of(root.items().begin(), root.items().end(), [](const auto& item) {
                   return std::find(kStageNames.begin(), kStageNames.end(), item.key()) != kStageNames.end();
               })) {
        parse_config(text, file.string());
        what = "config";
    }
    return {{"what", what}, {"content", shortened(root)}};
}

/// "key: value" lines; what is inside an object or list is indented.
void print(const Json& value, const std::string& indent) {
    for (const auto& [key, member] : value.items()) {
        const std::string label = value.is_array() ? "- " + key : key;
        const bool flat = !member.is_structured() ||
                          (member.is_array() &&
                           std::none_of(member.begin(), member.end(), [](const Json& m) { return m.is_structured(); }));
        std::cout << indent << label << ":";
        if (flat) {
            std::cout << " " << (member.is_string() ? member.get<std::string>() : member.dump()) << "\n";
        } else {
            std::cout << "\n";
            print(member, indent + "  ");
        }
    }
}

/// A folder stands for the report or truth that is in it.
fs::path file_of(const fs::path& given) {
    for (const auto* name : {"report.json", "truth.json"}) {
        if (fs::is_regular_file(given / name)) {
            return given / name;
        }
    }
    return given;
}

}  // namespace

Command info_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("info", "what is in a scan, artefact, data set, config or report");
    struct Arguments {
        std::string file;
        bool json = false;
        std::vector<std::string> set;
    };
    const auto given = std::make_shared<Arguments>();
    app->add_option("FILE", given->file, "file, or folder of a run or data set")->required();
    app->add_flag("--json", given->json, "for machines");
    app->add_option("--set", given->set, "read.key=value, for a scan")->allow_extra_args(false);
    app->footer(
        "Examples:\n"
        "  seampath info tee.ply\n"
        "  seampath info part.xyz --set read.unit=mm\n"
        "  seampath info out/2-seams.json --json\n");
    return {app, [given] {
                std::vector<Override> overrides;
                for (const auto& argument : given->set) {
                    overrides.push_back(parse_override(argument));
                }
                const Config config = read_config({}, overrides);
                const fs::path file = file_of(given->file);
                Json info = file.extension() == ".json" ? json_info(file, config.read) : scan_info(file, config.read);
                info = Json::parse(info.dump(-1, ' ', false, Json::error_handler_t::replace));
                if (given->json) {
                    std::cout << info.dump(4) << "\n";
                } else {
                    print(info, "");
                }
                return kPass;
            }};
}

}  // namespace seampath
