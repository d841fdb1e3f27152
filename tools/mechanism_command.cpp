#include <algorithm>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/mechanism_drawing.hpp"
#include "pipeline/text.hpp"
#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/mechanism/mechanism.hpp"
#include "stages/text.hpp"
#include "tools/choice.hpp"
#include "tools/commands.hpp"
#include "tools/mechanism_path.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Eigen::Vector2d;
using Rows = std::vector<std::vector<std::string>>;

struct MechanismArguments {
    double radius_mm = 500;
    double alpha_step_deg = 10;
    double beta_step_deg = 5;
    std::vector<double> from, to;
    std::string path;
    std::optional<int> seam;
    std::string method = "least-distance";
    std::optional<double> finest_deg;
    std::string out;
    bool json = false;
};

Vector2d point_of(const char* option, const std::vector<double>& values) {
    if (values.size() != 2) {
        throw InputError(std::string(option) + ": " + std::to_string(values.size()) +
                         " numbers; a point X,Y in mm is needed");
    }
    return {values[0], values[1]};
}

MechanismPath wanted_path(const MechanismArguments& given) {
    const bool line = !given.from.empty() && !given.to.empty();
    if (line == !given.path.empty() || given.from.empty() != given.to.empty()) {
        throw InputError("mechanism: a path is needed, and one only: --from X,Y with --to X,Y, or --path FILE.csv");
    }
    if (line && given.seam) {
        throw InputError("--seam: is for the seams that --path names; leave it out");
    }
    if (line) {
        return {{point_of("--from", given.from), point_of("--to", given.to)}, std::nullopt};
    }
    return mechanism_path(given.path, given.seam);
}

Json error_json(const PathError& error) {
    return {{"nodes", error.nodes}, {"rms_mm", error.rms_mm}, {"max_mm", error.max_mm}};
}

/// What is left out by the projection to the mechanism's plane.
std::string height_text(const MechanismPath& wanted) {
    return wanted.height_mm ? "path projected along z, which goes from " + fixed((*wanted.height_mm)[0], 3) + " to " +
                                  fixed((*wanted.height_mm)[1], 3) + " mm\n"
                            : "";
}

Json path_json(const TwoTierGrid& grid, const GridPath& path, const std::string& method) {
    return {{"method", method},
            {"radius_mm", grid.radius_mm},
            {"alpha_step_deg", 360.0 / grid.alpha_steps},
            {"beta_step_deg", 60.0 / grid.beta_steps},
            {"nodes", path.nodes.size()},
            {"beats", axis_steps(grid, path).size()},
            {"interior", error_json(path.interior)},
            {"after_first", error_json(path.after_first)},
            {"all", error_json(path.all)},
            {"start_gap_mm", path.start_gap_mm},
            {"end_gap_mm", path.end_gap_mm}};
}

/// One beat a row, after the place that the mechanism begins at.
std::string steps_csv(const TwoTierGrid& grid, const GridPath& path) {
    std::string text =
        "# unit: mm, deg; steps of each axis, and where they lead\n"
        "index,alpha_steps,beta_steps,alpha_deg,beta_deg,x,y\n";
    GridNode at = path.nodes.front().node;
    std::size_t index = 0;
    const auto row = [&](const AxisStep& step) {
        const Vector2d p = position(grid, at);
        text += std::to_string(index++) + ',' + std::to_string(step.alpha) + ',' + std::to_string(step.beta);
        for (const double value : {360.0 * at.i / grid.alpha_steps, 60.0 * at.j / grid.beta_steps, p.x(), p.y()}) {
            text += ',' + shortest(value);
        }
        text += '\n';
    };
    row({});
    for (const AxisStep& step : axis_steps(grid, path)) {
        at = {(at.i + step.alpha + grid.alpha_steps) % grid.alpha_steps, at.j + step.beta};
        row(step);
    }
    return text;
}

/// The same path on grids that halve until the finer of both steps is at most `finest_deg`.
Json series_json(const MechanismArguments& given, const std::vector<Vector2d>& wanted, GridMethod method) {
    if (!(*given.finest_deg > 0)) {
        throw InputError("--table: " + shortest(*given.finest_deg) + " deg is no step; a step above 0 is needed");
    }
    Json series = Json::array();
    for (double share = 1;; share /= 2) {
        const double alpha_deg = given.alpha_step_deg * share, beta_deg = given.beta_step_deg * share;
        const TwoTierGrid grid = two_tier_grid(given.radius_mm, alpha_deg * kDegree, beta_deg * kDegree);
        series.push_back(path_json(grid, follow(grid, wanted, method), given.method));
        if (std::min(alpha_deg, beta_deg) <= *given.finest_deg) {
            return series;
        }
    }
}

std::string series_text(const Json& series) {
    Rows rows{{"alpha deg", "beta deg", "nodes", "beats", "rms mm", "largest mm", "end gap mm"}};
    for (const Json& row : series) {
        const auto number = [&](const Json& value) { return fixed(value.get<double>(), 4); };
        rows.push_back({shortest(row.at("alpha_step_deg").get<double>()),
                        shortest(row.at("beta_step_deg").get<double>()), row.at("nodes").dump(), row.at("beats").dump(),
                        number(row.at("interior").at("rms_mm")), number(row.at("interior").at("max_mm")),
                        number(row.at("end_gap_mm"))});
    }
    return aligned(rows);
}

std::string path_text(const TwoTierGrid& grid, const GridPath& path) {
    const auto row = [](const char* set, const PathError& error) {
        return std::vector<std::string>{set, std::to_string(error.nodes), fixed(error.rms_mm, 6),
                                        fixed(error.max_mm, 4)};
    };
    return std::to_string(path.nodes.size()) + " nodes, " + std::to_string(axis_steps(grid, path).size()) +
           " beats; the first " + fixed(path.start_gap_mm, 3) + " mm from the path's start, the last " +
           fixed(path.end_gap_mm, 3) + " mm from its end\n\n" +
           aligned(Rows{{"distance from the line", "nodes", "rms mm", "largest mm"},
                        row("nodes in between", path.interior),
                        row("all but the first", path.after_first),
                        row("all", path.all)});
}

int two_tier(const MechanismArguments& given) {
    const GridMethod method = static_cast<GridMethod>(choice("--method", given.method, kGridMethodNames));
    const TwoTierGrid grid =
        two_tier_grid(given.radius_mm, given.alpha_step_deg * kDegree, given.beta_step_deg * kDegree);
    const MechanismPath wanted = wanted_path(given);
    const GridPath path = follow(grid, wanted.points, method);
    Json json = path_json(grid, path, given.method);
    if (wanted.height_mm) {
        json["height_mm"] = *wanted.height_mm;
    }
    if (given.finest_deg) {
        json["series"] = series_json(given, wanted.points, method);
    }
    if (!given.out.empty()) {
        const RunFolder folder(given.out);
        folder.write("steps.csv", steps_csv(grid, path));
        folder.write("grid.svg", mechanism_svg(grid, wanted.points, path));
        folder.write("mechanism.json", json.dump(4) + "\n");
    }
    if (given.json) {
        std::cout << json.dump(4) << "\n";
    } else {
        std::cout << height_text(wanted) << path_text(grid, path)
                  << (given.finest_deg ? "\n" + series_text(json.at("series")) : "");
    }
    return kPass;
}

}  // namespace

Command mechanism_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("mechanism", "step sequences for mechanisms that are no robots");
    app->require_subcommand(1);
    const char* examples =
        "Examples:\n"
        "  seampath mechanism two-tier --from -350,-100 --to 160,280\n"
        "  seampath mechanism two-tier --from -350,-100 --to 160,280 --method bresenham --table 0.01\n"
        "  seampath mechanism two-tier --radius-mm 800 --alpha-step-deg 0.02 --beta-step-deg 0.01 --path out/part "
        "--seam 0 --method optimal --out out/steps\n";
    app->footer(examples);
    const auto given = std::make_shared<MechanismArguments>();
    CLI::App* tier = app->add_subcommand("two-tier", "a rod on a turning disc (Naumov et al.)");
    tier->add_option("--radius-mm", given->radius_mm, "radius of the disc and length of the rod")
        ->capture_default_str();
    tier->add_option("--alpha-step-deg", given->alpha_step_deg, "step of the disc; goes into 360 deg without rest")
        ->capture_default_str();
    tier->add_option("--beta-step-deg", given->beta_step_deg, "step of the rod; goes into 60 deg without rest")
        ->capture_default_str();
    tier->add_option("--from", given->from, "X,Y of the line's start, mm")->delimiter(',')->allow_extra_args(false);
    tier->add_option("--to", given->to, "X,Y of its end")->delimiter(',')->allow_extra_args(false);
    tier->add_option(
        "--path", given->path,
        "CSV file of a polyline instead, columns x and y, mm; or the folder of a run, for one of its seams, in "
        "the base that its export.base_from_scan says; projected along z");
    tier->add_option("--seam", given->seam, "which seam of the run, or of the file's column seam");
    tier->add_option("--method", given->method, "how nodes are chosen: " + join(kGridMethodNames))
        ->capture_default_str();
    tier->add_option("--table", given->finest_deg, "also the errors on grids that halve down to this step, deg");
    tier->add_option("--out", given->out, "folder for steps.csv, grid.svg and mechanism.json");
    tier->add_flag("--json", given->json, "for machines");
    tier->footer(std::string(examples) +
                 "The paper's figure for least distance is of the nodes in between, that for Bresenham's method of all "
                 "but the first.\n");
    return {app, [given] { return two_tier(*given); }};
}

}  // namespace seampath
