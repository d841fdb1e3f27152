#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pipeline/report_text.hpp"
#include "pipeline/svg.hpp"
#include "pipeline/text.hpp"
#include "stages/angle.hpp"
#include "stages/text.hpp"
#include "tools/saddle_difference.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

// Rows of the printed table; the file has all places.
constexpr int kPrinted = 12;

// CSS pixels, and the room above and below the lines as a share of them.
constexpr double kCurveWidth = 760, kCurveHeight = 300, kCurveGap = 20, kRoom = 1.12;

constexpr std::string_view kStyle =
    "svg{background:#fff;font:12px sans-serif}"
    "line.grid{stroke:#e3e7eb}line.axis{stroke:#7d8794}.tick,.label{fill:#4a5560}.middle{text-anchor:middle}"
    ".end{text-anchor:end}path{fill:none;stroke-width:1.6}path.sigma{fill:#16324f;fill-opacity:.15;stroke:none}"
    ".value{stroke:#16324f}.flank1{stroke:#c2571a}.flank2{stroke:#2c8a8a}";

double unit(const DimensionDifference& d) {
    return d.is_angle ? kDegree : 1;
}
std::string key(const DimensionDifference& d) {
    return d.name + (d.is_angle ? "_deg" : "_mm");
}

/// Difference over sigma, or nothing without a sigma.
std::string sigmas(const DimensionDifference& d) {
    return d.fitted.sigma > 0 ? fixed(d.difference() / d.fitted.sigma, 1) : "-";
}

std::string plot(const SaddleDifference& d, double y) {
    std::vector<PlotPoint> distance, low, high, branch, header;
    double least = 0, most = 0;
    for (const PlaceDifference& p : d.places) {
        const double at = p.theta / kDegree;
        distance.push_back({at, p.distance_mm});
        low.push_back({at, p.distance_mm - p.sigma_mm});
        high.push_back({at, p.distance_mm + p.sigma_mm});
        branch.push_back({at, p.branch_wall_mm});
        header.push_back({at, p.header_wall_mm});
        least = std::min({least, low.back().y, p.branch_wall_mm, p.header_wall_mm});
        most = std::max({most, high.back().y, p.branch_wall_mm, p.header_wall_mm});
    }
    constexpr double kLeast_mm = 1e-6;
    const PlotAxes axes{kCurveWidth,
                        kCurveHeight,
                        0,
                        360,
                        kRoom * std::min(least, -kLeast_mm),
                        kRoom * std::max(most, kLeast_mm),
                        "seam " + std::to_string(d.seam) + ": branch angle, deg",
                        "fitted - nominal, mm"};
    std::string svg = svg_axes(axes, "Fitted less nominal saddle along the seam");
    svg.insert(4, " y=\"" + decimal(y, 0) + "\" width=\"" + decimal(kCurveWidth, 0) + "\" height=\"" +
                      decimal(kCurveHeight, 0) + "\"");  // after "<svg"
    return svg + svg_band(axes, low, high, "sigma") + svg_line(axes, branch, "flank1") +
           svg_line(axes, header, "flank2") + svg_line(axes, distance, "value") + svg_end();
}

}  // namespace

std::string saddle_difference_text(const SaddleDifference& d) {
    Rows dimensions{{"", "fitted", "1 sigma", "nominal", "difference", "in sigmas"}};
    for (const DimensionDifference& row : d.dimensions) {
        dimensions.push_back({key(row), fixed(row.fitted.value / unit(row), 4), fixed(row.fitted.sigma / unit(row), 4),
                              fixed(row.nominal / unit(row), 4), fixed(row.difference() / unit(row), 4), sigmas(row)});
    }
    dimensions.push_back({"length_mm", fixed(d.fitted_length_mm, 4), "", fixed(d.nominal_length_mm, 4),
                          fixed(d.fitted_length_mm - d.nominal_length_mm, 4), ""});
    Rows places{{"branch angle deg", "station mm", "off branch mm", "off header mm", "distance mm", "its form mm",
                 "1 sigma mm", "opening deg"}};
    for (std::size_t i = 0; i < d.places.size(); i += d.places.size() / kPrinted) {
        const PlaceDifference& p = d.places[i];
        places.push_back({fixed(p.theta / kDegree, 0), fixed(p.station_mm, 2), fixed(p.branch_wall_mm, 4),
                          fixed(p.header_wall_mm, 4), fixed(p.distance_mm, 4), fixed(p.form_mm, 4),
                          fixed(p.sigma_mm, 4), fixed(p.opening / kDegree, 3)});
    }
    return aligned(dimensions) + "\n" + aligned(places) + "largest distance " + fixed(d.worst.distance_mm, 4) +
           " mm at branch angle " + fixed(d.worst.theta / kDegree, 0) + " deg, rms " + fixed(d.rms_mm, 4) + " mm\n";
}

Json saddle_difference_json(const SaddleDifference& d) {
    Json dimensions = Json::array(), places = Json::array();
    for (const DimensionDifference& row : d.dimensions) {
        dimensions.push_back(
            {{"name", key(row)},
             {"fitted", row.fitted.value / unit(row)},
             {"sigma", row.fitted.sigma / unit(row)},
             {"nominal", row.nominal / unit(row)},
             {"difference", row.difference() / unit(row)},
             {"difference_in_sigmas", row.fitted.sigma > 0 ? Json(row.difference() / row.fitted.sigma) : Json()}});
    }
    for (const PlaceDifference& p : d.places) {
        places.push_back({{"theta_deg", p.theta / kDegree},
                          {"station_mm", p.station_mm},
                          {"difference_mm", {p.difference.x(), p.difference.y(), p.difference.z()}},
                          {"branch_wall_mm", p.branch_wall_mm},
                          {"header_wall_mm", p.header_wall_mm},
                          {"distance_mm", p.distance_mm},
                          {"form_mm", p.form_mm},
                          {"sigma_mm", p.sigma_mm},
                          {"opening_deg", p.opening / kDegree}});
    }
    return {{"seam", d.seam},
            {"header", kHeaderNames.at(static_cast<std::size_t>(d.fitted.header))},
            {"dimensions", dimensions},
            {"fitted_length_mm", d.fitted_length_mm},
            {"nominal_length_mm", d.nominal_length_mm},
            {"rms_mm", d.rms_mm},
            {"max_mm", d.worst.distance_mm},
            {"max_at_theta_deg", d.worst.theta / kDegree},
            {"places", places}};
}

std::string saddle_difference_csv(const std::vector<SaddleDifference>& differences) {
    std::string text =
        "# fitted - nominal at the same branch angle; frame: nominal (right-handed)\n"
        "seam,theta_deg,station_mm,x,y,z,dx_mm,dy_mm,dz_mm,branch_wall_mm,header_wall_mm,distance_mm,form_mm,sigma_mm,"
        "opening_deg\n";
    for (const SaddleDifference& d : differences) {
        for (const PlaceDifference& p : d.places) {
            text += std::to_string(d.seam);
            for (const double value : {p.theta / kDegree, p.station_mm, p.nominal.x(), p.nominal.y(), p.nominal.z(),
                                       p.difference.x(), p.difference.y(), p.difference.z(), p.branch_wall_mm,
                                       p.header_wall_mm, p.distance_mm, p.form_mm, p.sigma_mm, p.opening / kDegree}) {
                text += ',' + shortest(value);
            }
            text += '\n';
        }
    }
    return text;
}

std::string saddle_difference_svg(const std::vector<SaddleDifference>& differences) {
    std::string plots;
    double y = 0;
    for (const SaddleDifference& d : differences) {
        plots += plot(d, y);
        y += kCurveHeight + kCurveGap;
    }
    const std::string legend =
        "<text x=\"80\" y=\"" + decimal(y, 0) +
        "\"><tspan fill=\"#16324f\">distance square to travel, with 1 sigma</tspan> <tspan fill=\"#c2571a\">off the "
        "branch's wall</tspan> <tspan fill=\"#2c8a8a\">off the header's wall</tspan></text>";
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + decimal(kCurveWidth, 0) + ' ' +
           decimal(y + kCurveGap, 0) + "\"><style>" + std::string(kStyle) + "</style>" + plots + legend + svg_end();
}

}  // namespace seampath
