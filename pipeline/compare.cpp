#include "pipeline/compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <tuple>

#include <nlohmann/json.hpp>

#include "pipeline/compare_pairs.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/stored_run.hpp"
#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostComparedBytes = std::size_t{1} << 31;
constexpr double kScalarSigmas = 3;       // 99.7 % of one Gaussian number
constexpr double kDistanceSigmas = 3.41;  // 99.7 % of the length of two: sqrt(-2 ln 0.003)

ComparedRun load_compared(const fs::path& folder) {
    const fs::path file = folder / "report.json";
    if (!fs::is_regular_file(file)) {
        throw InputError("compare: " + folder.string() +
                         " has no report.json; a folder that \"seampath run\" wrote was needed; check the path");
    }
    ComparedRun run{folder.string(), "", read_file(file, kMostComparedBytes, "compare"), load_models(folder),
                    load_deviations(folder)};
    try {
        const Json report = parse_json(run.report);
        run.part = report.at("part");
        if (report.at("seams").size() == run.models.size() && run.deviations.size() == run.models.size()) {
            return run;
        }
    } catch (const std::runtime_error&) {  // no JSON
    } catch (const Json::exception&) {     // other JSON
    }
    throw InputError("compare: " + file.string() + " is not the report of this run; run the scan again");
}

using Rows = std::map<std::string, Json>;

Rows rows_by_name(const Json& rows) {
    Rows by_name;
    for (const Json& row : rows) {
        by_name[row.at("name")] = row;
    }
    return by_name;
}

std::string text_of_value(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

/// "branch_radius_mm" -> "branch_radius_sigma_mm"; groove medians "gap_median_mm" -> "gap_sigma_mm".
std::string sigma_name(const std::string& name) {
    const std::size_t unit = name.rfind('_');
    if (unit == std::string::npos) {
        return "";
    }
    std::string base = name.substr(0, unit);
    constexpr std::string_view kMedian = "_median";
    base.resize(base.size() - (base.ends_with(kMedian) ? kMedian.size() : 0));
    return base + "_sigma" + name.substr(unit);
}

std::optional<double> sigma_of(const Rows& a, const Rows& b, const std::string& name) {
    const std::string sigma = sigma_name(name);
    const auto in_a = a.find(sigma), in_b = b.find(sigma);
    if (name.find("_sigma") != std::string::npos || in_a == a.end() || in_b == b.end() ||
        !in_a->second.at("value").is_number() || !in_b->second.at("value").is_number()) {
        return {};
    }
    return std::hypot(in_a->second.at("value").get<double>(), in_b->second.at("value").get<double>());
}

/// Rows that must be the same in both runs.
bool must_be_equal(const std::string& name) {
    return name == "kind" || name == "closed" || name == "in_tolerance" || name == "seams";
}

Difference row_difference(const std::string& of, const std::string& name, const Rows& a, const Rows& b) {
    const Json none;
    const auto value = [&](const Rows& rows) { return rows.contains(name) ? rows.at(name).at("value") : none; };
    const Json va = value(a), vb = value(b);
    Difference d{of, name, va.is_null() ? "" : text_of_value(va), vb.is_null() ? "" : text_of_value(vb), {}, {}, {}};
    if (va.is_number() && vb.is_number()) {
        d.difference = vb.get<double>() - va.get<double>();
        d.sigma = sigma_of(a, b, name);
    }
    if (d.sigma) {
        d.allowed = kScalarSigmas * *d.sigma;
        d.verdict = std::abs(*d.difference) <= *d.allowed ? DifferenceVerdict::same : DifferenceVerdict::differs;
    } else if (must_be_equal(name)) {
        d.verdict = va == vb ? DifferenceVerdict::same : DifferenceVerdict::differs;
    }
    return d;
}

/// All rows that either run has, but for those that say the same and are held against nothing.
void add_rows(std::vector<Difference>& list, const std::string& of, const Json& a, const Json& b) {
    const Rows rows_a = rows_by_name(a), rows_b = rows_by_name(b);
    Rows all = rows_a;
    all.insert(rows_b.begin(), rows_b.end());
    for (const auto& [name, row] : all) {
        Difference d = row_difference(of, name, rows_a, rows_b);
        if (d.a != d.b || d.sigma) {
            list.push_back(std::move(d));
        }
    }
}

/// Distances between the curves of a pair.
void add_distances(std::vector<Difference>& list, const std::string& of, const SeamPair& pair) {
    std::vector<double> distance, sigma, across, up;
    for (const PairPlace& place : pair.places) {
        distance.push_back(place.off.norm());
        sigma.push_back(place.sigma_mm);
        across.push_back(place.across_mm);
        up.push_back(place.up_mm);
    }
    const double kept = quantile(distance, 0.997), usual = quantile(sigma, 0.5);
    Difference d{of, "distance_p997_mm", "", "", kept, usual, std::max(kDistanceSigmas * usual, pair.tolerance_mm)};
    d.verdict = kept <= kDistanceSigmas * usual ? DifferenceVerdict::same
                : kept <= pair.tolerance_mm     ? DifferenceVerdict::tolerated
                                                : DifferenceVerdict::differs;
    list.push_back(std::move(d));
    list.push_back({of, "distance_max_mm", "", "", quantile(distance, 1), {}, {}});
    list.push_back({of, "across_median_mm", "", "", quantile(across, 0.5), {}, {}});
    list.push_back({of, "up_median_mm", "", "", quantile(up, 0.5), {}, {}});
}

std::string seam_label(std::size_t a, std::size_t b) {
    return "seam " + std::to_string(a) + (a == b ? "" : " / " + std::to_string(b));
}

/// Seams that only one of the runs has.
void add_unpaired(RunComparison& c) {
    for (const bool first : {true, false}) {
        const std::size_t count = (first ? c.a : c.b).models.size();
        for (std::size_t i = 0; i < count; ++i) {
            const bool paired = std::any_of(c.pairs.begin(), c.pairs.end(),
                                            [&](const SeamPair& pair) { return (first ? pair.a : pair.b) == i; });
            if (!paired) {
                c.differences.push_back({"seam " + std::to_string(i),
                                         "found",
                                         first ? "yes" : "no",
                                         first ? "no" : "yes",
                                         {},
                                         {},
                                         {},
                                         DifferenceVerdict::differs});
            }
        }
    }
}

void add_settings(RunComparison& c, const fs::path& a, const fs::path& b) {
    const auto flat = [](const fs::path& folder) {
        return parse_json(read_file(folder / "config.resolved.json", kMostComparedBytes, "compare")).flatten();
    };
    const Json of_a = flat(a), of_b = flat(b);
    Json all = of_a;
    all.update(of_b);
    for (const auto& [key, value] : all.items()) {
        const std::string va = of_a.contains(key) ? text_of_value(of_a[key]) : "";
        const std::string vb = of_b.contains(key) ? text_of_value(of_b[key]) : "";
        if (va != vb) {
            c.settings.push_back({"settings", key.substr(1), va, vb, {}, {}, {}});
        }
    }
}

/// What differs first, then by the share of what is allowed, then what is only told, by its size.
bool is_worse_difference(const Difference& x, const Difference& y) {
    const auto relative = [](const Difference& d) {
        const double size = d.difference ? std::abs(*d.difference) : 0;
        return d.difference && !d.a.empty() ? size / (size + std::abs(std::strtod(d.a.c_str(), nullptr)) + 1e-300)
                                            : size;
    };
    const auto rank = [](const Difference& d) {
        return d.verdict == DifferenceVerdict::differs ? 0 : d.verdict == DifferenceVerdict::told ? 2 : 1;
    };
    const auto key = [&](const Difference& d) { return std::tuple(rank(d), -d.share(), -relative(d)); };
    return key(x) < key(y);
}

std::string comparison_sentence(const RunComparison& c) {
    const auto differ = std::count_if(c.differences.begin(), c.differences.end(),
                                      [](const auto& d) { return d.verdict == DifferenceVerdict::differs; });
    std::string text = std::to_string(c.pairs.size()) + (c.pairs.size() == 1 ? " seam" : " seams") + " compared: ";
    if (differ == 0) {
        return text + "nothing differs by more than the sigmas explain or the tolerance allows";
    }
    const Difference& worst = c.differences.front();
    text += std::to_string(differ) + (differ == 1 ? " difference" : " differences") +
            " beyond what sigmas and tolerance allow; the worst is " + worst.name + " of " + worst.of;
    return worst.allowed ? text + ": " + fixed(std::abs(worst.difference.value_or(0)), 3) + ", allowed " +
                               fixed(*worst.allowed, 3)
                         : text;
}

}  // namespace

double Difference::share() const {
    return allowed && difference && *allowed > 0 ? std::abs(*difference) / *allowed : 0;
}

RunComparison compare_runs(const fs::path& a, const fs::path& b) {
    RunComparison c;
    c.a = load_compared(a);
    c.b = load_compared(b);
    c.pairs = pair_seams(c.a, c.b);
    const Json report_a = parse_json(c.a.report), report_b = parse_json(c.b.report);
    add_rows(c.differences, "part", report_a.at("rows"), report_b.at("rows"));
    for (const SeamPair& pair : c.pairs) {
        const std::string of = seam_label(pair.a, pair.b);
        add_distances(c.differences, of, pair);
        add_rows(c.differences, of, report_a.at("seams")[pair.a].at("rows"), report_b.at("seams")[pair.b].at("rows"));
    }
    add_unpaired(c);
    add_settings(c, a, b);
    std::stable_sort(c.differences.begin(), c.differences.end(), is_worse_difference);
    c.pass = std::none_of(c.differences.begin(), c.differences.end(),
                          [](const auto& d) { return d.verdict == DifferenceVerdict::differs; });
    c.sentence = comparison_sentence(c);
    return c;
}

}  // namespace seampath
