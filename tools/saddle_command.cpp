#include <algorithm>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/run.hpp"
#include "pipeline/summary.hpp"
#include "pipeline/text.hpp"
#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/nominal/nominal.hpp"
#include "stages/text.hpp"
#include "tools/choice.hpp"
#include "tools/commands.hpp"
#include "tools/progress_line.hpp"
#include "tools/saddle_facts.hpp"
#include "tools/saddle_from.hpp"
#include "tools/saddle_points.hpp"
#include "tools/stop_signal.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kPointsFile = "saddle_points.csv";
constexpr const char* kFactsFile = "saddle.json";

struct SaddleArguments {
    std::string header = "cylinder";
    std::optional<double> branch_radius_mm, header_radius_mm, head_depth_mm, cone_half_angle_deg;
    double angle_deg = 90;
    double offset_mm = 0;
    std::string from;
    std::optional<int> seam;
    SaddleStepOptions steps;
    std::optional<double> speed_mm_s;
    std::string groove;
    std::optional<double> groove_depth_mm, bead_area_mm2;
    std::string out;
    std::optional<fs::path> config;
    std::string robot;
    std::vector<std::string> set;
    bool json = false;
};

/// The size that a kind of header needs, or refused where it has no such size.
double size_for(const std::string& option, const std::optional<double>& value, const std::string& header, bool needed) {
    if (value.has_value() != needed) {
        throw InputError(option + ": the header \"" + header + "\" " +
                         (needed ? "needs it; give it a value" : "has no such size; leave it out"));
    }
    return value.value_or(0);
}

SaddleDimensions given_dimensions(const SaddleArguments& given) {
    SaddleDimensions d;
    d.header = static_cast<HeaderKind>(choice("--header", given.header, kHeaderNames));
    if (!given.branch_radius_mm) {
        throw InputError("--branch-radius-mm: a saddle needs it; give it a value, or a run to take it --from");
    }
    d.branch_radius_mm = *given.branch_radius_mm;
    d.header_radius_mm =
        size_for("--header-radius-mm", given.header_radius_mm, given.header, d.header != HeaderKind::plane);
    d.head_depth_mm = size_for("--head-depth-mm", given.head_depth_mm, given.header, d.header == HeaderKind::ellipsoid);
    d.cone_half_angle = kDegree * size_for("--cone-half-angle-deg", given.cone_half_angle_deg, given.header,
                                           d.header == HeaderKind::cone);
    d.angle = given.angle_deg * kDegree;
    d.offset_mm = given.offset_mm;
    return d;
}

Config config_of(const SaddleArguments& given) {
    std::vector<Override> overrides;
    for (const auto& argument : given.set) {
        overrides.push_back(parse_override(argument));
    }
    if (!given.robot.empty()) {
        overrides.push_back({"--robot", "export.robots", given.robot});
    }
    const auto add = [&overrides](const char* option, const char* path, const std::optional<double>& value) {
        if (value) {
            overrides.push_back({option, path, shortest(*value)});
        }
    };
    add("--speed-mm-s", "plan.speed_mm_s", given.speed_mm_s);
    add("--groove-depth-mm", "plan.groove_depth_mm", given.groove_depth_mm);
    add("--bead-area-mm2", "plan.bead_area_mm2", given.bead_area_mm2);
    if (!given.groove.empty()) {
        overrides.push_back({"--groove", "plan.groove", given.groove});
    }
    return read_config(given.config, overrides);
}

/// The dimensions that the header has, and no others. Degrees as they were given, where they were.
Json dimensions_json(const SaddleArguments& given, const SaddleDimensions& d) {
    const bool fitted = !given.branch_radius_mm;
    Json json{{"header", kHeaderNames.at(static_cast<std::size_t>(d.header))},
              {"branch_radius_mm", d.branch_radius_mm}};
    if (d.header != HeaderKind::plane) {
        json["header_radius_mm"] = d.header_radius_mm;
    }
    if (given.head_depth_mm) {
        json["head_depth_mm"] = *given.head_depth_mm;
    }
    if (given.cone_half_angle_deg) {
        json["cone_half_angle_deg"] = *given.cone_half_angle_deg;
    }
    json["angle_deg"] = fitted ? d.angle / kDegree : given.angle_deg;
    json["offset_mm"] = d.offset_mm;
    if (fitted) {
        json["from"] = given.from;
    }
    return json;
}

/// Options that belong to another use of the command.
void check_use(const CLI::App& app, const SaddleArguments& given) {
    const auto refuse = [&app](const char* option, const std::string& why) {
        if (app.count(option) > 0) {
            throw InputError(std::string(option) + ": " + why + "; leave it out");
        }
    };
    if (given.from.empty()) {
        refuse("--seam", "is for the run that --from names");
    } else if (given.branch_radius_mm) {
        for (const char* option :
             {"--step", "--steps", "--pose", "--pose-angle-deg", "--speed-mm-s", "--period-s", "--groove",
              "--groove-depth-mm", "--bead-area-mm2", "--robot", "--config", "--set"}) {
            refuse(option, "is for a torch path, and a comparison --from a run with a nominal saddle makes none");
        }
    } else {
        for (const char* option : {"--header", "--header-radius-mm", "--head-depth-mm", "--cone-half-angle-deg",
                                   "--angle-deg", "--offset-mm"}) {
            refuse(option, "the dimensions are those of the run; --branch-radius-mm is missing if they are nominal");
        }
    }
}

/// So that none of them stands beside what it does not follow from.
void remove_earlier_results(const fs::path& out) {
    if (fs::is_directory(out)) {
        for (const auto* file :
             {kPointsFile, kFactsFile, "saddle_difference.csv", "saddle_difference.svg", "saddle_difference.json"}) {
            RunFolder(out).remove(file);
        }
    }
}

/// The paper's law turns the flanks that a groove lies between.
void check_torch(const SaddleSteps& points, const Config& config) {
    if (points.pose == PoseLaw::paper && config.plan.groove != GrooveForm::none) {
        throw InputError(
            "--pose: the paper's law knows one pass, and plan.groove asks for several; set --pose to bisector");
    }
}

int saddle(const SaddleArguments& given) {
    watch_stop_signals();
    remove_earlier_results(given.out);
    const SaddleFrom from{given.from, given.seam, given.out, given.json};
    if (!given.from.empty() && given.branch_radius_mm) {
        return compare_with_nominal(from, given_dimensions(given));
    }
    const Config config = config_of(given);
    const SaddleDimensions dimensions = given.from.empty() ? given_dimensions(given) : fitted_dimensions(from);
    const SaddleCurve curve = saddle_of(dimensions);
    const SaddleSteps points = saddle_steps(curve, given.steps, config.plan.speed_mm_s);
    check_torch(points, config);
    ProgressLine line("");
    const PartResult part =
        run_nominal("saddle", {nominal_model(curve, points.pose, points.initial)}, given.out, config, line.progress());
    const Json facts = saddle_facts(dimensions_json(given, dimensions), curve, points, part);
    const std::string text = facts.dump(4) + "\n";
    const RunFolder folder(given.out);
    folder.write(kPointsFile, saddle_points_csv(curve, points));
    folder.write(kFactsFile, text);
    if (given.json) {
        std::cout << text;
    } else {
        const fs::path out = given.out;
        std::cout << saddle_facts_text(facts, part,
                                       {{"points", (out / kPointsFile).string()},
                                        {"report", (out / "report.html").string()},
                                        {"programs", programs_summary(part, (out / "programs").string())}});
    }
    return part.pass() ? kPass : kOutOfTolerance;
}

void add_dimensions(CLI::App& app, SaddleArguments& given) {
    app.add_option("--branch-radius-mm", given.branch_radius_mm, "outer radius of the branch, mm");
    app.add_option("--header-radius-mm", given.header_radius_mm,
                   "outer radius of the header, mm; of a cone where the branch's axis crosses its axis");
    app.add_option("--header", given.header, "shape of the header: " + join(kHeaderNames))->capture_default_str();
    app.add_option("--angle-deg", given.angle_deg, "angle between both axes, or between the branch and the plane")
        ->capture_default_str();
    app.add_option("--offset-mm", given.offset_mm, "distance by which the branch's axis passes the header's, mm")
        ->capture_default_str();
    app.add_option("--cone-half-angle-deg", given.cone_half_angle_deg, "half the cone's opening angle");
    app.add_option("--head-depth-mm", given.head_depth_mm, "depth of an ellipsoidal head, mm; half its radius for 2:1");
}

}  // namespace

Command saddle_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand(
        "saddle", "the seam of a round branch on a header, from nominal dimensions instead of a scan (Xue et al.)");
    const auto given = std::make_shared<SaddleArguments>();
    add_dimensions(*app, *given);
    app->add_option("--step", given->steps.step, "law of the interpolation steps: " + join(kStepLawNames))
        ->capture_default_str();
    app->add_option("--steps", given->steps.steps, "interpolation steps once round, where no period is given")
        ->capture_default_str();
    app->add_option("--pose", given->steps.pose,
                    "law of the torch angle: the paper's (12), or the bisector of both walls; " + join(kPoseLawNames))
        ->capture_default_str();
    app->add_option("--pose-angle-deg", given->steps.pose_angle_deg, "torch angle that the paper's law begins with")
        ->capture_default_str();
    app->add_option("--speed-mm-s", given->speed_mm_s, "travel speed; the same as --set plan.speed_mm_s=SPEED");
    app->add_option("--period-s", given->steps.period_s, "interpolation period; a step is speed times period");
    app->add_option(
        "--groove", given->groove,
        "weld in the passes that fill this groove; the same as --set plan.groove=FORM; " + join(kGrooveFormNames));
    app->add_option("--groove-depth-mm", given->groove_depth_mm, "the same as --set plan.groove_depth_mm=DEPTH");
    app->add_option("--bead-area-mm2", given->bead_area_mm2, "the same as --set plan.bead_area_mm2=AREA");
    app->add_option("--robot", given->robot, "robots; the same as --set export.robots=NAMES");
    app->add_option("--config", given->config, "config file, JSON with comments; plan and export count");
    app->add_option("--set", given->set, "stage.key=value, over the config file")->allow_extra_args(false);
    app->add_option("--from", given->from,
                    "folder of a run that fitted a saddle: with nominal dimensions, compares; without, takes its "
                    "dimensions");
    app->add_option("--seam", given->seam, "which seam of that run; without: every saddle in it");
    app->add_option("--out", given->out, "folder for the results")->required();
    app->add_flag("--json", given->json, "for machines");
    app->footer(
        "Examples:\n"
        "  seampath saddle --header-radius-mm 600 --branch-radius-mm 150 --angle-deg 60 --offset-mm 80 "
        "--speed-mm-s 8 --period-s 0.1 --robot abb --out out/leaning\n"
        "  seampath saddle --header-radius-mm 600 --branch-radius-mm 150 --groove fillet --groove-depth-mm 8 "
        "--bead-area-mm2 20 --out out/passes\n"
        "  seampath saddle --from out/part --header-radius-mm 60 --branch-radius-mm 30 --out out/as-built\n"
        "Frame: z up, the header's axis along y; branch angle 0 is where the branch faces +y, and it runs towards +x. "
        "saddle_points.csv holds the interpolation points; waypoints and programs hold the chord tolerance and the "
        "constant speed of plan.*. --from compares in this frame: fitted - nominal at equal branch angles.\n");
    return {app, [given, app] {
                check_use(*app, *given);
                return saddle(*given);
            }};
}

}  // namespace seampath
