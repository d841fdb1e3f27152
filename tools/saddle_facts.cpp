#include "tools/saddle_facts.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <numbers>

#include <nlohmann/json.hpp>

#include "pipeline/text.hpp"
#include "stages/angle.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

/// Places at which the range of opening and curvature is looked for: every 0.05 deg.
constexpr int kLooks = 7200;

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

Json passes_json(const std::vector<PlannedPass>& passes) {
    Json list = Json::array();
    for (const PlannedPass& p : passes) {
        list.push_back({{"layer", p.layer},
                        {"bead", p.bead},
                        {"across_mm", p.across_mm},
                        {"up_mm", p.up_mm},
                        {"tilt_deg", p.tilt_rad / kDegree},
                        {"area_mm2", p.area_mm2},
                        {"least_area_mm2", p.least_mm2},
                        {"most_area_mm2", p.most_mm2}});
    }
    return list;
}

/// The passes of a groove, in the order of welding.
std::string passes_text(const std::vector<PlannedPass>& passes) {
    if (passes.empty()) {
        return "";
    }
    std::vector<std::vector<std::string>> rows{
        {"pass", "layer", "across mm", "up mm", "tilt deg", "area mm2", "least", "most"}};
    for (std::size_t i = 0; i < passes.size(); ++i) {
        const PlannedPass& p = passes[i];
        rows.push_back({std::to_string(i), std::to_string(p.layer), fixed(p.across_mm, 3), fixed(p.up_mm, 3),
                        fixed(p.tilt_rad / kDegree, 2), fixed(p.area_mm2, 2), fixed(p.least_mm2, 2),
                        fixed(p.most_mm2, 2)});
    }
    return "\n" + aligned(rows);
}

/// "0.11", "6.22e-13"
std::string three_digits(double value) {
    std::array<char, 40> buffer;
    return {buffer.data(),
            std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 3).ptr};
}

}  // namespace

Json saddle_facts(const Json& dimensions, const SaddleCurve& curve, const SaddleSteps& i, const PartResult& part) {
    const Range opening = range(curve, [](const SaddlePoint& s) { return s.opening / kDegree; });
    const Range bend = range(curve, [](const SaddlePoint& s) { return s.curvature_per_mm; });
    const StepErrors errors = step_errors(curve, i.angles, i.step_mm);
    return {{"dimensions", dimensions},
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
            {"passes", passes_json(part.plan.passes)},
            {"arm", part.plan.arm ? Json(part.plan.arm->verdict) : Json()},
            {"programs", part.programs.size()}};
}

std::string saddle_facts_text(const Json& facts, const PartResult& part,
                              const std::vector<std::vector<std::string>>& files) {
    const auto number = [&](const char* key, int decimals) { return fixed(facts.at(key).get<double>(), decimals); };
    const auto brief = [&](const char* key) { return three_digits(facts.at(key).get<double>()); };
    std::vector<std::vector<std::string>> rows{
        {"length", number("length_mm", 4) + " mm"},
        {"opening", number("opening_least_deg", 2) + " to " + number("opening_most_deg", 2) + " deg"},
        {"curvature", number("curvature_least_per_mm", 6) + " to " + number("curvature_most_per_mm", 6) + " per mm"},
        {"steps", facts.at("steps").dump() + ", " + facts.at("step").get<std::string>() + ", " + number("step_mm", 4) +
                      " mm, " + number("period_s", 4) + " s each"},
        {"speed error", brief("speed_error_arc_percent") + " % along the curve, " + brief("speed_error_chord_percent") +
                            " % in straight moves"},
        {"curve", facts.at("curve_control_points").dump() + " control points, within " + brief("curve_error_mm") +
                      " mm of the exact seam"},
        {"torch path", facts.at("waypoints").dump() + " waypoints, " + number("duration_s", 1) + " s"}};
    rows.insert(rows.end(), files.begin(), files.end());
    return aligned(rows) + passes_text(part.plan.passes) + (part.plan.arm ? "\n" + part.plan.arm->verdict + "\n" : "");
}

}  // namespace seampath
