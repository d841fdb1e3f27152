#include "pipeline/report_inspection.hpp"

#include "pipeline/report_cells.hpp"
#include "pipeline/report_text.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr std::size_t kHashDigits = 12;  // of a SHA-256, enough to tell by eye

std::string identity_item(const std::string& label, const std::string& value) {
    return "<div><dt>" + label + "</dt><dd>" + value + "</dd></div>";
}

/// A row of the report; of a hash the first digits, the whole of it in its tip and in report.json.
std::string identity_item(const Report& report, const std::string& label, std::string_view name) {
    const ReportRow& row = find_row(report.identity, name);
    const std::string whole = escape_html(shown(row));
    const bool hash = row.name.ends_with("_sha256");
    return identity_item(label, "<span" + value_attributes(row, "identity") +
                                    (hash ? " class=\"code\" title=\"" + whole + '"' : "") + '>' +
                                    (hash ? whole.substr(0, kHashDigits) : whole) + "</span>");
}

std::string optional_cell(const std::string& pointer, const std::optional<double>& value, int decimals) {
    return value ? cell_at(pointer, *value, decimals) : "<td class=\"num soft\">–</td>";
}

std::string characteristic_row(const Characteristic& c, const std::string& pointer) {
    const std::string verdict = c.verdict();
    return "<tr><th scope=\"row\">" + escape_html(c.label) + "</th><td>" + c.unit + "</td>" +
           optional_cell(pointer + "/nominal", c.nominal, c.decimals) +
           cell_at(pointer + "/actual", c.actual, c.decimals) +
           optional_cell(pointer + "/uncertainty", c.uncertainty, c.decimals) +
           optional_cell(pointer + "/deviation", c.deviation(), c.decimals) +
           optional_cell(pointer + "/tolerance", c.tolerance, c.decimals) +
           optional_cell(pointer + "/out_of_tolerance", c.out_of_tolerance, c.decimals) + "<td>" +
           (verdict.empty() ? "<span class=\"soft\">no tolerance</span>" : badge(verdict == "pass")) + "</td></tr>";
}

std::string characteristic_table(const ReportSeam& seam, const std::string& pointer) {
    std::string html =
        "<div class=\"scroll\"><table class=\"inspection\"><caption>Tolerances: an actual and its uncertainty must lie "
        "within the tolerance</caption><thead><tr>" +
        heading("Characteristic", false) + heading("Unit", false);
    for (const char* text : {"Nominal", "Actual", "± Uncertainty", "Deviation", "± Tolerance", "Out of tolerance"}) {
        html += heading(text, true);
    }
    html += heading("Verdict", false) + "</tr></thead><tbody>";
    for (std::size_t k = 0; k < seam.characteristics.size(); ++k) {
        html += characteristic_row(seam.characteristics[k], pointer + "/characteristics/" + std::to_string(k));
    }
    return html + "</tbody></table></div>\n";
}

/// Each place is a button that shows the section there.
std::string place_table(const ReportSeam& seam, std::size_t i, const std::string& pointer) {
    if (seam.places.empty()) {
        return "";
    }
    std::string html =
        "<div class=\"scroll\"><table class=\"inspection\"><caption>Worst places, marked in the plot; positions in the "
        "frame of the scan</caption><thead><tr>" +
        heading("Place", false);
    for (const ReportRow& row : seam.places.front()) {
        html += heading(row.label + ", " + row.unit, true);
    }
    html += "</tr></thead><tbody>";
    for (std::size_t k = 0; k < seam.places.size(); ++k) {
        const double station = std::get<double>(find_row(seam.places[k], "station_mm").value);
        html += "<tr><th scope=\"row\"><button type=\"button\" class=\"place\" data-of=\"" + std::to_string(i) +
                "\" data-station=\"" + shortest(station) + "\" aria-label=\"Show the section at place " +
                std::to_string(k + 1) + ", station " + fixed(station, 1) + " mm\">" + std::to_string(k + 1) +
                "</button></th>";
        for (const ReportRow& row : seam.places[k]) {
            html += cell_at(pointer + "/worst_places/" + std::to_string(k) + '/' + row.name,
                            std::get<double>(row.value), row.decimals);
        }
        html += "</tr>";
    }
    return html + "</tbody></table></div>\n";
}

}  // namespace

std::string identity_section(const PartResult& part, const Report& report) {
    std::string html = "<dl class=\"identity\">" + identity_item("Part", escape_html(report.part));
    if (has_row(report.identity, "scan_file")) {
        html += identity_item(report, "Scan", "scan_file") +
                identity_item("Scan written", escape_html(part.origin.written)) +
                identity_item(report, "Scan, SHA-256", "scan_sha256");
    }
    html += identity_item("Unit", part.nominal ? "mm" : "mm; the scan’s numbers × " + shortest(part.scan.mm_per_unit)) +
            identity_item(report, "Settings, SHA-256", "config_sha256") + identity_item(report, "Program", "program") +
            identity_item(report, "Build, SHA-256", "build_sha256");
    return html + "</dl>\n";
}

std::string inspection_tables(const Report& report, std::size_t i) {
    const ReportSeam& seam = report.seams[i];
    const std::string pointer = "/seams/" + std::to_string(i);
    return seam.characteristics.empty() ? "" : characteristic_table(seam, pointer) + place_table(seam, i, pointer);
}

std::string section_panel(std::size_t seam) {
    const std::string of = std::to_string(seam);
    return "<figure class=\"section script-only\" data-of=\"" + of +
           "\"><figcaption><b>Section</b> of the scan, seen along travel <i class=\"flank1\"></i>fitted flank 1 <i "
           "class=\"flank2\"></i>fitted flank 2</figcaption><svg class=\"plot\" role=\"img\" aria-label=\"Section of "
           "seam " +
           of +
           "\"></svg><label class=\"slider\">Station <input type=\"range\" min=\"0\" value=\"0\" step=\"1\" "
           "aria-label=\"Station of the section of seam " +
           of + "\"></label><output class=\"note-line\" aria-live=\"polite\"></output></figure>\n";
}

}  // namespace seampath
