#include "pipeline/report_rows.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <nlohmann/json.hpp>

#include "pipeline/digest.hpp"
#include "pipeline/fields.hpp"
#include "pipeline/report_arm.hpp"
#include "pipeline/report_seams.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/report_torch.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

/// What a program file may differ from the plan beyond its own rounding: the mathematics of turning poses there and
/// back.
constexpr double kReadBackMarginMm = 1e-6;

ReportProgram program_report(const ProgramFile& file) {
    // Half a unit of the last place on each of three axes.
    const double allowed = std::sqrt(3.0) * file.position_rounding_mm + kReadBackMarginMm;
    return {valid_utf8(file.robot),
            valid_utf8(file.file_name),
            {
                count("bytes", "Size, bytes", file.content.size()),
                number("position_rounding_mm", "Rounding of a coordinate", file.position_rounding_mm, "mm", 6),
                judged(number("max_position_error_mm", "Position, read back", file.max_position_error_mm, "mm", 6),
                       file.max_position_error_mm <= allowed),
                number("max_orientation_error_deg", "Orientation, read back", file.max_orientation_error_deg, "°", 6),
                number("max_speed_error_percent", "Speed, read back", 100 * file.max_speed_error, "%", 4),
            }};
}

/// What was looked at, by which settings, with which program: enough to get the same numbers again.
ReportRows identity_rows(const PartResult& part) {
    ReportRows rows;
    if (!part.origin.file.empty()) {
        rows.push_back(fact("scan_file", "Scan", part.origin.file));
        rows.push_back(fact("scan_sha256", "SHA-256 of the scan", part.origin.sha256));
    }
    rows.push_back(fact("config_sha256", "SHA-256 of the settings", sha256(config_json(part.config))));
    rows.push_back(fact("program", "Program", "seampath " SEAMPATH_VERSION));
    rows.push_back(fact("build_sha256", "SHA-256 of the program", build_id()));
    return rows;
}

ReportRows scan_rows(const PartResult& part) {
    const Scan& scan = part.scan;
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& p : scan.points) {
        box.extend(p);
    }
    const Eigen::Vector3f size = box.isEmpty() ? Eigen::Vector3f::Zero() : Eigen::Vector3f(box.sizes());
    const std::string raster =
        scan.width == 0 ? "unorganised" : std::to_string(scan.width) + " × " + std::to_string(scan.height);
    return {
        fact("format", "Format", scan.format),
        fact("raster", "Raster", raster),
        count("points_in_file", "Points in the file", scan.points_in_file),
        count("dropped_not_finite", "Dropped, not finite", scan.dropped_not_finite),
        count("points", "Points used", scan.points.size()),
        number("mm_per_unit", "Millimetres per unit of the file", scan.mm_per_unit, "mm", 4),
        fact("unit_reason", "Why that unit", scan.unit_reason),
        number("size_x_mm", "Extent in x", static_cast<double>(size.x()), "mm", 1),
        number("size_y_mm", "Extent in y", static_cast<double>(size.y()), "mm", 1),
        number("size_z_mm", "Extent in z", static_cast<double>(size.z()), "mm", 1),
        number("spacing_mm", "Typical point distance", part.extraction.spacing_mm, "mm"),
        number("noise_mm", "Noise, rms about the surfaces", part.extraction.noise_mm, "mm"),
        count("views", "Views, by the order of the points", static_cast<std::size_t>(part.extraction.views)),
        number("registration_mm", "Registration of the views, 1σ along any direction", part.extraction.registration_mm,
               "mm", 4),
        fact("orientation_reason", "How the side of the air was told", part.extraction.orientation_reason),
    };
}

/// What is said of the torch path and its programs, for every part.
ReportRows path_rows(const PartResult& part) {
    double read_back = 0;
    for (const ProgramFile& file : part.programs) {
        read_back = std::max(read_back, file.max_position_error_mm);
    }
    ReportRows rows{
        count("waypoints", "Waypoints", part.plan.waypoints.size()),
        number("path_chord_error_mm", "Straight moves from the curve, largest", part.plan.max_chord_error_mm, "mm"),
        number("max_speed_error_percent", "Torch speed error, largest", 100 * part.plan.max_speed_error, "%", 2),
        number("max_turn_deg", "Torch rotation per move, largest", part.plan.max_turn_deg, "°", 2),
        number("duration_s", "Path duration", part.plan.duration_s, "s", 1),
        count("programs", "Program files", part.programs.size()),
        number("read_back_error_mm", "Program position error, largest", read_back, "mm", 6),
    };
    if (!part.plan.passes.empty()) {
        rows.push_back(count("passes", "Passes", part.plan.passes.size()));
    }
    const ReportRows torch = torch_rows(part.plan);
    rows.insert(rows.end(), torch.begin(), torch.end());
    if (part.plan.arm) {
        const ReportRows arm = arm_rows(*part.plan.arm);
        rows.insert(rows.end(), arm.begin(), arm.end());
    }
    return rows;
}

/// Of the seams of a nominal part, then of those that were found in a scan.
ReportRows nominal_rows(const PartResult& part) {
    double length = 0, error = 0;
    for (const SeamModel& model : part.models) {
        length += model.length_mm;
        error = std::max(error, model.residual_max_mm);
    }
    return {
        count("seams", "Nominal seams", part.models.size()),
        number("length_mm", "Seam length", length, "mm"),
        number("curve_error_max_mm", "Curve from the exact seam, largest", error, "mm", 9),
    };
}

ReportRows found_rows(const PartResult& part) {
    double length = 0, modelled = 0, rms_square = 0, worst = 0, checked = 0;
    std::size_t in_tolerance = 0;
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        const Deviation& deviation = part.deviations[i];
        length += part.models[i].length_mm;
        modelled += modelled_length(part.extraction.seams[i]);
        const double covered = part.models[i].length_mm * deviation.coverage;
        checked += covered;
        rms_square += covered * deviation.rms_mm * deviation.rms_mm;
        worst = std::max(worst, deviation.max_mm);
        in_tolerance += deviation.pass ? 1 : 0;
    }
    return {
        judged(count("seams", "Seams found", part.models.size()), !part.models.empty()),
        judged(count("seams_in_tolerance", "Seams in tolerance", in_tolerance), part.pass()),
        number("length_mm", "Seam length", length, "mm"),
        number("modelled_length_mm", "Bridged by model", modelled, "mm"),
        number("deviation_rms_mm", "Deviation, rms", checked > 0 ? std::sqrt(rms_square / checked) : 0, "mm"),
        number("deviation_max_mm", "Deviation, largest", worst, "mm"),
        number("coverage_percent", "Checked on scan", length > 0 ? 100 * checked / length : 0, "%", 1),
    };
}

std::string json_text(const Field& field) {
    return field_json(field).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::vector<ReportSetting> settings_of(const Config& config) {
    Config chosen = config, defaults;
    const auto sections = describe(chosen), default_sections = describe(defaults);
    std::vector<ReportSetting> settings;
    for (std::size_t s = 0; s < sections.size(); ++s) {
        for (std::size_t f = 0; f < sections[s].fields.size(); ++f) {
            const Field& field = sections[s].fields[f];
            const std::string value = json_text(field), default_value = json_text(default_sections[s].fields[f]);
            settings.push_back({std::string(sections[s].stage) + '.' + std::string(field.key), value, default_value,
                                std::string(field.meaning), value != default_value});
        }
    }
    return settings;
}

std::string part_sentence(const PartResult& part, std::size_t in_tolerance) {
    const std::string found = std::to_string(part.models.size()) + (part.models.size() == 1 ? " seam" : " seams");
    std::string path = part.plan.arm && !part.plan.arm->pass ? "; " + valid_utf8(part.plan.arm->verdict) : "";
    for (const SeamRefusal& refusal : part.plan.refused) {
        path += "; " + valid_utf8(refusal.reason);
    }
    if (part.nominal) {
        return found + " from nominal dimensions; not compared with a scan" + path;
    }
    if (part.models.empty()) {
        return "No seam was found in this scan";
    }
    std::size_t worst = 0;
    for (std::size_t i = 1; i < part.models.size(); ++i) {
        worst = tolerance_used(part.deviations[i]) > tolerance_used(part.deviations[worst]) ? i : worst;
    }
    const auto wide = std::find_if(part.deviations.begin(), part.deviations.end(), [&](const Deviation& deviation) {
        return wide_by_noise(deviation, part.config.validate);
    });
    if (wide != part.deviations.end()) {
        path += "; a tolerance of " + fixed(wide->tolerance_mm, 2) +
                " mm is only what the scan's noise allows, set validate.tolerance_mm to what the weld needs";
    }
    return std::to_string(in_tolerance) + " of " + found +
           " within tolerance of the scanned surfaces; the worst, seam " + std::to_string(worst) + ", uses " +
           fixed(100 * tolerance_used(part.deviations[worst]), 0) + " % of its tolerance" + path;
}

}  // namespace

Report report_of(const PartResult& part) {
    const std::size_t scanned = part.nominal ? 0 : part.models.size();
    ensure(part.extraction.seams.size() == scanned && part.nodes.size() == scanned && part.deviations.size() == scanned,
           "every seam of a report has nodes, model and deviation, and a nominal one its model alone");
    Report report;
    report.part = valid_utf8(part.scan.name);
    report.pass = part.pass();
    report.identity = identity_rows(part);
    report.rows = part.nominal ? nominal_rows(part) : found_rows(part);
    const ReportRows path = path_rows(part);
    report.rows.insert(report.rows.end(), path.begin(), path.end());
    report.scan = part.nominal ? ReportRows() : scan_rows(part);
    for (const std::string& remark : part.extraction.remarks) {
        report.remarks.push_back(valid_utf8(remark));
    }
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        report.seams.push_back(part.nominal ? nominal_report(part, i) : seam_report(part, i));
    }
    const auto passed = std::count_if(report.seams.begin(), report.seams.end(), [](const auto& s) { return s.pass; });
    report.sentence = part_sentence(part, static_cast<std::size_t>(passed));
    std::transform(part.programs.begin(), part.programs.end(), std::back_inserter(report.programs), program_report);
    report.settings = settings_of(part.config);
    report.timings = part.timings;
    return report;
}

}  // namespace seampath
