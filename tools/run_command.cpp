#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/parts_page.hpp"
#include "pipeline/run.hpp"
#include "pipeline/summary.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "tools/commands.hpp"
#include "tools/failure.hpp"
#include "tools/progress_line.hpp"
#include "tools/stop_signal.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxReportBytes = std::size_t{1} << 31;

struct RunArguments {
    std::vector<std::string> scans;
    std::string out;
    std::optional<fs::path> config;
    std::string joint;
    std::string robot;
    std::string fixture;
    std::vector<std::string> set;
    std::string from;
    bool fresh = false;
    bool json = false;
};

/// One scan of a run, and how it went.
struct Part {
    fs::path scan;
    std::string name;
    fs::path folder;
    int status = kOwnFault;
    PartRow row{};
};

std::vector<Override> overrides(const RunArguments& given) {
    std::vector<Override> all;
    for (const auto& argument : given.set) {
        all.push_back(parse_override(argument));
    }
    if (!given.joint.empty()) {
        all.push_back({"--joint", "extract.joint", given.joint});
    }
    if (!given.robot.empty()) {
        all.push_back({"--robot", "export.robots", given.robot});
    }
    if (!given.fixture.empty()) {
        all.push_back({"--fixture", "plan.fixture", given.fixture});
    }
    return all;
}

Resume resume(const RunArguments& given) {
    if (given.fresh) {
        return {0};
    }
    if (given.from.empty()) {
        return {};
    }
    const auto stage = std::find(kStageNames.begin(), kStageNames.end(), given.from);
    if (stage == kStageNames.end()) {
        throw InputError("--from: \"" + given.from + "\" is no stage; there are " + join(kStageNames) +
                         hint(given.from, kStageNames));
    }
    return {static_cast<std::size_t>(stage - kStageNames.begin())};
}

/// One scan goes straight into the folder; each of several into a folder of its name, numbered where names clash.
std::vector<Part> parts(const RunArguments& given) {
    std::vector<Part> all;
    std::set<std::string> taken;
    for (const auto& scan : given.scans) {
        std::string stem = fs::path(scan).stem().string();
        if (stem.empty() || stem == "." || stem == "..") {
            stem = "scan";
        }
        std::string name = stem;
        for (int n = 2; !taken.insert(name).second; ++n) {
            name = stem + "-" + std::to_string(n);
        }
        all.push_back({scan, name, given.scans.size() == 1 ? fs::path(given.out) : fs::path(given.out) / name});
    }
    return all;
}

void print_result(const Part& part, const PartResult& result) {
    std::cout << part.name << ": " << verdict(result) << "\n";
    if (result.models.empty()) {
        for (const auto& remark : result.extraction.remarks) {
            std::cout << "  " << remark << "\n";
        }
    } else {
        std::cout << seam_table(result);
    }
    if (result.plan.arm) {
        std::cout << "arm       " << result.plan.arm->verdict << "\n";
    }
    std::cout << "report    " << (part.folder / "report.html").string() << "\n";
    std::cout << "programs  " << programs_summary(result, (part.folder / "programs").string()) << "\n";
}

int run_one(Part& part, const RunArguments& given, const Config& config) {
    ProgressLine line(given.scans.size() == 1 ? "" : part.name + ": ");
    const PartResult result = run_part(part.scan, part.folder, config, resume(given), line.progress());
    part.row = part_row(result);
    if (!given.json) {
        print_result(part, result);
    }
    return result.pass() ? kPass : kOutOfTolerance;
}

std::string_view word(int status) {
    return status == kPass ? "pass" : status == kOutOfTolerance ? "out of tolerance or no seam" : "failed";
}

std::string summary_json(const std::vector<Part>& all, bool with_reports) {
    Json list = Json::array();
    for (const auto& part : all) {
        list.push_back({{"name", part.name},
                        {"result", word(part.status)},
                        {"exit_status", part.status},
                        {"seams", part.row.seams}});
        if (with_reports && part.status <= kOutOfTolerance) {
            list.back()["report"] = Json::parse(read_file(part.folder / "report.json", kMaxReportBytes, "run"));
        }
    }
    return Json{{"parts", std::move(list)}}.dump(4, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string summary_page(const std::vector<Part>& all) {
    std::vector<PartRow> rows;
    for (const auto& part : all) {
        rows.push_back(part.row);
        rows.back().name = rows.back().folder = part.name;
        if (!part.row.has_report) {
            rows.back().sentence =
                "no report: the run ended with exit status " + std::to_string(part.status) + " and a message on stderr";
        }
    }
    return parts_page(std::move(rows));
}

void print_summary(const std::vector<Part>& all, const fs::path& page) {
    std::vector<std::vector<std::string>> rows{{"part", "seams", "result"}};
    for (const auto& part : all) {
        rows.push_back({part.name, std::to_string(part.row.seams), std::string(word(part.status))});
    }
    std::cout << "\n" << aligned(rows) << "summary   " << page.string() << "\n";
}

int run_several(std::vector<Part>& all, const RunArguments& given, const Config& config) {
    const RunFolder folder(given.out);
    for (const auto* file : {"summary.json", "summary.html"}) {
        folder.remove(file);  // of an earlier run
    }
    int worst = kPass;
    for (auto& part : all) {
        part.status = guarded([&] { return run_one(part, given, config); }, part.name + ": ");
        worst = std::max(worst, part.status);
        if (part.status == kInterrupted) {
            return kInterrupted;
        }
    }
    folder.write("summary.json", summary_json(all, false));
    folder.write("summary.html", summary_page(all));
    if (given.json) {
        std::cout << summary_json(all, true);
    } else {
        print_summary(all, folder.path() / "summary.html");
    }
    return worst;
}

int run(const RunArguments& given) {
    watch_stop_signals();
    const Config config = read_config(given.config, overrides(given));
    resume(given);  // a wrong --from shows before the work
    std::vector<Part> all = parts(given);
    if (all.size() > 1) {
        return run_several(all, given, config);
    }
    const int status = run_one(all.front(), given, config);
    if (given.json) {
        std::cout << read_file(all.front().folder / "report.json", kMaxReportBytes, "run");
    }
    return status;
}

}  // namespace

Command run_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("run", "scans in, seams, robot programs and reports out");
    const auto given = std::make_shared<RunArguments>();
    app->add_option("SCAN", given->scans, "scans, or captures of pictures (.json); several are several parts")
        ->required();
    app->add_option("--out", given->out, "folder for the results")->required();
    app->add_option("--config", given->config, "config file, JSON with comments");
    app->add_option(
        "--joint", given->joint,
        "joint kind: auto, fillet, lap, butt, v-groove, corner, saddle; the same as --set extract.joint=KIND");
    app->add_option("--robot", given->robot,
                    "robots, with commas between, of " + join(kRobotNames) + "; the same as --set export.robots=NAMES");
    app->add_option("--fixture", given->fixture,
                    "result.json of a fixture calibration, where the program moves to; the same as --set "
                    "plan.fixture=FILE");
    app->add_option("--set", given->set, "stage.key=value, over the config file")->allow_extra_args(false);
    app->add_option("--from", given->from, "compute again from this stage on: " + join(kStageNames));
    app->add_flag("--fresh", given->fresh, "compute everything again");
    app->add_flag("--json", given->json, "print report.json's content instead of the table");
    app->footer(
        "Examples:\n"
        "  seampath run tee.ply --out out\n"
        "  seampath run tee.ply --out out --config cell3.json --robot abb --set plan.speed_mm_s=6\n"
        "  seampath run monday/*.ply --out monday-out --from validate --set validate.tolerance_mm=0.2\n"
        "Exit status: 0 pass, 1 out of tolerance or no seam, 2 bad input or config, 3 fault of the program, 130 "
        "interrupted\n");
    return {app, [given] { return run(*given); }};
}

}  // namespace seampath
