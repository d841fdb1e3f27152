#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>
#include <numbers>

#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/run.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/nominal/nominal.hpp"
#include "stages/text.hpp"
#include "tools/commands.hpp"
#include "tools/progress_line.hpp"
#include "tools/stop_signal.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180;

constexpr const char* kPointsFile = "saddle_points.csv";
constexpr const char* kFactsFile = "saddle.json";

/// Places at which the range of opening and curvature is looked for: every 0.05 deg.
constexpr int kLooks = 7200;

struct Arguments {
    std::string header = "cylinder";
    double branch_radius_mm = 0;
    std::optional<double> header_radius_mm, head_depth_mm, cone_half_angle_deg;
    double angle_deg = 90;
    double offset_mm = 0;
    std::string step = "arc-length";
    int steps = 40;
    std::string pose = "bisector";
    double pose_angle_deg = 45;
    std::optional<double> speed_mm_s, period_s;
    std::string out;
    std::optional<fs::path> config;
    std::string robot;
    std::vector<std::string> set;
    bool json = false;
};

template <class Enum, std::size_t n>
Enum chosen(const std::string& option, const std::string& word, const std::array<std::string_view, n>& names) {
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) {
        throw InputError(option + ": \"" + word + "\" is not known; there are " + join(names) + hint(word, names));
    }
    return static_cast<Enum>(found - names.begin());
}

/// The size that a kind of header needs, or refused where it has no such size.
double size_for(const std::string& option, const std::optional<double>& value, const std::string& header, bool needed) {
    if (value.has_value() != needed) {
        throw InputError(option + ": the header \"" + header + "\" " +
                         (needed ? "needs it; give it a value" : "has no such size; leave it out"));
    }
    return value.value_or(0);
}

SaddleDimensions dimensions_of(const Arguments& given) {
    SaddleDimensions d;
    d.header = chosen<HeaderKind>("--header", given.header, kHeaderNames);
    d.branch_radius_mm = given.branch_radius_mm;
    d.header_radius_mm =
        size_for("--header-radius-mm", given.header_radius_mm, given.header, d.header != HeaderKind::plane);
    d.head_depth_mm = size_for("--head-depth-mm", given.head_depth_mm, given.header, d.header == HeaderKind::ellipsoid);
    d.cone_half_angle = kDegree * size_for("--cone-half-angle-deg", given.cone_half_angle_deg, given.header,
                                           d.header == HeaderKind::cone);
    d.angle = given.angle_deg * kDegree;
    d.offset_mm = given.offset_mm;
    return d;
}

Config config_of(const Arguments& given) {
    std::vector<Override> overrides;
    for (const auto& argument : given.set) {
        overrides.push_back(parse_override(argument));
    }
    if (!given.robot.empty()) {
        overrides.push_back({"--robot", "export.robots", given.robot});
    }
    if (given.speed_mm_s) {
        overrides.push_back({"--speed-mm-s", "plan.speed_mm_s", shortest(*given.speed_mm_s)});
    }
    return read_config(given.config, overrides);
}

/// The interpolation points of one saddle.
struct Interpolation {
    StepLaw law = StepLaw::arc_length;
    PoseLaw pose = PoseLaw::bisector;
    double initial = 0;  ///< the paper's phi, rad
    double step_mm = 0;
    double speed_mm_s = 0;
    std::vector<double> angles;
};

Interpolation interpolate(const SaddleCurve& curve, const Arguments& given, double speed_mm_s) {
    Interpolation i;
    i.law = chosen<StepLaw>("--step", given.step, kStepLawNames);
    i.pose = chosen<PoseLaw>("--pose", given.pose, kPoseLawNames);
    i.initial = given.pose_angle_deg * kDegree;
    i.speed_mm_s = speed_mm_s;
    if (given.period_s && !(*given.period_s > 0 && std::isfinite(*given.period_s))) {
        throw InputError("--period-s: " + shortest(*given.period_s) + " is no period; a time above 0 is needed");
    }
    if (given.steps < 1) {
        throw InputError("--steps: " + std::to_string(given.steps) + " is too few; at least 1 is needed");
    }
    i.step_mm = given.period_s ? speed_mm_s * *given.period_s : curve.length() / given.steps;
    constexpr double kMostSteps = 1e7;
    if (curve.length() / i.step_mm > kMostSteps) {
        throw InputError("--period-s: steps of " + shortest(i.step_mm) +
                         " mm are more than 10 million round this seam; a longer period is needed");
    }
    i.angles = step_angles(curve, i.law, i.step_mm);
    return i;
}

std::string points_csv(const SaddleCurve& curve, const Interpolation& i) {
    std::string text =
        "# frame: nominal (right-handed)\n"
        "# unit: mm, s, deg; theta: branch angle; torch: its angle from the branch's wall, square to travel\n"
        "index,theta_deg,station_mm,time_s,x,y,z,torch_deg,opening_deg,curvature_per_mm,tx,ty,tz,n1x,n1y,n1z,n2x,n2y,"
        "n2z\n";
    double time_s = 0, before_mm = 0;
    for (std::size_t k = 0; k < i.angles.size(); ++k) {
        const SaddlePoint s = curve.at(i.angles[k]);
        const double station_mm = curve.station(i.angles[k]);
        // Every step takes one period, but for what is left over at the end.
        const bool last = k + 1 == i.angles.size();
        time_s =
            last ? time_s + (station_mm - before_mm) / i.speed_mm_s : static_cast<double>(k) * i.step_mm / i.speed_mm_s;
        before_mm = station_mm;
        text += std::to_string(k);
        for (const double value :
             {s.theta / kDegree, station_mm, time_s, s.p.x(), s.p.y(), s.p.z(),
              torch_angle(s, i.pose, i.initial) / kDegree, s.opening / kDegree, s.curvature_per_mm, s.tangent.x(),
              s.tangent.y(), s.tangent.z(), s.n1.x(), s.n1.y(), s.n1.z(), s.n2.x(), s.n2.y(), s.n2.z()}) {
            text += ',' + shortest(value);
        }
        text += '\n';
    }
    return text;
}

struct Range {
    double low = 0, high = 0;
};

template <class Number>
Range range(const SaddleCurve& curve, const Number& number) {
    Range r{number(curve.at(0)), number(curve.at(0))};
    for (int k = 1; k < kLooks; ++k) {
        const double value = number(curve.at(2 * std::numbers::pi * k / kLooks));
        r = {std::min(r.low, value), std::max(r.high, value)};
    }
    return r;
}

/// The dimensions that were given, and no others.
Json dimensions_json(const Arguments& given) {
    Json json{{"header", given.header}, {"branch_radius_mm", given.branch_radius_mm}};
    const auto add = [&json](const char* key, const std::optional<double>& value) {
        if (value) {
            json[key] = *value;
        }
    };
    add("header_radius_mm", given.header_radius_mm);
    add("head_depth_mm", given.head_depth_mm);
    add("cone_half_angle_deg", given.cone_half_angle_deg);
    add("angle_deg", given.angle_deg);
    add("offset_mm", given.offset_mm);
    return json;
}

/// What is known of the saddle, its steps and its model.
Json facts_of(const Arguments& given, const SaddleCurve& curve, const Interpolation& i, const PartResult& part) {
    const Range opening = range(curve, [](const SaddlePoint& s) { return s.opening / kDegree; });
    const Range bend = range(curve, [](const SaddlePoint& s) { return s.curvature_per_mm; });
    const StepErrors errors = step_errors(curve, i.angles, i.step_mm);
    return {{"dimensions", dimensions_json(given)},
            {"length_mm", curve.length()},
            {"opening_least_deg", opening.low},
            {"opening_most_deg", opening.high},
            {"curvature_least_per_mm", bend.low},
            {"curvature_most_per_mm", bend.high},
            {"step", kStepLawNames.at(static_cast<std::size_t>(i.law))},
            {"step_mm", i.step_mm},
            {"steps", i.angles.size() - 1},
            {"period_s", i.step_mm / i.speed_mm_s},
            {"speed_error_arc_percent", 100 * errors.arc},
            {"speed_error_chord_percent", 100 * errors.chord},
            {"pose", kPoseLawNames.at(static_cast<std::size_t>(i.pose))},
            {"curve_control_points", part.models.front().curve.control.size()},
            {"curve_error_mm", part.models.front().residual_max_mm},
            {"waypoints", part.plan.waypoints.size()},
            {"duration_s", part.plan.duration_s},
            {"programs", part.programs.size()}};
}

/// "0.11", "6.22e-13"
std::string three_digits(double value) {
    std::array<char, 40> buffer;
    return {buffer.data(),
            std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 3).ptr};
}

void print(const Json& facts, const fs::path& out) {
    const auto number = [&](const char* key, int decimals) { return fixed(facts.at(key).get<double>(), decimals); };
    const auto brief = [&](const char* key) { return three_digits(facts.at(key).get<double>()); };
    std::cout << aligned(std::vector<std::vector<std::string>>{
        {"length", number("length_mm", 4) + " mm"},
        {"opening", number("opening_least_deg", 2) + " to " + number("opening_most_deg", 2) + " deg"},
        {"curvature", number("curvature_least_per_mm", 6) + " to " + number("curvature_most_per_mm", 6) + " per mm"},
        {"steps", facts.at("steps").dump() + ", " + facts.at("step").get<std::string>() + ", " + number("step_mm", 4) +
                      " mm, " + number("period_s", 4) + " s each"},
        {"speed error", brief("speed_error_arc_percent") + " % along the curve, " + brief("speed_error_chord_percent") +
                            " % in straight moves"},
        {"curve", facts.at("curve_control_points").dump() + " control points, within " + brief("curve_error_mm") +
                      " mm of the exact seam"},
        {"torch path", facts.at("waypoints").dump() + " waypoints, " + number("duration_s", 1) + " s"},
        {"points", (out / kPointsFile).string()},
        {"report", (out / "report.html").string()},
        {"programs", (out / "programs").string()}});
}

int saddle(const Arguments& given) {
    watch_stop_signals();
    const Config config = config_of(given);
    const SaddleCurve curve = saddle_of(dimensions_of(given));
    const Interpolation points = interpolate(curve, given, config.plan.speed_mm_s);
    for (const auto* earlier : {kPointsFile, kFactsFile}) {
        RunFolder(given.out).remove(earlier);
    }
    ProgressLine line("");
    const PartResult part =
        run_nominal("saddle", {nominal_model(curve, points.pose, points.initial)}, given.out, config, line.progress());
    const Json facts = facts_of(given, curve, points, part);
    const std::string text = facts.dump(4) + "\n";
    const RunFolder folder(given.out);
    folder.write(kPointsFile, points_csv(curve, points));
    folder.write(kFactsFile, text);
    if (given.json) {
        std::cout << text;
    } else {
        print(facts, given.out);
    }
    return kPass;
}

void add_dimensions(CLI::App& app, Arguments& given) {
    app.add_option("--branch-radius-mm", given.branch_radius_mm, "outer radius of the branch, mm")->required();
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
    const auto given = std::make_shared<Arguments>();
    add_dimensions(*app, *given);
    app->add_option("--step", given->step, "law of the interpolation steps: " + join(kStepLawNames))
        ->capture_default_str();
    app->add_option("--steps", given->steps, "interpolation steps once round, where no period is given")
        ->capture_default_str();
    app->add_option("--pose", given->pose,
                    "law of the torch angle: the paper's (12), or the bisector of both walls; " + join(kPoseLawNames))
        ->capture_default_str();
    app->add_option("--pose-angle-deg", given->pose_angle_deg, "torch angle that the paper's law begins with")
        ->capture_default_str();
    app->add_option("--speed-mm-s", given->speed_mm_s, "travel speed; the same as --set plan.speed_mm_s=SPEED");
    app->add_option("--period-s", given->period_s, "interpolation period; a step is speed times period");
    app->add_option("--robot", given->robot, "robots; the same as --set export.robots=NAMES");
    app->add_option("--config", given->config, "config file, JSON with comments; plan and export count");
    app->add_option("--set", given->set, "stage.key=value, over the config file")->allow_extra_args(false);
    app->add_option("--out", given->out, "folder for the results")->required();
    app->add_flag("--json", given->json, "for machines");
    app->footer(
        "Examples:\n"
        "  seampath saddle --header-radius-mm 600 --branch-radius-mm 150 --out out/saddle\n"
        "  seampath saddle --header-radius-mm 600 --branch-radius-mm 150 --angle-deg 60 --offset-mm 80 "
        "--speed-mm-s 8 --period-s 0.1 --robot abb --out out/leaning\n"
        "  seampath saddle --header plane --branch-radius-mm 40 --angle-deg 50 --pose paper --out out/plate\n"
        "Frame: z up, the header's axis along y; branch angle 0 is where the branch faces +y, and it runs towards +x. "
        "saddle_points.csv holds the interpolation points; waypoints and programs hold the chord tolerance and the "
        "constant speed of plan.*\n");
    return {app, [given] { return saddle(*given); }};
}

}  // namespace seampath
