#include "pipeline/report_seams.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "pipeline/groove_columns.hpp"
#include "stages/angle.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

/// Stations at which the curvature of a seam is looked at.
constexpr int kCurvatureStations = 1000;

double max_curvature(const CubicBSpline& curve) {
    double most = 0;
    const double first = first_parameter(curve), last = last_parameter(curve);
    for (int i = 0; i <= kCurvatureStations; ++i) {
        most = std::max(most, curvature(curve, first + (last - first) * i / kCurvatureStations));
    }
    return most;
}

double median_sigma(const Seam& seam) {
    std::vector<double> sigma;
    std::transform(seam.points.begin(), seam.points.end(), std::back_inserter(sigma),
                   [](const SeamPoint& p) { return p.sigma_mm; });
    if (sigma.empty()) {
        return 0;
    }
    const auto middle = sigma.begin() + static_cast<std::ptrdiff_t>(sigma.size() / 2);
    std::nth_element(sigma.begin(), middle, sigma.end());
    return *middle;
}

double max_sigma(const Seam& seam) {
    double most = 0;
    for (const SeamPoint& p : seam.points) {
        most = std::max(most, p.sigma_mm);
    }
    return most;
}

ReportRow planned_row(const PartResult& part, std::size_t i) {
    const auto& seams = part.planned_seams;
    const bool planned = std::find(seams.begin(), seams.end(), static_cast<int>(i)) != seams.end();
    return {"planned", "Torch path planned", planned, "", "", 0};
}

ReportRow curvature_row(const SeamModel& model) {
    return number("max_curvature_per_mm", "Largest curvature", max_curvature(model.curve), "1/mm", 4);
}

void add_estimate(ReportRows& rows, const std::string& name, const std::string& label, const std::string& unit,
                  const std::optional<Measured>& estimate, double factor = 1) {
    if (estimate) {
        rows.push_back(number(name + "_" + unit, label, factor * estimate->value, unit == "deg" ? "°" : unit));
        rows.push_back(
            number(name + "_sigma_" + unit, label + ", 1σ", factor * estimate->sigma, unit == "deg" ? "°" : unit, 4));
    }
}

/// Which curve a seam is taken for and why; of a saddle its parameters.
ReportRows model_rows(const SeamModel& model) {
    ReportRows rows{fact("model", "Model", model.model), fact("model_reason", "Why that model", model.reason)};
    if (model.saddle) {
        rows.push_back(fact("header", "Header of the saddle", name(model.saddle->header)));
        add_estimate(rows, "branch_radius", "Radius of the branch", "mm", model.saddle->branch_radius_mm);
        add_estimate(rows, "header_radius", "Radius of the header", "mm", model.saddle->header_radius_mm);
        add_estimate(rows, "branch_angle", "Angle of branch and header", "deg", model.saddle->angle_rad,
                     kDegreesPerRadian);
        add_estimate(rows, "branch_offset", "Offset of the branch", "mm", model.saddle->offset_mm);
    }
    return rows;
}

/// How far the seam may be from its model, and where the model is less smooth than elsewhere.
ReportRows quality_rows(const SeamModel& model) {
    ReportRows rows;
    if (!model.band.empty()) {
        std::vector<double> half_width;
        for (const BandSample& sample : model.band) {
            half_width.push_back(sample.half_width_mm);
        }
        rows.push_back(number("band_95_median_mm", "95 % band of the curve, median half width",
                              quantile(half_width, 0.5), "mm", 4));
        rows.push_back(
            number("band_95_max_mm", "95 % band of the curve, largest half width", quantile(half_width, 1), "mm", 4));
    }
    std::array<std::size_t, 3> knots{};
    for (const CurveKnot& knot : knots_of(model.curve)) {
        ++knots[static_cast<std::size_t>(std::clamp(knot.continuity, 0, 2))];
    }
    rows.push_back(count("knots_c2", "Inner knots with continuous curvature", knots[2]));
    rows.push_back(count("knots_c1", "Inner knots with continuous tangent only", knots[1]));
    rows.push_back(count("knots_c0", "Corners and other knots with continuous position only", knots[0]));
    return rows;
}

/// Medians along the seam of what the scan shows of its groove; none for other joints.
ReportRows groove_rows(const Seam& seam) {
    ReportRows rows;
    for (const GrooveColumn& column : kGrooveColumns) {
        std::vector<double> value, sigma;
        for (const Measured& measured : groove_values(seam, column)) {
            if (std::isfinite(measured.value)) {
                value.push_back(measured.value);
                sigma.push_back(measured.sigma);
            }
        }
        if (!value.empty()) {
            const std::string base(column.name), unit(column.unit), label(column.label), in(column.shown_unit);
            rows.push_back(number(base + "_median_" + unit, label + ", median", quantile(value, 0.5), in));
            rows.push_back(number(base + "_sigma_" + unit, label + ", 1σ", quantile(sigma, 0.5), in));
        }
    }
    return rows;
}

ReportRows place_rows(const DeviationSample& sample) {
    return {
        number("station_mm", "Station", sample.station_mm, "mm", 1),
        number("deviation_mm", "Deviation", sample.distance_mm, "mm"),
        number("sigma_mm", "1σ", sample.sigma_mm, "mm"),
        number("flank1_mm", "From flank 1", sample.flank1_mm, "mm"),
        number("flank2_mm", "From flank 2", sample.flank2_mm, "mm"),
        number("x_mm", "x", sample.p.x(), "mm", 2),
        number("y_mm", "y", sample.p.y(), "mm", 2),
        number("z_mm", "z", sample.p.z(), "mm", 2),
    };
}

}  // namespace

double modelled_length(const Seam& seam) {
    double length = 0;
    const std::size_t n = seam.points.size();
    for (std::size_t i = 0; i + (seam.closed ? 0 : 1) < n; ++i) {
        const SeamPoint& a = seam.points[i];
        const SeamPoint& b = seam.points[(i + 1) % n];
        length += a.modelled || b.modelled ? (b.p - a.p).norm() : 0;
    }
    return length;
}

ReportSeam nominal_report(const PartResult& part, std::size_t i) {
    const SeamModel& model = part.models[i];
    return {true,
            "computed from nominal dimensions; there is no scan to hold it against",
            {
                fact("kind", "Joint", name(model.kind)),
                {"closed", "Closed", model.closed, "", "", 0},
                number("length_mm", "Length", model.length_mm, "mm"),
                count("control_points", "Control points of the curve", model.curve.control.size()),
                number("curve_error_rms_mm", "Curve from the exact seam, rms", model.residual_rms_mm, "mm", 9),
                number("curve_error_max_mm", "Curve from the exact seam, largest", model.residual_max_mm, "mm", 9),
                curvature_row(model),
                planned_row(part, i),
            },
            {},
            {}};
}

ReportSeam seam_report(const PartResult& part, std::size_t i) {
    const Seam& seam = part.extraction.seams[i];
    const SeamModel& model = part.models[i];
    const Deviation& deviation = part.deviations[i];
    ReportSeam report{
        deviation.pass,
        valid_utf8(deviation.verdict),
        {
            fact("kind", "Joint", name(model.kind)),
            {"closed", "Closed", model.closed, "", "", 0},
            fact("kind_reason", "What was seen", seam.kind_reason),
            number("confidence", "Confidence of detection", seam.confidence, "", 2),
            number("length_mm", "Length", model.length_mm, "mm"),
            number("modelled_length_mm", "Bridged by model", modelled_length(seam), "mm"),
            count("points", "Extracted points", seam.points.size()),
            number("sigma_median_mm", "Uncertainty of a point, median 1σ", median_sigma(seam), "mm"),
            number("sigma_max_mm", "Uncertainty of a point, largest 1σ", max_sigma(seam), "mm"),
            count("nodes", "Nodes", part.nodes[i].index.size()),
            number("node_chord_error_mm", "Largest chord error between nodes", part.nodes[i].max_chord_error_mm, "mm"),
            number("residual_rms_mm", "Points from fitted curve, rms", model.residual_rms_mm, "mm"),
            number("residual_max_mm", "Points from fitted curve, largest", model.residual_max_mm, "mm"),
            number("degrees_of_freedom", "Effective coefficients of the fit", model.degrees_of_freedom, "", 0),
            curvature_row(model),
            number("deviation_signed_mean_mm", "Deviation, signed mean", deviation.signed_mean_mm, "mm"),
            number("deviation_rms_mm", "Deviation, rms", deviation.rms_mm, "mm"),
            number("deviation_p50_mm", "Deviation, p50", deviation.p50_mm, "mm"),
            number("deviation_p95_mm", "Deviation, p95", deviation.p95_mm, "mm"),
            number("deviation_p997_mm", "Deviation, p99.7", deviation.p997_mm, "mm"),
            number("deviation_max_mm", "Deviation, largest", deviation.max_mm, "mm"),
            judged(number("coverage_percent", "Checked on scan", 100 * deviation.coverage, "%", 1),
                   deviation.coverage >= part.config.validate.min_coverage),
            number("tolerance_mm", "Tolerance", deviation.tolerance_mm, "mm"),
            judged(fact("in_tolerance", "In tolerance", deviation.pass ? "yes" : "no"), deviation.pass),
            planned_row(part, i),
        },
        characteristics(part, i),
        {}};
    if (part.nodes[i].line) {
        const double error = part.nodes[i].line->max_error_mm;
        const auto behind = std::find_if(report.rows.begin(), report.rows.end(),
                                         [](const ReportRow& row) { return row.name == "node_chord_error_mm"; });
        report.rows.insert(behind + 1, judged(number("node_spline_error_mm",
                                                     "Spline through the nodes from the smoothed "
                                                     "seam, largest",
                                                     error, "mm", 4),
                                              error <= part.config.place.spline_tolerance_mm));
    }
    for (const std::size_t k : worst_samples(deviation, model)) {
        report.places.push_back(place_rows(deviation.samples[k]));
    }
    if (!model.corners_mm.empty()) {
        const auto behind = std::find_if(report.rows.begin(), report.rows.end(),
                                         [](const ReportRow& row) { return row.name == "length_mm"; });
        report.rows.insert(behind + 1, count("corners", "Corners", model.corners_mm.size()));
    }
    const ReportRows model_facts = model_rows(model);
    const auto before = std::find_if(report.rows.begin(), report.rows.end(),
                                     [](const ReportRow& row) { return row.name == "residual_rms_mm"; });
    report.rows.insert(before, model_facts.begin(), model_facts.end());
    const ReportRows quality = quality_rows(model);
    const auto behind = std::find_if(report.rows.begin(), report.rows.end(),
                                     [](const ReportRow& row) { return row.name == "degrees_of_freedom"; });
    report.rows.insert(behind + 1, quality.begin(), quality.end());
    const ReportRows groove = groove_rows(seam);
    report.rows.insert(report.rows.end(), groove.begin(), groove.end());
    return report;
}

}  // namespace seampath
