#include "pipeline/parts_page.hpp"

#include <algorithm>
#include <tuple>

#include "pipeline/line_picture.hpp"
#include "pipeline/report_assets.hpp"
#include "pipeline/report_cells.hpp"
#include "pipeline/report_rows.hpp"
#include "pipeline/report_text.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr double kThumbnailWidth = 120, kThumbnailHeight = 72;
constexpr int kThumbnailPoints = 60;

std::string seam_picture(const PartResult& part) {
    std::vector<PictureLine> lines;
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        const ArcLength arc(part.models[i].curve);
        PictureLine line{{}, part.deviations[i].pass ? "good" : "bad"};
        for (int k = 0; k <= kThumbnailPoints; ++k) {
            line.points.push_back(position(arc.curve(), arc.parameter(arc.length() * k / kThumbnailPoints)));
        }
        lines.push_back(std::move(line));
    }
    return line_picture(lines, kThumbnailWidth, kThumbnailHeight, "Seams of " + part.scan.name);
}

/// Parts that could not be run come first, then those that failed, each by how much of the tolerance they use.
bool is_worse(const PartRow& a, const PartRow& b) {
    const auto key = [](const PartRow& row) { return std::tuple(row.has_report, row.pass, -row.tolerance_used); };
    return key(a) < key(b);
}

/// The value that sorting goes by is not the rounded one.
std::string sortable(double value, int decimals) {
    return "<td class=\"num\" data-value=\"" + shortest(value) + "\">" + decimal(value, decimals) + "</td>";
}

std::string table_row(const PartRow& row) {
    const std::string name = escape_html(row.name);
    std::string html =
        "<tr><td>" + row.picture + "</td><th scope=\"row\">" +
        (row.has_report ? "<a href=\"" + address(row.folder + "/report.html") + "\">" + name + "</a>" : name) +
        "</th><td><span class=\"badge " +
        (row.pass         ? "pass\">PASS"
         : row.has_report ? "fail\">FAIL"
                          : "fail\">NOT RUN") +
        "</span></td>";
    if (row.has_report) {
        html += sortable(static_cast<double>(row.seams), 0) + sortable(row.length_mm, 1) +
                sortable(row.deviation_max_mm, 3) + sortable(100 * row.tolerance_used, 0) +
                sortable(100 * row.coverage, 1) + sortable(row.duration_s, 1);
    } else {
        for (int k = 0; k < 6; ++k) {
            html += "<td class=\"num soft\">–</td>";
        }
    }
    return html + "<td class=\"soft\">" + escape_html(row.sentence) + "</td></tr>\n";
}

}  // namespace

PartRow part_row(const PartResult& part) {
    const Report report = report_of(part);
    PartRow row;
    row.has_report = true;
    row.pass = report.pass;
    row.sentence = report.sentence;
    row.seams = part.models.size();
    row.duration_s = part.plan.duration_s;
    double checked = 0;
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        const Deviation& deviation = part.deviations[i];
        row.length_mm += part.models[i].length_mm;
        checked += deviation.coverage * part.models[i].length_mm;
        row.deviation_max_mm = std::max(row.deviation_max_mm, deviation.max_mm);
        row.tolerance_used = std::max(row.tolerance_used, tolerance_used(deviation));
    }
    row.coverage = row.length_mm > 0 ? checked / row.length_mm : 0;
    row.picture = seam_picture(part);
    return row;
}

std::string parts_page(std::vector<PartRow> parts) {
    std::stable_sort(parts.begin(), parts.end(), is_worse);
    const auto passed = std::count_if(parts.begin(), parts.end(), [](const PartRow& row) { return row.pass; });
    const bool all = passed == static_cast<std::ptrdiff_t>(parts.size());
    const std::string sentence = std::to_string(passed) + " of " + std::to_string(parts.size()) + " parts pass";
    std::string html = page_head(sentence + " – Seampath") +
                       "<header><div><div class=\"brand\">SEAMPATH " SEAMPATH_VERSION " · SUMMARY OF PARTS</div><h1>" +
                       std::to_string(parts.size()) + " parts</h1><div class=\"verdict " + (all ? "pass" : "fail") +
                       "\" id=\"verdict\"><b>" + (all ? "PASS" : "FAIL") + "</b><span>" + sentence +
                       "</span></div></div></header>\n<main><div class=\"scroll\"><table class=\"sortable\"><caption>"
                       "Worst first; a heading sorts by its column</caption><thead><tr><th scope=\"col\">Seams</th>";
    for (const char* text : {"Part", "Result"}) {
        html += heading(text, false);
    }
    for (const char* text :
         {"Number", "Length, mm", "Deviation, largest, mm", "Tolerance used, %", "Checked, %", "Path, s"}) {
        html += heading(text, true);
    }
    html += heading("Verdict", false) + "</tr></thead><tbody>\n";
    for (const PartRow& row : parts) {
        html += table_row(row);
    }
    return html +
           "</tbody></table></div><footer>Tolerance used: of the worst seam, the deviation that 99.7 % of its stations "
           "keep, with its guard for the scan’s uncertainty, over the tolerance.</footer></main>\n<script>" +
           std::string(sort_script()) + "</script>\n</body></html>\n";
}

}  // namespace seampath
