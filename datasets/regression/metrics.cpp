#include "datasets/regression/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/digest.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/rigid.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kSampleStep = 0.5;  // mm along a curve

double distance_from_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const Vector3d step = b - a;
    const double u = std::clamp((p - a).dot(step) / std::max(step.squaredNorm(), 1e-300), 0.0, 1.0);
    return (p - a - u * step).norm();
}

/// Largest distance of the points from the polyline through those of `corners`, each from the nearest place of all.
double worst_chord(const Points& points, const Points& corners) {
    double worst = 0;
    for (const Vector3d& p : points) {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
            nearest = std::min(nearest, distance_from_segment(p, corners[i], corners[i + 1]));
        }
        worst = std::max(worst, nearest);
    }
    return worst;
}

Points samples_of(const SeamModel& model) {
    const ArcLength arc(model.curve);
    const int steps = std::max(1, static_cast<int>(std::ceil(arc.length() / kSampleStep)));
    Points points;
    for (int i = 0; i <= steps; ++i) {
        points.push_back(position(model.curve, arc.parameter(std::min(arc.length() * i / steps, arc.length()))));
    }
    if (model.closed) {
        points.back() = points.front();
    }
    return points;
}

/// Share of the samples at which n1 x n2, of flanks that are not level with each other, points against travel.
double reversed_share(const PartResult& part) {
    constexpr double kLevel = 0.05;
    double reversed = 0, all = 0;
    for (const SeamModel& model : part.models) {
        const ArcLength arc(model.curve);
        for (const FlankSample& flanks : model.flanks) {
            const Vector3d way = flanks.n1.cross(flanks.n2);
            const double along = way.dot(tangent(model.curve, arc.parameter(flanks.station_mm)));
            all += way.norm() > kLevel;
            reversed += way.norm() > kLevel && along < 0;
        }
    }
    return all > 0 ? reversed / all : 0;
}

void measure_nodes(const PartResult& part, Measurements& to) {
    double nodes = 0, chord = 0, length = 0, freedom = 0, residual = 0, saddles = 0;
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        const Seam& seam = part.extraction.seams[i];
        Points all, corners;
        for (const SeamPoint& point : seam.points) {
            all.push_back(point.p);
        }
        for (const std::size_t k : part.nodes[i].index) {
            corners.push_back(all[k]);
        }
        if (seam.closed && !corners.empty()) {
            corners.push_back(corners.front());
        }
        nodes += static_cast<double>(part.nodes[i].index.size());
        chord = std::max(chord, worst_chord(all, corners));
        length += part.models[i].length_mm;
        freedom += part.models[i].degrees_of_freedom;
        residual = std::max(residual, part.models[i].residual_rms_mm);
        saddles += part.models[i].saddle.has_value();
    }
    to.add("seams", static_cast<double>(part.models.size()));
    to.add("saddles", saddles);
    to.add("length_mm", length);
    to.add("nodes", nodes);
    to.add("node_chord_mm", chord);
    to.add("degrees_of_freedom", freedom);
    to.add("residual_rms_mm", residual);
    to.add("reversed_share", reversed_share(part));
}

void measure_deviation(const PartResult& part, Measurements& to) {
    double mean = 0, rms = 0, p95 = 0, most = 0, coverage = 1, tolerance = 0, passed = 0;
    for (const Deviation& d : part.deviations) {
        mean = std::abs(d.signed_mean_mm) > std::abs(mean) ? d.signed_mean_mm : mean;
        rms = std::max(rms, d.rms_mm);
        p95 = std::max(p95, d.p95_mm);
        most = std::max(most, d.max_mm);
        coverage = std::min(coverage, d.coverage);
        tolerance = std::max(tolerance, d.tolerance_mm);
        passed += d.pass;
    }
    to.add("deviation_mean_mm", mean);
    to.add("deviation_rms_mm", rms);
    to.add("deviation_p95_mm", p95);
    to.add("deviation_max_mm", most);
    to.add("coverage", coverage);
    to.add("tolerance_mm", tolerance);
    to.add("passed_seams", passed);
}

bool welds(const Waypoint& w) {
    return w.kind == WaypointKind::weld_start || w.kind == WaypointKind::weld || w.kind == WaypointKind::weld_end;
}

void measure_path(const PartResult& part, Measurements& to) {
    double chord = 0, welded = 0, turn = 0;
    for (std::size_t i = 0; i < part.planned_seams.size(); ++i) {
        Points corners;
        for (const Waypoint& w : part.plan.waypoints) {
            if (welds(w) && w.seam == static_cast<int>(i)) {
                corners.push_back(w.p);
            }
        }
        if (part.plan.passes.empty()) {  // passes lie beside the seam
            const Points seam = samples_of(part.models[static_cast<std::size_t>(part.planned_seams[i])]);
            chord = std::max(chord, worst_chord(seam, corners));
        }
    }
    for (std::size_t i = 0; i + 1 < part.plan.waypoints.size(); ++i) {
        const Waypoint &a = part.plan.waypoints[i], &b = part.plan.waypoints[i + 1];
        if (welds(a) && welds(b) && a.seam == b.seam) {
            welded += (b.p - a.p).norm();
            turn = std::max(turn, kDegrees * a.q.angularDistance(b.q));
        }
    }
    to.add("waypoints", static_cast<double>(part.plan.waypoints.size()));
    to.add("path_chord_mm", chord);
    to.add("path_length_mm", welded);
    to.add("path_turn_deg", turn);
    to.add("duration_s", part.plan.duration_s);
}

void measure_programs(const PartResult& part, Measurements& to) {
    for (const ProgramFile& program : part.programs) {
        const std::string name = "program." + program.robot + "." + program.file_name + ".";
        to.add(name + "position_mm", program.max_position_error_mm);
        to.add(name + "orientation_deg", program.max_orientation_error_deg);
        to.add(name + "speed_share", program.max_speed_error);
        to.add(name + "path_mm", program.max_path_error_mm);
        to.add(name + "moves", static_cast<double>(program.moves));
        to.hashes.emplace_back(name + "sha256", sha256(program.content));
    }
}

}  // namespace

void measure_run(const PartResult& part, Measurements& to) {
    to.add("points", static_cast<double>(part.scan.points.size()));
    to.add("mm_per_unit", part.scan.mm_per_unit);
    to.add("noise_mm", part.extraction.noise_mm);
    to.add("registration_mm", part.extraction.registration_mm);
    measure_nodes(part, to);
    measure_deviation(part, to);
    measure_path(part, to);
    measure_programs(part, to);
}

void measure_fixture(const FixtureCalibration& c, const Eigen::Isometry3d& truth, Measurements& to) {
    double error = 0, sigmas = 0, expanded = 0, residual = 0;
    for (const WorkPointResult& w : c.frame.work_points) {
        const Vector3d off = w.in_base - truth * w.p;
        error = std::max(error, off.norm());
        sigmas = std::max(sigmas, std::sqrt(off.dot(w.covariance.ldlt().solve(off))));
        expanded = std::max(expanded, w.expanded_mm);
    }
    for (const FeatureResult& f : c.frame.features) {
        residual = std::max(residual, f.residual_mm);
    }
    to.add("frame_error_mm", error);
    to.add("frame_error_deg", kDegrees * displacement(truth, c.frame.base_from_part).tail<3>().norm());
    to.add("frame_error_sigmas", sigmas);
    to.add("frame_expanded_mm", expanded);
    to.add("frame_residual_mm", residual);
    to.add("frame_features", static_cast<double>(c.frame.features.size()));
    to.add("frame_pass", c.frame.pass());
}

}  // namespace seampath
