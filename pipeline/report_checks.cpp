#include "pipeline/report_checks.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stages/angle.hpp"

namespace seampath {
namespace {

constexpr std::size_t kMostPlaces = 3;
constexpr double kApart = 0.1;  // of the seam's length

/// A dimension of the model beside what the options say of it: value and 1-sigma, a sigma of 0 meaning nothing.
void add_dimension(std::vector<Characteristic>& list, const std::string& name, const std::string& label,
                   const std::string& unit, const std::optional<Measured>& measured, const std::vector<double>& known,
                   double per_unit) {
    if (measured && known.at(1) > 0) {
        list.push_back({.name = name + (unit == "°" ? "_deg" : "_mm"),
                        .label = label,
                        .unit = unit,
                        .actual = per_unit * measured->value,
                        .nominal = known.at(0),
                        .uncertainty = per_unit * measured->sigma,
                        .tolerance = {},
                        .out_of_tolerance = {}});
    }
}

/// Along the seam, the short way round where it is closed.
double apart(const SeamModel& model, double a, double b) {
    const double along = std::abs(a - b);
    return model.closed ? std::min(along, model.length_mm - along) : along;
}

}  // namespace

std::optional<double> Characteristic::deviation() const {
    return nominal ? std::optional(actual - *nominal) : std::nullopt;
}

std::string Characteristic::verdict() const {
    return !out_of_tolerance ? "" : *out_of_tolerance > 0 ? "fail" : "pass";
}

std::vector<Characteristic> characteristics(const PartResult& part, std::size_t i) {
    const Deviation& deviation = part.deviations[i];
    const double least_coverage = part.config.validate.min_coverage;
    const double guard = guard_mm(deviation), beyond = deviation.p997_mm + guard - deviation.tolerance_mm;
    std::vector<Characteristic> list{{.name = "deviation_p997_mm",
                                      .label = "Curve from the scanned seam, p99.7",
                                      .unit = "mm",
                                      .actual = deviation.p997_mm,
                                      .nominal = 0,
                                      .uncertainty = guard,
                                      .tolerance = deviation.tolerance_mm,
                                      .out_of_tolerance = std::max(0.0, beyond)},
                                     {.name = "coverage_percent",
                                      .label = "Checked on scan",
                                      .unit = "%",
                                      .actual = 100 * deviation.coverage,
                                      .nominal = 100,
                                      .uncertainty = {},
                                      .tolerance = 100 * (1 - least_coverage),
                                      .out_of_tolerance = std::max(0.0, 100 * (least_coverage - deviation.coverage)),
                                      .decimals = 1}};
    if (const auto& saddle = part.models[i].saddle) {
        const FitOptions& known = part.config.fit;
        add_dimension(list, "branch_radius", "Radius of the branch", "mm", saddle->branch_radius_mm,
                      known.branch_radius_mm, 1);
        add_dimension(list, "header_radius", "Radius of the header", "mm", saddle->header_radius_mm,
                      known.header_radius_mm, 1);
        add_dimension(list, "branch_angle", "Angle of branch and header", "°", saddle->angle_rad, known.angle_deg,
                      kDegreesPerRadian);
        add_dimension(list, "branch_offset", "Offset of the branch", "mm", saddle->offset_mm, known.offset_mm, 1);
    }
    return list;
}

double tolerance_used(const Deviation& deviation) {
    return (deviation.p997_mm + guard_mm(deviation)) / deviation.tolerance_mm;
}

std::vector<std::size_t> worst_samples(const Deviation& deviation, const SeamModel& model) {
    const auto& samples = deviation.samples;
    std::vector<std::size_t> order(samples.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::erase_if(order, [&](std::size_t k) { return !samples[k].covered; });
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return samples[a].distance_mm > samples[b].distance_mm; });
    std::vector<std::size_t> worst;
    for (const std::size_t k : order) {
        const auto near = [&](std::size_t other) {
            return apart(model, samples[k].station_mm, samples[other].station_mm) < kApart * model.length_mm;
        };
        if (worst.size() < kMostPlaces && std::none_of(worst.begin(), worst.end(), near)) {
            worst.push_back(k);
        }
    }
    return worst;
}

}  // namespace seampath
