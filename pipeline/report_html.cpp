#include <algorithm>
#include <array>

#include "pipeline/report.hpp"
#include "pipeline/report_arm.hpp"
#include "pipeline/report_assets.hpp"
#include "pipeline/report_cells.hpp"
#include "pipeline/report_inspection.hpp"
#include "pipeline/report_plots.hpp"
#include "pipeline/report_rows.hpp"
#include "pipeline/report_sections.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/report_view.hpp"

namespace seampath {
namespace {

/// More seams than this fold up, save those that failed.
constexpr std::size_t kUnfolded = 4;

std::string header(const Report& report) {
    return "<header><div><div class=\"brand\">SEAMPATH " SEAMPATH_VERSION " · SEAM REPORT</div><h1>" +
           escape_html(report.part) + "</h1><div class=\"verdict " + (report.pass ? "pass" : "fail") +
           "\" id=\"verdict\" data-verdict=\"" + (report.pass ? "pass\"><b>PASS</b>" : "fail\"><b>FAIL</b>") +
           "<span>" + escape_html(report.sentence) + "</span></div></div></header>\n";
}

std::string key_figure(const ReportRows& rows, const std::string& path, std::string_view name) {
    const ReportRow& row = find_row(rows, name);
    return "<div><span>" + escape_html(row.label) + "</span><strong" + value_attributes(row, path) + '>' +
           escape_html(shown(row)) + "</strong> <small>" + row.unit + "</small></div>";
}

std::string key_figures(const Report& report) {
    std::string html = "<section class=\"key\">" + key_figure(report.rows, "rows", "seams");
    if (report.seams.empty()) {
        for (const std::string_view name :
             {"points", "size_x_mm", "size_y_mm", "size_z_mm", "spacing_mm", "noise_mm"}) {
            html += key_figure(report.scan, "scan", name);
        }
        return html + "</section>\n";
    }
    for (const std::string_view name : {"length_mm", "modelled_length_mm", "deviation_rms_mm", "deviation_max_mm",
                                        "coverage_percent", "curve_error_max_mm", "duration_s", "programs"}) {
        html += has_row(report.rows, name) ? key_figure(report.rows, "rows", name) : "";
    }
    return html + "</section>\n";
}

/// A column of the table of seams: the row that it shows and its heading.
struct Column {
    std::string_view row;
    const char* heading;
};
constexpr std::array<Column, 13> kSeamColumns{{{"length_mm", "Length<br>mm"},
                                               {"modelled_length_mm", "Bridged<br>mm"},
                                               {"points", "Points"},
                                               {"nodes", "Nodes"},
                                               {"sigma_median_mm", "Point 1σ<br>median mm"},
                                               {"deviation_rms_mm", "Deviation<br>rms mm"},
                                               {"deviation_p95_mm", "p95<br>mm"},
                                               {"deviation_p997_mm", "p99.7<br>mm"},
                                               {"deviation_max_mm", "Largest<br>mm"},
                                               {"tolerance_mm", "Tolerance<br>mm"},
                                               {"coverage_percent", "Checked<br>%"},
                                               {"control_points", "Control<br>points"},
                                               {"curve_error_max_mm", "Curve from exact<br>seam, mm"}}};

std::string seam_table(const Report& report) {
    if (report.seams.empty()) {
        return "";
    }
    std::string html =
        "<h2>Seams</h2><div class=\"scroll\"><table><thead><tr>" + heading("Seam", false) + heading("Joint", false);
    for (const Column& column : kSeamColumns) {
        html += has_row(report.seams.front().rows, column.row) ? heading(column.heading, true) : "";
    }
    html += heading("Verdict", false) + "</tr></thead><tbody>";
    for (std::size_t i = 0; i < report.seams.size(); ++i) {
        const ReportSeam& seam = report.seams[i];
        const std::string path = "seams." + std::to_string(i);
        const bool closed = std::get<bool>(find_row(seam.rows, "closed").value);
        const ReportRow& kind = find_row(seam.rows, "kind");
        html += "<tr data-seam=\"" + std::to_string(i) + "\"><td><button type=\"button\" class=\"link\">Seam " +
                std::to_string(i) + "</button></td><td" + value_attributes(kind, path) + '>' +
                escape_html(shown(kind)) + (closed ? ", closed" : ", open") + "</td>";
        for (const Column& column : kSeamColumns) {
            html += has_row(seam.rows, column.row) ? cell(seam.rows, path, column.row) : "";
        }
        html += "<td>" + badge(seam.pass) + "</td></tr>";
    }
    return html + "</tbody></table></div>\n";
}

/// Rows as label and value, two columns on wide screens.
std::string facts(const ReportRows& rows, const std::string& path, const std::vector<std::string_view>& left_out = {}) {
    std::string html = "<div class=\"facts\">";
    for (const ReportRow& row : rows) {
        if (std::find(left_out.begin(), left_out.end(), row.name) == left_out.end()) {
            html += "<div><span>" + escape_html(row.label) + "</span><span><span" + value_attributes(row, path) + '>' +
                    escape_html(shown(row)) + "</span> " + row.unit + "</span></div>";
        }
    }
    return html + "</div>\n";
}

std::string seam_section(const PartResult& part, const Report& report, std::size_t i) {
    const ReportSeam& seam = report.seams[i];
    const bool open = !seam.pass || report.seams.size() <= kUnfolded;
    return "<details id=\"seam-" + std::to_string(i) + "\"" + (open ? " open" : "") + "><summary><h3>Seam " +
           std::to_string(i) + "</h3>" + badge(seam.pass) + "<span class=\"soft\">" + escape_html(seam.sentence) +
           "</span></summary>" + inspection_tables(report, i) + seam_plots(part, i) +
           facts(seam.rows, "seams." + std::to_string(i)) + "</details>\n";
}

std::string program_table(const Report& report) {
    if (report.programs.empty()) {
        return "<h2>Robot programs</h2><p class=\"soft\">None was written.</p>\n";
    }
    std::string html =
        "<h2>Robot programs</h2><p class=\"soft\">Every file was read back by a reader of its own and compared with "
        "the planned path. A file is beside this page, under its name.</p><div class=\"scroll\"><table><thead><tr>" +
        heading("Robot", false) + heading("File", false);
    for (const char* text :
         {"Size<br>bytes", "Rounding<br>mm", "Position error<br>mm", "Orientation error<br>°", "Speed error<br>%"}) {
        html += heading(text, true);
    }
    html += heading("Read back", false) + "</tr></thead><tbody>";
    for (std::size_t i = 0; i < report.programs.size(); ++i) {
        const ReportProgram& program = report.programs[i];
        const std::string file = "programs/" + program.robot + '/' + program.file;
        html += "<tr><td>" + escape_html(program.robot) + "</td><td class=\"code\"><a href=\"" + address(file) + "\">" +
                escape_html(file) + "</a></td>";
        for (const ReportRow& row : program.rows) {
            html += cell(program.rows, "programs." + std::to_string(i), row.name);
        }
        html += "<td>" + badge(find_row(program.rows, "max_position_error_mm").verdict == "pass") + "</td></tr>";
    }
    return html + "</tbody></table></div>\n";
}

std::string scan_section(const Report& report) {
    std::string html = "<h2>Torch path</h2>" +
                       facts(report.rows, "rows",
                             {"seams", "seams_in_tolerance", "length_mm", "modelled_length_mm", "deviation_rms_mm",
                              "deviation_max_mm", "coverage_percent", "curve_error_max_mm"});
    if (!report.scan.empty()) {
        html += "<h2>Scan</h2>" + facts(report.scan, "scan");
    }
    if (!report.remarks.empty()) {
        html += "<h2>Remarks</h2><ul>";
        for (const std::string& remark : report.remarks) {
            html += "<li>" + escape_html(remark) + "</li>";
        }
        html += "</ul>\n";
    }
    return html;
}

std::string settings_table(const Report& report) {
    const auto changed =
        std::count_if(report.settings.begin(), report.settings.end(), [](const auto& s) { return s.changed; });
    std::string html = "<h2>Settings</h2><details><summary>" + std::to_string(report.settings.size()) + " options, " +
                       std::to_string(changed) +
                       " not at the default (bold)</summary><div class=\"scroll\"><table><thead><tr>"
                       "<th scope=\"col\">Option</th><th scope=\"col\">Value</th><th scope=\"col\">Default</th>"
                       "<th scope=\"col\">Meaning</th></tr></thead><tbody>";
    for (const ReportSetting& setting : report.settings) {
        html += std::string("<tr") + (setting.changed ? " class=\"changed\"" : "") + "><td class=\"code\">" +
                escape_html(setting.name) + "</td><td class=\"code\">" + escape_html(setting.value) +
                "</td><td class=\"code soft\">" + escape_html(setting.default_value) + "</td><td>" +
                escape_html(setting.meaning) + "</td></tr>";
    }
    return html + "</tbody></table></div></details>\n";
}

std::string stage_table(const Report& report) {
    std::string html =
        "<h2>Stages</h2><div class=\"scroll\"><table><thead><tr><th scope=\"col\">Stage</th><th "
        "scope=\"col\">Result</th></tr></thead><tbody>";
    for (const StageTiming& timing : report.timings) {
        html += "<tr><td>" + escape_html(timing.stage) + "</td><td>" + escape_html(timing.summary) + "</td></tr>";
    }
    return html + "</tbody></table></div>\n";
}

}  // namespace

std::string report_html(const PartResult& part, const std::vector<ReportImage>& images) {
    const Report report = report_of(part);
    const ViewScene scene = view_scene(part);
    std::string html = page_head(std::string(report.pass ? "PASS" : "FAIL") + " – " + report.part + " – Seampath") +
                       header(report) + "<main>\n" + identity_section(part, report) + key_figures(report) +
                       view_section(scene) + image_section(images) + seam_table(report);
    if (!report.seams.empty()) {
        html += "<h2>Seam by seam</h2>";
    }
    for (std::size_t i = 0; i < report.seams.size(); ++i) {
        html += seam_section(part, report, i);
    }
    html +=
        program_table(report) + arm_section(part) + scan_section(report) + settings_table(report) + stage_table(report);
    html += "<footer>Lengths in mm, positions in the frame of the " +
            std::string(part.nominal ? "nominal dimensions" : "scan") +
            ". Seams are numbered from 0 as in the files beside "
            "this page; "
            "the unrounded numbers are in report.json.</footer></main>\n";
    html += data_script("report", report_json(part)) + data_script("scene", view_json(scene)) +
            data_script("sections", sections_json(seam_sections(part)));
    html += "<script type=\"text/plain\" id=\"three\">" + base64(three_gzip()) + "</script>\n<script>" +
            std::string(page_script()) + "</script>\n<script>" + std::string(viewer_script()) +
            "</script>\n</body></html>\n";
    return html;
}

}  // namespace seampath
