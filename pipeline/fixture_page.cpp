#include "pipeline/fixture_page.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/report_assets.hpp"
#include "pipeline/report_cells.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/svg.hpp"
#include "stages/angle.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

constexpr double kChartWidth = 1190, kChartHeight = 230;

std::string table_of(const std::string& title, const std::string& head, const std::string& rows) {
    return "<h2>" + title + "</h2><div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>" + rows +
           "</tbody></table></div>\n";
}

std::string text_cell(const std::string& text) {
    return "<td>" + escape_html(text) + "</td>";
}

std::string value_cell(double value, int decimals) {
    return "<td class=\"num\" data-value=\"" + shortest(value) + "\">" + decimal(value, decimals) + "</td>";
}

std::string head_of(const FixtureCalibration& c) {
    const FrameResult& r = c.frame;
    std::string sentence = r.pass() ? "the frame is good for every work point" : r.faults.front();
    return "<header><div><div class=\"brand\">SEAMPATH " SEAMPATH_VERSION " · FIXTURE CALIBRATION</div><h1>" +
           escape_html(c.nominal.name) + "</h1><div class=\"verdict " + (r.pass() ? "pass" : "fail") +
           "\" id=\"verdict\" data-verdict=\"" + (r.pass() ? "pass\"><b>PASS</b>" : "fail\"><b>FAIL</b>") + "<span>" +
           escape_html(sentence) + "</span></div></div></header>\n";
}

std::string key_item(const std::string& label, const std::string& value, const std::string& unit) {
    return "<div><span>" + label + "</span><strong>" + escape_html(value) + "</strong> <small>" + unit +
           "</small></div>";
}

std::string key_of(const FixtureCalibration& c) {
    const FrameResult& r = c.frame;
    double expanded = 0, residual = 0;
    for (const WorkPointResult& w : r.work_points) {
        expanded = std::max(expanded, w.expanded_mm);
    }
    for (const FeatureResult& f : r.features) {
        residual = std::max(residual, f.residual_mm);
    }
    return "<section class=\"key\">" +
           key_item("Method", std::string(kFixtureMethodNames[static_cast<std::size_t>(c.nominal.method)]), "") +
           key_item("Features", std::to_string(r.features.size()), "") +
           key_item("Largest residual", decimal(residual, 4), "mm") +
           key_item("Expanded uncertainty, 95 %", decimal(expanded, 4), "mm") +
           key_item("Limit", shortest(c.nominal.frame.limit_mm), "mm") +
           key_item("Redundancy", std::to_string(r.redundancy), "") + key_item("Date, UTC", c.date.substr(0, 10), "") +
           key_item("Accepted", c.accepted ? c.accepted->reason : "no", "") + "</section>\n";
}

std::string remarks_of(const FrameResult& r) {
    std::string html;
    for (const std::string& fault : r.faults) {
        html += "<li><b>" + escape_html(fault) + "</b></li>";
    }
    for (const std::string& note : r.notes) {
        html += "<li>" + escape_html(note) + "</li>";
    }
    for (const Weakness& weak : r.weak) {
        html += "<li>Not held by the features: " + escape_html(weak.text) + "</li>";
    }
    return html.empty() ? "" : "<h2>Remarks</h2><ul>" + html + "</ul>\n";
}

std::string view_html(const FixtureCalibration& c, const FixtureScene& shown) {
    const auto times = [](double factor) { return shortest(factor) + " ×"; };
    return view_section(shown.scene) +
           "<p class=\"note-line\">Frame of the part. Arrows: where each feature was found, " +
           times(shown.arrows_times) + " as far from its nominal place" +
           (c.frame.moved.empty() ? "" : "; red: may have moved") +
           ". Ellipsoids: hold the work point with 95 %, drawn " + times(shown.ellipsoids_times) +
           " as large; red: beyond the limit.</p>\n";
}

// Bars of the residuals over their expected scatter.
std::string residual_plot(const FrameResult& r) {
    if (r.features.empty()) {
        return "";
    }
    double most = 3;
    for (const FeatureResult& f : r.features) {
        most = std::max(most, f.residual_sigma);
    }
    const double n = static_cast<double>(r.features.size());
    const PlotAxes axes{kChartWidth,  kChartHeight, 0.5, n + 0.5, 0, 1.1 * most, "feature, in the order of the table",
                        "residual, σ"};
    std::string svg = svg_axes(axes, "Residual of each feature over its expected scatter");
    for (std::size_t i = 0; i < r.features.size(); ++i) {
        const double x = static_cast<double>(i) + 1, y = r.features[i].residual_sigma;
        const bool moved = std::find(r.moved.begin(), r.moved.end(), r.features[i].name) != r.moved.end();
        svg += svg_box(axes, {x - 0.3, 0}, {x + 0.3, y}, moved ? "bar beyond" : "bar");
    }
    return "<figure><figcaption><b>Residuals</b> over the scatter that their sigmas let expect; about 1 or below when "
           "all is well</figcaption>" +
           svg + svg_level(axes, 3, "3 σ", "limit") + svg_end() + "</figure>\n";
}

std::string features_of(const FrameResult& r) {
    std::string rows;
    for (std::size_t i = 0; i < r.features.size(); ++i) {
        const FeatureResult& f = r.features[i];
        const std::string at = "/features/" + std::to_string(i) + "/";
        const bool moved = std::find(r.moved.begin(), r.moved.end(), f.name) != r.moved.end();
        rows += "<tr>" + text_cell(f.name + (f.check ? " (check)" : "")) + value_cell(f.place.x(), 1) +
                value_cell(f.place.y(), 1) + value_cell(f.place.z(), 1) +
                cell_at(at + "residual_mm", f.residual_mm, 4) + cell_at(at + "residual_sigma", f.residual_sigma, 2);
        for (int k = 0; k < 3; ++k) {
            rows += cell_at(at + "shift_mm/" + std::to_string(k), f.shift_mm[k], 4);
        }
        rows += f.can_be_left_out ? cell_at(at + "leave_one_out_mm", f.leave_one_out_mm, 4) +
                                        cell_at(at + "p_value_without", f.without_p_value, 4)
                                  : "<td class=\"num soft\">–</td><td class=\"num soft\">–</td>";
        rows += "<td>" + std::string(moved ? "<span class=\"badge fail\">MOVED?</span>" : "") + "</td></tr>\n";
    }
    std::string head = heading("Feature", false);
    for (const char* text : {"x<br>mm", "y<br>mm", "z<br>mm", "Residual<br>mm", "in σ", "Found off by<br>x, mm",
                             "y<br>mm", "z<br>mm", "Frame without it<br>moves by, mm", "p of the<br>others"}) {
        head += heading(text, true);
    }
    return table_of("Features", head + heading("", false), rows);
}

std::string work_points_html(const FixtureCalibration& c) {
    std::string rows;
    for (std::size_t i = 0; i < c.frame.work_points.size(); ++i) {
        const WorkPointResult& w = c.frame.work_points[i];
        const std::string at = "/work_points/" + std::to_string(i) + "/";
        rows += "<tr>" + text_cell(w.name);
        for (int k = 0; k < 3; ++k) {
            rows += cell_at(at + "base_mm/" + std::to_string(k), w.in_base[k], 3);
        }
        for (Eigen::Index k = 0; k < 3; ++k) {
            rows += value_cell(std::sqrt(std::max(0.0, w.covariance(k, k))), 4);
        }
        rows +=
            cell_at(at + "expanded_uncertainty_mm", w.expanded_mm, 4) +
            (c.change ? cell_at("/change/work_points/" + std::to_string(i) + "/moved_mm", c.change->work_point_mm[i], 4)
                      : "<td class=\"num soft\">–</td>") +
            "<td>" + badge(w.expanded_mm <= c.nominal.frame.limit_mm) + "</td></tr>\n";
    }
    std::string head = heading("Work point", false);
    for (const char* text : {"x in base<br>mm", "y<br>mm", "z<br>mm", "1σ of x<br>mm", "1σ of y<br>mm", "1σ of z<br>mm",
                             "95 % within<br>mm", "Since the accepted<br>one, mm"}) {
        head += heading(text, true);
    }
    return table_of("Uncertainty where it matters", head + heading("Limit", false), rows);
}

std::string frame_html(const FixtureCalibration& c) {
    const FrameResult& r = c.frame;
    const Vector3d p = r.base_from_part.translation();
    const Eigen::AngleAxisd turn(r.base_from_part.linear());
    const Vector3d w = turn.angle() / kDegree * turn.axis();
    constexpr std::array<const char*, 6> kNames{"x, mm",           "y, mm",           "z, mm",
                                                "turn about x, °", "turn about y, °", "turn about z, °"};
    std::string rows;
    for (Eigen::Index k = 0; k < 6; ++k) {
        const double unit = k < 3 ? 1 : kDegree;
        rows += "<tr>" + text_cell(kNames[static_cast<std::size_t>(k)]) +
                value_cell(k < 3 ? p[k] : w[k - 3], k < 3 ? 4 : 5) +
                value_cell(std::sqrt(std::max(0.0, r.covariance(k, k))) / unit, 5) +
                (c.change ? value_cell(c.change->step[k] / unit, 5) : "<td class=\"num soft\">–</td>") + "</tr>\n";
    }
    return table_of("Frame of the part in base",
                    heading("", false) + heading("Value", true) + heading("1σ", true) +
                        heading(c.change ? "Since " + escape_html(c.change->since) : "Since the accepted one", true),
                    rows) +
           "<p class=\"note-line\">The turn is a rotation vector. 1σ are of a shift of the part's origin and of a turn "
           "about it, along the axes of base; the whole covariance is in result.json.</p>\n";
}

std::string inputs_of(const FixtureCalibration& c) {
    std::string rows, files;
    for (std::size_t i = 0; i < c.numbers.size(); ++i) {
        rows += "<tr>" + text_cell(c.numbers[i].name) +
                cell_at("/numbers/" + std::to_string(i) + "/value", c.numbers[i].value, 4) +
                text_cell(c.numbers[i].unit) + "</tr>\n";
    }
    for (const InputFile& input : c.inputs) {
        files += "<tr>" + text_cell(input.file) + "<td class=\"code\">" + input.sha256 + "</td></tr>\n";
    }
    return (rows.empty() ? ""
                         : table_of("What was measured",
                                    heading("", false) + heading("Value", true) + heading("", false), rows)) +
           table_of("Inputs", heading("File", false) + heading("SHA-256", false), files);
}

double shift_since(const HistoryRow& row, const HistoryRow& since) {
    double largest = 0;
    for (const WorkPoint& w : row.work_points) {
        largest = std::max(largest, (row.base_from_part * w.p - since.base_from_part * w.p).norm());
    }
    return largest;
}

}  // namespace

std::string history_chart(const std::vector<HistoryRow>& history, double limit_mm) {
    if (history.size() < 2) {
        return "";
    }
    std::vector<PlotPoint> line, good, bad, expanded;
    const HistoryRow* since = &history.front();
    double most = limit_mm;
    for (std::size_t i = 0; i < history.size(); ++i) {
        const HistoryRow& row = history[i];
        const PlotPoint at{static_cast<double>(i) + 1, shift_since(row, *since)};
        line.push_back(at);
        expanded.push_back({at.x, row.expanded_mm});
        (row.pass ? good : bad).push_back(at);
        most = std::max({most, at.y, row.expanded_mm});
        since = row.accepted ? &row : since;
    }
    const PlotAxes axes{kChartWidth,
                        kChartHeight,
                        0.5,
                        static_cast<double>(history.size()) + 0.5,
                        0,
                        1.1 * most,
                        "calibration, oldest first",
                        "mm"};
    return "<h2>History</h2><figure><figcaption><b>" + std::to_string(history.size()) +
           " calibrations</b> <i class=\"value\"></i>shift of the work point that moved most, since the one accepted "
           "before it or the first <i class=\"flank1\"></i>expanded uncertainty; a red dot did not pass</figcaption>" +
           svg_axes(axes, "Shift of the work points over the calibrations") + svg_line(axes, expanded, "flank1") +
           svg_line(axes, line, "value") + svg_dots(axes, good, 4, "node") + svg_dots(axes, bad, 4, "node failed") +
           svg_level(axes, limit_mm, "limit " + shortest(limit_mm) + " mm", "limit") + svg_end() + "</figure>\n";
}

std::string fixture_page(const FixtureCalibration& c, const std::vector<HistoryRow>& history) {
    const FixtureScene shown = fixture_scene(c);
    return page_head(std::string(c.frame.pass() ? "PASS" : "FAIL") + " – " + c.nominal.name + " – Seampath") +
           head_of(c) + "<main>\n" + key_of(c) + view_html(c, shown) + remarks_of(c.frame) + features_of(c.frame) +
           residual_plot(c.frame) + work_points_html(c) + frame_html(c) +
           history_chart(history, c.nominal.change_limit_mm) + inputs_of(c) +
           "<footer>Lengths in mm. Frame of the part in base, covariance and all numbers unrounded are in the JSON "
           "beside this page.</footer></main>\n" +
           data_script("report", fixture_result_json(c)) + data_script("scene", view_json(shown.scene)) +
           "<script type=\"text/plain\" id=\"three\">" + base64(three_gzip()) + "</script>\n<script>" +
           std::string(viewer_script()) + "</script>\n</body></html>\n";
}

}  // namespace seampath
