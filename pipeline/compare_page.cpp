#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "pipeline/compare.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/line_picture.hpp"
#include "pipeline/report_assets.hpp"
#include "pipeline/report_cells.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/svg.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr double kOverlayWidth = 1180, kOverlayHeight = 300, kPairWidth = 1180, kPairHeight = 220;
constexpr double kWhisker = 0.08;  // of the picture's extent: the largest difference as it is drawn
constexpr int kOverlayPoints = 200;
constexpr std::size_t kWhiskerEvery = 5;  // places of a pair

OrderedJson optional_json(const std::optional<double>& value) {
    return value ? OrderedJson(*value) : OrderedJson();
}

OrderedJson differences_json(const std::vector<Difference>& differences) {
    OrderedJson list = OrderedJson::array();
    for (const Difference& d : differences) {
        list.push_back({{"of", d.of},
                        {"name", d.name},
                        {"a", valid_utf8(d.a)},
                        {"b", valid_utf8(d.b)},
                        {"difference", optional_json(d.difference)},
                        {"sigma", optional_json(d.sigma)},
                        {"allowed", optional_json(d.allowed)},
                        {"verdict", name(d.verdict)}});
    }
    return list;
}

std::vector<Eigen::Vector3d> curve_points(const SeamModel& model) {
    const ArcLength arc(model.curve);
    std::vector<Eigen::Vector3d> points;
    for (int k = 0; k <= kOverlayPoints; ++k) {
        points.push_back(position(arc.curve(), arc.parameter(arc.length() * k / kOverlayPoints)));
    }
    if (model.closed) {
        points.back() = points.front();
    }
    return points;
}

/// Largest of 1, 2 or 5 times a power of ten by which the largest difference stays a whisker.
double exaggeration(double extent, double most) {
    const double wanted = kWhisker * extent / most;
    const double power = std::pow(10, std::floor(std::log10(wanted)));
    return power * (wanted / power >= 5 ? 5 : wanted / power >= 2 ? 2 : 1);
}

std::string overlay(const RunComparison& c) {
    std::vector<PictureLine> lines;
    Eigen::AlignedBox3d box;
    for (const auto& [run, style] : {std::pair(&c.a, "first"), std::pair(&c.b, "second")}) {
        for (const SeamModel& model : run->models) {
            lines.push_back({curve_points(model), style});
            for (const Eigen::Vector3d& p : lines.back().points) {
                box.extend(p);
            }
        }
    }
    double most = 0;
    for (const SeamPair& pair : c.pairs) {
        for (const PairPlace& place : pair.places) {
            most = std::max(most, place.off.norm());
        }
    }
    const double extent = box.isEmpty() ? 0 : box.diagonal().norm();
    const double times = most <= 1e-9 * extent ? 1 : exaggeration(extent, most);
    for (const SeamPair& pair : c.pairs) {
        for (std::size_t k = 0; k < pair.places.size(); k += kWhiskerEvery) {
            lines.push_back({{pair.places[k].p, pair.places[k].p + times * pair.places[k].off}, "apart"});
        }
    }
    return "<figure><figcaption><b>Both runs</b>, seen square to the plane nearest to their seams <i "
           "class=\"value\"></i>A "
           "<i class=\"second\"></i>B <i class=\"flank2\"></i>from A to B, drawn " +
           decimal(times, times < 1 ? 3 : 0) + " times as long</figcaption>" +
           line_picture(lines, kOverlayWidth, kOverlayHeight, "Seams of both runs") + "</figure>\n";
}

std::string distance_plot(const SeamPair& pair, double length_mm) {
    std::vector<PlotPoint> line, sigma;
    double most = 0;
    for (const PairPlace& place : pair.places) {
        line.push_back({place.station_mm, place.off.norm()});
        sigma.push_back({place.station_mm, place.sigma_mm});
        most = std::max({most, place.off.norm(), place.sigma_mm});
    }
    constexpr double kInSight = 6;  // a tolerance so many times larger would flatten the plot
    const bool in_sight = pair.tolerance_mm < kInSight * most;
    const double top = 1.12 * std::max(in_sight ? std::max(most, pair.tolerance_mm) : most, 1e-4);
    const PlotAxes axes{kPairWidth,    kPairHeight, 0, length_mm, 0, top, "station along the seam of A, mm",
                        "distance, mm"};
    return "<figure class=\"wide\"><figcaption><b>Distance of the curves</b> <i class=\"value\"></i>of B from A <i "
           "class=\"flank2\"></i>1σ of both together" +
           (in_sight ? std::string()
                     : ". The tolerance, " + decimal(pair.tolerance_mm, 3) + " mm, lies outside the plot") +
           "</figcaption>" + svg_axes(axes, "Distance of the curves along the seam") + svg_line(axes, sigma, "flank2") +
           svg_line(axes, line, "value") +
           (in_sight ? svg_level(axes, pair.tolerance_mm, "tolerance " + decimal(pair.tolerance_mm, 3) + " mm", "limit")
                     : "") +
           svg_end() + "</figure>\n";
}

std::vector<PlotPoint> deviations_of(const Deviation& deviation) {
    std::vector<PlotPoint> line;
    for (const DeviationSample& s : deviation.samples) {
        line.push_back({s.station_mm, s.covered ? s.distance_mm : std::numeric_limits<double>::quiet_NaN()});
    }
    return line;
}

/// B's deviations at the stations of A that they are nearest to.
std::vector<PlotPoint> moved_to_a(const SeamPair& pair, const Deviation& b) {
    std::vector<PlotPoint> line;
    for (const PairPlace& place : pair.places) {
        const auto sample = std::min_element(b.samples.begin(), b.samples.end(), [&](const auto& x, const auto& y) {
            return std::abs(x.station_mm - place.station_b_mm) < std::abs(y.station_mm - place.station_b_mm);
        });
        if (sample != b.samples.end()) {
            line.push_back(
                {place.station_mm, sample->covered ? sample->distance_mm : std::numeric_limits<double>::quiet_NaN()});
        }
    }
    return line;
}

std::string deviation_overlay(const RunComparison& c, const SeamPair& pair) {
    const std::vector<PlotPoint> a = deviations_of(c.a.deviations[pair.a]),
                                 b = moved_to_a(pair, c.b.deviations[pair.b]);
    double most = 1e-4;
    for (const auto* line : {&a, &b}) {
        for (const PlotPoint& p : *line) {
            most = std::isfinite(p.y) ? std::max(most, p.y) : most;
        }
    }
    const PlotAxes axes{
        kPairWidth,     kPairHeight, 0, c.a.models[pair.a].length_mm, 0, 1.12 * most, "station along the seam of A, mm",
        "deviation, mm"};
    return "<figure class=\"wide\"><figcaption><b>Deviation of each run from its own scan</b> <i class=\"value\"></i>A "
           "<i "
           "class=\"second\"></i>B</figcaption>" +
           svg_axes(axes, "Deviations of both runs from their scans") + svg_line(axes, b, "second") +
           svg_line(axes, a, "value") + svg_end() + "</figure>\n";
}

/// A value as people read it: numbers to six digits.
std::string short_value(const std::string& value) {
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    if (value.empty() || end != value.c_str() + value.size()) {
        return value.empty() ? "–" : escape_html(value);
    }
    return fixed(number, std::abs(number - std::round(number)) < 1e-12 ? 0 : 4);
}

std::string number_cell(const std::optional<double>& value) {
    return value ? "<td class=\"num\" data-value=\"" + shortest(*value) + "\">" + decimal(*value, 4) + "</td>"
                 : "<td class=\"num soft\">–</td>";
}

std::string difference_table(const std::vector<Difference>& differences) {
    std::string html = "<div class=\"scroll\"><table class=\"sortable\" id=\"differences\"><thead><tr>" +
                       heading("Of", false) + heading("What", false);
    for (const char* text : {"A", "B", "Difference", "1σ", "Allowed", "Share, %"}) {
        html += heading(text, true);
    }
    html += heading("Verdict", false) + "</tr></thead><tbody>\n";
    for (const Difference& d : differences) {
        const std::optional<double> share = d.allowed ? std::optional(100 * d.share()) : std::nullopt;
        const bool judged = d.verdict != DifferenceVerdict::told;
        const bool differs = d.verdict == DifferenceVerdict::differs;
        html += "<tr><td>" + d.of + "</td><th scope=\"row\" class=\"code\">" + escape_html(d.name) +
                "</th><td class=\"num\">" + short_value(d.a) + "</td><td class=\"num\">" + short_value(d.b) + "</td>" +
                number_cell(d.difference) + number_cell(d.sigma) + number_cell(d.allowed) + number_cell(share) +
                "<td>" +
                (judged ? std::string("<span class=\"badge ") + (differs ? "fail" : "pass") + "\">"
                        : "<span class=\"soft\">") +
                std::string(name(d.verdict)) + "</span></td></tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string settings_difference(const RunComparison& c) {
    if (c.settings.empty()) {
        return "<h2>Settings</h2><p class=\"soft\">Both runs have the same.</p>\n";
    }
    std::string html = "<h2>Settings that differ</h2><div class=\"scroll\"><table><thead><tr>" +
                       heading("Option", false) + heading("A", false) + heading("B", false) + "</tr></thead><tbody>";
    for (const Difference& d : c.settings) {
        html += "<tr><td class=\"code\">" + escape_html(d.name) + "</td><td class=\"code\">" + escape_html(d.a) +
                "</td><td class=\"code\">" + escape_html(d.b) + "</td></tr>";
    }
    return html + "</tbody></table></div>\n";
}

/// Both runs' own identities, side by side.
std::string runs_table(const RunComparison& c) {
    // Runs of builds that named none are compared as well.
    const OrderedJson none = OrderedJson::array(), a = parse_json(c.a.report).value("identity", none),
                      b = parse_json(c.b.report).value("identity", none);
    const auto value = [](const OrderedJson& rows, const std::string& name) {
        for (const OrderedJson& row : rows) {
            if (row.at("name") == name) {
                return escape_html(row.at("value").get<std::string>());
            }
        }
        return std::string("–");
    };
    std::string html = "<div class=\"scroll\"><table><thead><tr>" + heading("Run", false) + heading("A", false) +
                       heading("B", false) + "</tr></thead><tbody><tr><th scope=\"row\">Folder</th><td>" +
                       escape_html(c.a.name) + "</td><td>" + escape_html(c.b.name) + "</td></tr>";
    for (const auto& [name, label] :
         {std::pair("scan_file", "Scan"), std::pair("scan_sha256", "Scan, SHA-256"),
          std::pair("config_sha256", "Settings, SHA-256"), std::pair("build_sha256", "Build, SHA-256")}) {
        html += std::string("<tr><th scope=\"row\">") + label + "</th><td class=\"code\">" + value(a, name) +
                "</td><td class=\"code\">" + value(b, name) + "</td></tr>";
    }
    return html + "</tbody></table></div>\n";
}

}  // namespace

std::string run_comparison_json(const RunComparison& c) {
    OrderedJson pairs = OrderedJson::array();
    for (const SeamPair& pair : c.pairs) {
        pairs.push_back({{"a", pair.a}, {"b", pair.b}});
    }
    return OrderedJson{{"a", valid_utf8(c.a.name)},
                       {"b", valid_utf8(c.b.name)},
                       {"verdict", c.pass ? "pass" : "fail"},
                       {"sentence", c.sentence},
                       {"pairs", std::move(pairs)},
                       {"differences", differences_json(c.differences)},
                       {"settings", differences_json(c.settings)}}
               .dump(2) +
           "\n";
}

std::string run_comparison_page(const RunComparison& c) {
    const std::string parts = c.a.part == c.b.part ? c.a.part : c.a.part + " and " + c.b.part;
    std::string html = page_head("Comparison of " + parts + " – Seampath") +
                       "<header><div><div class=\"brand\">SEAMPATH " SEAMPATH_VERSION
                       " · COMPARISON OF TWO RUNS</div><h1>" +
                       escape_html(parts) + "</h1><div class=\"verdict " + (c.pass ? "pass" : "fail") +
                       "\" id=\"verdict\"><b>" + (c.pass ? "SAME" : "DIFFERENT") + "</b><span>" +
                       escape_html(c.sentence) + "</span></div></div></header>\n<main>\n" + runs_table(c) + overlay(c);
    html +=
        "<h2>Differences, worst first</h2><p class=\"soft\">Positions are compared in the frames of the scans. A "
        "distance is judged by 3.41 σ of both curves together and by the smaller tolerance, a dimension by 3 σ, a fact "
        "by being equal. What has no σ is told, not judged.</p>" +
        difference_table(c.differences);
    for (const SeamPair& pair : c.pairs) {
        html += "<h2>Seam " + std::to_string(pair.a) +
                (pair.a == pair.b ? "" : " of A, " + std::to_string(pair.b) + " of B") + "</h2><div class=\"plots\">" +
                distance_plot(pair, c.a.models[pair.a].length_mm) + deviation_overlay(c, pair) + "</div>\n";
    }
    html += settings_difference(c) +
            "<footer>Lengths in mm; across is to the right of travel, up is into the air.</footer></main>\n<script>" +
            std::string(sort_script()) + "</script>\n</body></html>\n";
    return html;
}

}  // namespace seampath
