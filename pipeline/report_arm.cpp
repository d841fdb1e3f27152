#include "pipeline/report_arm.hpp"

#include <algorithm>
#include <vector>

#include "pipeline/report_seams.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/svg.hpp"
#include "stages/angle.hpp"

namespace seampath {
namespace {

constexpr double kNarrow = 390, kArmHeight = 220;

double largest(const std::array<double, 6>& shares) {
    return *std::max_element(shares.begin(), shares.end());
}

std::string figure(const std::string& caption, const std::string& svg) {
    return "<figure><figcaption>" + caption + "</figcaption>" + svg + "</figure>\n";
}

std::string axis_plot(const ArmTravel& arm, std::size_t axis) {
    std::vector<PlotPoint> line;
    for (const ArmSample& s : arm.samples) {
        line.push_back({s.time_s, s.q[axis] * kDegreesPerRadian});
    }
    const double low = arm.lowest[axis] * kDegreesPerRadian, high = arm.highest[axis] * kDegreesPerRadian,
                 room = 0.06 * (high - low);
    const PlotAxes axes{kNarrow,    kArmHeight,  0,         std::max(arm.duration_s, 1e-3),
                        low - room, high + room, "time, s", "angle, °"};
    const std::string title = "Axis " + std::to_string(axis + 1);
    return figure("<b>" + title + "</b> with its limits; largest speed " + decimal(100 * arm.speed_share[axis], 1) +
                      " % of the limit",
                  svg_axes(axes, title + " over time") + svg_level(axes, low, "", "limit") +
                      svg_level(axes, high, decimal(high, 0) + "°", "limit") + svg_line(axes, line, "value") +
                      svg_end());
}

std::string manipulability_plot(const ArmTravel& arm) {
    std::vector<PlotPoint> line;
    double most = 0;
    for (const ArmSample& s : arm.samples) {
        line.push_back({s.time_s, s.manipulability});
        most = std::max(most, s.manipulability);
    }
    const PlotAxes axes{kNarrow,   kArmHeight,   0, std::max(arm.duration_s, 1e-3), 0, 1.12 * std::max(most, 1e-6),
                        "time, s", "|det J|, m³"};
    return figure("<b>Manipulability</b>, 0 in singular poses",
                  svg_axes(axes, "Manipulability over time") + svg_line(axes, line, "value") + svg_end());
}

}  // namespace

ReportRows arm_rows(const ArmTravel& arm) {
    ReportRows rows{fact("arm", "Robot arm", arm.arm), judged(fact("arm_verdict", "Arm", arm.verdict), arm.pass)};
    if (!arm.samples.empty()) {
        rows.push_back(number("arm_limit_margin_deg", "Axes within their limits by at least",
                              arm.least_margin * kDegreesPerRadian, "°", 1));
        rows.push_back(
            number("arm_speed_percent", "Largest share of an axis's speed", 100 * largest(arm.speed_share), "%", 1));
        rows.push_back(judged(number("arm_acceleration_percent", "Largest share of an axis's acceleration, welding",
                                     100 * largest(arm.acceleration_share), "%", 1),
                              largest(arm.acceleration_share) <= 1));
        rows.push_back(number("arm_manipulability_m3", "Least manipulability", arm.least_manipulability, "m³", 4));
        rows.push_back(
            number("arm_roll_deg", "Torch turned about its wire by at most", arm.max_roll * kDegreesPerRadian, "°", 1));
        rows.push_back(number("arm_duration_s", "Travel of the arm", arm.duration_s, "s", 1));
    }
    if (arm.shift_mm) {
        rows.push_back(number("arm_shift_mm", "Part to be moved by", arm.shift_mm->norm(), "mm", 0));
    }
    return rows;
}

std::string arm_section(const PartResult& part) {
    if (!part.plan.arm) {
        return "";
    }
    const ArmTravel& arm = *part.plan.arm;
    std::string html = "<h2>Robot arm</h2><p>" + escape_html(arm.verdict) + ".</p>\n";
    if (arm.samples.empty()) {
        return html;
    }
    html += "<div class=\"plots\">\n";
    for (std::size_t axis = 0; axis < arm.lowest.size(); ++axis) {
        html += axis_plot(arm, axis);
    }
    return html + manipulability_plot(arm) + "</div>\n";
}

}  // namespace seampath
