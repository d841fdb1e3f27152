#include "pipeline/summary.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/text.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

std::string count(std::size_t n, const std::string& noun) {
    return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

std::string mm(double value, int digits = 3) {
    return fixed(value, digits) + " mm";
}

/// Largest of one number over all elements; 0 when there is none.
template <class List, class Number>
double largest(const List& list, Number number) {
    double most = 0;
    for (const auto& element : list) {
        most = std::max(most, number(element));
    }
    return most;
}

std::size_t seam_points(const PartResult& part) {
    std::size_t sum = 0;
    for (const auto& seam : part.extraction.seams) {
        sum += seam.points.size();
    }
    return sum;
}

std::size_t node_count(const PartResult& part) {
    std::size_t sum = 0;
    for (const auto& nodes : part.nodes) {
        sum += nodes.index.size();
    }
    return sum;
}

/// Root of the mean square of the 1-sigma along the seam.
double sigma(const SeamModel& model) {
    double sum = 0;
    for (const auto& flank : model.flanks) {
        sum += flank.sigma_mm * flank.sigma_mm;
    }
    return model.flanks.empty() ? 0 : std::sqrt(sum / static_cast<double>(model.flanks.size()));
}

}  // namespace

std::string read_summary(const PartResult& part) {
    const Scan& scan = part.scan;
    std::string text = scan.format + " -> " + count(scan.points.size(), "point");
    if (scan.dropped_not_finite > 0) {
        text += ", " + std::to_string(scan.dropped_not_finite) + " not finite dropped";
    }
    return text + "; " + shortest(scan.mm_per_unit) + " mm per unit (" + scan.unit_reason + ")";
}

std::string extract_summary(const PartResult& part) {
    const Extraction& found = part.extraction;
    return count(part.scan.points.size(), "point") + " -> " + count(found.seams.size(), "seam") + ", " +
           count(seam_points(part), "seam point") + "; noise " + mm(found.noise_mm) + ", spacing " +
           mm(found.spacing_mm);
}

std::string place_summary(const PartResult& part) {
    const bool of_spline = part.config.place.method != PlaceMethod::chord;
    return count(seam_points(part), "seam point") + " -> " + count(node_count(part), "node") +
           (of_spline ? "; spline error " : "; chord error ") + mm(largest(part.nodes, [](const Nodes& nodes) {
               return nodes.line ? nodes.line->max_error_mm : nodes.max_chord_error_mm;
           }));
}

std::string fit_summary(const PartResult& part) {
    return count(node_count(part), "node") + " -> " + count(part.models.size(), "curve") + "; residual rms " +
           mm(largest(part.models, [](const SeamModel& model) { return model.residual_rms_mm; }));
}

std::string validate_summary(const PartResult& part) {
    const auto passed =
        std::count_if(part.deviations.begin(), part.deviations.end(), [](const auto& d) { return d.pass; });
    return count(part.models.size(), "curve") + " against the scan -> " + std::to_string(passed) +
           " in tolerance; rms " +
           mm(largest(part.deviations, [](const Deviation& deviation) { return deviation.rms_mm; })) + ", max " +
           mm(largest(part.deviations, [](const Deviation& deviation) { return deviation.max_mm; }));
}

std::string plan_summary(const PartResult& part) {
    const Plan& plan = part.plan;
    return count(part.planned_seams.size(), "seam") + " -> " +
           (plan.passes.empty() ? "" : std::to_string(plan.passes.size()) + " passes, ") +
           count(plan.waypoints.size(), "waypoint") + ", " + fixed(plan.duration_s, 1) + " s of travel; chord error " +
           mm(plan.max_chord_error_mm) + (plan.refused.empty() ? "" : "; " + plan.refused.front().reason) +
           (plan.arm ? "; " + plan.arm->verdict : "");
}

std::string export_summary(const PartResult& part) {
    return count(part.plan.waypoints.size(), "waypoint") + " -> " + count(part.programs.size(), "program file") +
           "; read back within " +
           mm(largest(part.programs, [](const ProgramFile& file) { return file.max_position_error_mm; }), 6);
}

std::string report_summary(const PartResult& part) {
    return count(part.models.size(), "seam") + ", " + count(part.programs.size(), "program file") + " -> report; " +
           std::string(verdict(part));
}

std::string_view verdict(const PartResult& part) {
    const bool arm_fails = part.plan.arm && !part.plan.arm->pass;
    const bool refused = !part.plan.refused.empty();
    return part.pass()           ? "pass"
           : part.models.empty() ? "no seam found"
           : arm_fails           ? "the arm can't make it"
           : refused             ? "no room for the torch"
                                 : "out of tolerance";
}

std::string programs_summary(const PartResult& part, const std::string& folder) {
    if (!part.programs.empty()) {
        return folder;
    }
    return "none: " + std::string(part.planned_seams.empty() ? "no seam may be welded" : verdict(part));
}

std::string seam_table(const PartResult& part) {
    std::vector<std::vector<std::string>> rows{
        {"seam", "kind", "", "length mm", "rms mm", "max mm", "sigma mm", "coverage", "verdict"}};
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        const SeamModel& model = part.models[i];
        const Deviation& deviation = part.deviations.at(i);
        rows.push_back({std::to_string(i), std::string(name(model.kind)), model.closed ? "closed" : "open",
                        fixed(model.length_mm, 2), fixed(deviation.rms_mm, 4), fixed(deviation.max_mm, 4),
                        fixed(sigma(model), 4), fixed(100 * deviation.coverage, 1) + " %", deviation.verdict});
    }
    return aligned(rows);
}

}  // namespace seampath
