#include "pipeline/report_torch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/report_seams.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/svg.hpp"
#include "stages/angle.hpp"

namespace seampath {
namespace {

constexpr double kTorchWidth = 390, kTorchHeight = 220;

/// A quantity of the travel and the least range of its plot, in its unit.
using Quantity = double (*)(const TravelSample&);

double along(const TravelSample& s) {
    return s.acceleration_mm_s2;
}
double across(const TravelSample& s) {
    return s.centripetal_mm_s2;
}
double work(const TravelSample& s) {
    return s.work_rad * kDegreesPerRadian;
}
double push(const TravelSample& s) {
    return s.travel_rad * kDegreesPerRadian;
}
double turning(const TravelSample& s) {
    return s.turn_rate * kDegreesPerRadian;
}

double most(const std::vector<TravelSample>& travel, Quantity quantity) {
    double largest = 0;
    for (const TravelSample& s : travel) {
        largest = std::max(largest, std::abs(quantity(s)));
    }
    return largest;
}

/// One line, broken between welds.
std::vector<PlotPoint> line_of(const std::vector<TravelSample>& travel, Quantity quantity) {
    std::vector<PlotPoint> line;
    for (std::size_t k = 0; k < travel.size(); ++k) {
        if (k > 0 && travel[k].weld != travel[k - 1].weld) {
            line.push_back({travel[k].station_mm, std::numeric_limits<double>::quiet_NaN()});
        }
        line.push_back({travel[k].station_mm, quantity(travel[k])});
    }
    return line;
}

/// Two quantities of one unit over the station.
struct Pair {
    const char* title;
    const char* label;
    Quantity first, second;
    const char* caption;
    double least;
};

std::string pair_plot(const std::vector<TravelSample>& travel, const Pair& pair) {
    double length = 1e-3;
    for (const TravelSample& s : travel) {
        length = std::max(length, s.station_mm);
    }
    const double reach = 1.12 * std::max({pair.least, most(travel, pair.first), most(travel, pair.second)});
    const PlotAxes axes{kTorchWidth, kTorchHeight, 0, length, -reach, reach, "station, mm", pair.label};
    return "<figure class=\"by-station\"><figcaption>" + std::string(pair.caption) + "</figcaption>" +
           svg_axes(axes, pair.title) + svg_line(axes, line_of(travel, pair.second), "flank1") +
           svg_line(axes, line_of(travel, pair.first), "value") + svg_end() + "</figure>\n";
}

constexpr Pair kAccelerations{"Acceleration along the seam",
                              "acceleration, mm/s²",
                              along,
                              across,
                              "<b>Acceleration</b> <i class=\"value\"></i>along the seam "
                              "<i class=\"flank1\"></i>across it, speed² · curvature",
                              1};
constexpr Pair kAngles{"Torch angles along the seam",
                       "angle, °",
                       work,
                       push,
                       "<b>Torch angles</b> from the bisector <i class=\"value\"></i>work, towards flank 1 "
                       "<i class=\"flank1\"></i>travel, pointing ahead",
                       1};

std::vector<TravelSample> travel_of(const PartResult& part, std::size_t seam) {
    const auto planned = std::find(part.planned_seams.begin(), part.planned_seams.end(), static_cast<int>(seam));
    const auto number = static_cast<int>(planned - part.planned_seams.begin());
    std::vector<TravelSample> travel;
    std::copy_if(part.plan.travel.begin(), part.plan.travel.end(), std::back_inserter(travel),
                 [number](const TravelSample& s) { return s.seam == number; });
    return travel;
}

}  // namespace

ReportRows torch_rows(const Plan& plan) {
    ReportRows rows;
    for (const SeamRefusal& refusal : plan.refused) {
        rows.push_back(judged(fact("torch_refused", "No room for the torch", valid_utf8(refusal.reason)), false));
    }
    if (plan.travel.empty()) {
        return rows;
    }
    rows.push_back(
        number("acceleration_mm_s2", "Acceleration along the seam, largest", most(plan.travel, along), "mm/s²", 1));
    rows.push_back(
        number("centripetal_mm_s2", "Acceleration across it, largest", most(plan.travel, across), "mm/s²", 1));
    rows.push_back(
        number("turn_rate_deg_s", "Rate at which the torch turns, largest", most(plan.travel, turning), "°/s", 1));
    rows.push_back(number("work_angle_deg", "Work angle from the bisector, largest", most(plan.travel, work), "°", 1));
    rows.push_back(number("travel_angle_deg", "Travel angle, largest", most(plan.travel, push), "°", 1));
    return rows;
}

std::vector<PlotPoint> planned_speed(const PartResult& part, std::size_t seam) {
    return line_of(travel_of(part, seam), [](const TravelSample& s) { return s.speed_mm_s; });
}

std::string torch_plots(const PartResult& part, std::size_t seam) {
    const std::vector<TravelSample> travel = travel_of(part, seam);
    return travel.empty() ? "" : pair_plot(travel, kAccelerations) + pair_plot(travel, kAngles);
}

}  // namespace seampath
