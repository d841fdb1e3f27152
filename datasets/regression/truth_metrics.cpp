#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/regression/frechet.hpp"
#include "datasets/regression/metrics.hpp"
#include "datasets/score.hpp"
#include "stages/geometry/bspline.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Line = std::vector<Vector3d>;

constexpr double kDegree = 180 / std::numbers::pi;
constexpr double kLeashStep = 0.5;  // mm between the points of both lines

double largest(const std::vector<double>& values) {
    return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

void add_score(const std::string& of, const Score& s, Measurements& to) {
    to.add(of + "rms_mm", s.rms_mm);
    to.add(of + "p50_mm", s.p50_mm);
    to.add(of + "p95_mm", s.p95_mm);
    to.add(of + "max_mm", s.max_mm);
    to.add(of + "lateral_mean_mm", s.lateral_mean_mm);
    to.add(of + "lateral_rms_mm", s.lateral_rms_mm);
    to.add(of + "vertical_mean_mm", s.vertical_mean_mm);
    to.add(of + "vertical_rms_mm", s.vertical_rms_mm);
    to.add(of + "found", s.found);
    to.add(of + "false_share", s.false_share);
    to.add(of + "repeated_share", s.repeated_share);
    to.add(of + "wrong_kind_share", s.wrong_kind_share);
    to.add(of + "end_mm", largest(s.end_errors_mm));
}

/// The model's curve from its first point, closed curves back to it.
Line line_of(const SeamModel& model) {
    const ArcLength arc(model.curve);
    const int steps = std::max(1, static_cast<int>(std::ceil(arc.length() / kLeashStep)));
    Line line;
    for (int i = 0; i < steps; ++i) {
        line.push_back(position(model.curve, arc.parameter(arc.length() * i / steps)));
    }
    line.push_back(model.closed ? line.front() : position(model.curve, arc.parameter(arc.length())));
    return line;
}

/// The true seam, thinned to the step; a closed one from the place nearest to `start` and back to it.
Line line_of(const TruthSeam& seam, const Vector3d& start) {
    Line all;
    for (const TruthPoint& point : seam.points) {
        all.push_back(point.p);
    }
    if (seam.closed) {
        const auto nearest = std::min_element(all.begin(), all.end(), [&](const auto& a, const auto& b) {
            return (a - start).squaredNorm() < (b - start).squaredNorm();
        });
        const std::vector<TruthFoot> foot = truth_feet(std::vector{start}, Truth{{seam}});
        std::rotate(all.begin(), nearest, all.end());
        all.front() = std::isfinite(foot[0].distance_mm) ? foot[0].at.p : all.front();
        all.push_back(all.front());
    }
    Line line{all.front()};
    for (std::size_t i = 1; i + 1 < all.size(); ++i) {
        if ((all[i] - line.back()).norm() >= kLeashStep) {
            line.push_back(all[i]);
        }
    }
    line.push_back(all.back());
    return line;
}

/// Of each true seam from the model that follows it best, whichever way it goes, the largest; infinite where a seam has
/// none.
double worst_frechet(const PartResult& part, const Truth& truth) {
    double worst = 0;
    for (const TruthSeam& seam : truth.seams) {
        double best = std::numeric_limits<double>::infinity();
        for (const SeamModel& model : part.models) {
            if (model.closed != seam.closed) {
                continue;
            }
            Line line = line_of(model);
            const Line known = line_of(seam, line.front());
            best = std::min(best, frechet_distance(line, known));
            std::reverse(line.begin(), line.end());
            best = std::min(best, frechet_distance(line, known));
        }
        worst = std::max(worst, best);
    }
    return worst;
}

/// rms of the curves' errors over the 1-sigma that they state there.
double error_in_sigmas(const PartResult& part, const Truth& truth) {
    double squares = 0, count = 0;
    for (const SeamModel& model : part.models) {
        const ArcLength arc(model.curve);
        const int steps = std::max(1, static_cast<int>(arc.length()));
        Line line;
        for (int i = 0; i < steps; ++i) {
            line.push_back(position(model.curve, arc.parameter(arc.length() * i / steps)));
        }
        const std::vector<TruthFoot> feet = truth_feet(line, truth);
        for (int i = 0; i < steps; ++i) {
            const double error = feet[static_cast<std::size_t>(i)].distance_mm;
            const double sigma = flanks_at(model, arc.length() * i / steps).sigma_mm;
            if (std::isfinite(error) && sigma > 0) {
                squares += error * error / (sigma * sigma);
                count += 1;
            }
        }
    }
    return count > 0 ? std::sqrt(squares / count) : 0;
}

/// Torch poses against the truth: places, the torch's axis against the bisector into the joint, and +X against travel,
/// either way.
void add_path(const PartResult& part, const Truth& truth, Measurements& to) {
    Line places;
    std::vector<Eigen::Quaterniond> torch;
    for (const Waypoint& w : part.plan.waypoints) {
        if (w.kind == WaypointKind::weld_start || w.kind == WaypointKind::weld || w.kind == WaypointKind::weld_end) {
            places.push_back(w.p);
            torch.push_back(w.q);
        }
    }
    const std::vector<TruthFoot> feet = truth_feet(places, truth);
    std::vector<std::pair<double, double>> torch_deg, travel_deg;
    double squares = 0, most = 0;
    for (std::size_t i = 0; i < feet.size(); ++i) {
        if (!std::isfinite(feet[i].distance_mm)) {
            continue;
        }
        const Vector3d into = -(feet[i].at.n1 + feet[i].at.n2).normalized();
        const double down = (torch[i] * Vector3d::UnitZ()).dot(into);
        const double along = std::abs((torch[i] * Vector3d::UnitX()).dot(feet[i].at.tangent));
        torch_deg.emplace_back(kDegree * std::acos(std::clamp(down, -1.0, 1.0)), 1);
        travel_deg.emplace_back(kDegree * std::acos(std::clamp(along, -1.0, 1.0)), 1);
        squares += feet[i].distance_mm * feet[i].distance_mm;
        most = std::max(most, feet[i].distance_mm);
    }
    to.add("path_rms_mm", torch_deg.empty() ? 0 : std::sqrt(squares / static_cast<double>(torch_deg.size())));
    to.add("path_max_mm", most);
    to.add("torch_p95_deg", weighted_quantile(torch_deg, 0.95));
    to.add("travel_p95_deg", weighted_quantile(travel_deg, 0.95));
}

void add_in_sigmas(const std::string& name, const std::optional<Measured>& measured, const std::optional<double>& truth,
                   Measurements& to) {
    if (measured && truth && measured->sigma > 0) {
        to.add(name, (measured->value - *truth) / measured->sigma);
    }
}

/// Of the longest seam that is a saddle. A branch that leans by an angle stands at a right angle less that one.
void add_saddle(const PartResult& part, const SceneOptions& scene, Measurements& to) {
    const auto found =
        std::find_if(part.models.begin(), part.models.end(), [](const SeamModel& m) { return m.saddle.has_value(); });
    const bool pipe = scene.kind == SceneKind::pipe_on_plate || scene.header_radius_mm.has_value();
    if (found == part.models.end() || !pipe) {
        return;
    }
    const double angle = std::numbers::pi / 2 - std::abs(scene.lean_deg.value_or(0)) / kDegree;
    add_in_sigmas("saddle_branch_radius_sigmas", found->saddle->branch_radius_mm, scene.radius_mm, to);
    add_in_sigmas("saddle_header_radius_sigmas", found->saddle->header_radius_mm, scene.header_radius_mm, to);
    add_in_sigmas("saddle_angle_sigmas", found->saddle->angle_rad, angle, to);
    add_in_sigmas("saddle_offset_sigmas", found->saddle->offset_mm, scene.offset_mm, to);
}

/// Mean errors of the groove's dimensions along the longest seam that has them.
void add_groove(const PartResult& part, const Truth& truth, Measurements& to) {
    const auto seam = std::find_if(part.extraction.seams.begin(), part.extraction.seams.end(),
                                   [](const Seam& s) { return !s.groove.empty(); });
    const auto known =
        std::find_if(truth.seams.begin(), truth.seams.end(), [](const TruthSeam& s) { return s.groove.has_value(); });
    if (seam == part.extraction.seams.end() || known == truth.seams.end()) {
        return;
    }
    const Groove& g = *known->groove;
    // A seam that goes the other way has the other plate on its first side.
    const std::vector<TruthFoot> foot = truth_feet(std::vector{seam->points.front().p}, truth);
    const Vector3d way = seam->points.back().p - seam->points.front().p;
    const double side = way.dot(foot[0].at.tangent) < 0 ? -1 : 1;
    const auto add = [&](const std::string& name, Measured GrooveStation::*value, double true_value, double unit) {
        double sum = 0, count = 0;
        for (const GrooveStation& station : seam->groove) {
            const double v = (station.*value).value;
            sum += std::isfinite(v) ? v : 0;
            count += std::isfinite(v);
        }
        if (count > 0) {
            to.add(name, unit * sum / count - true_value);
        }
    };
    add("groove_gap_error_mm", &GrooveStation::gap_mm, g.gap_mm, 1);
    add("groove_mismatch_error_mm", &GrooveStation::mismatch_mm, side * g.mismatch_mm, 1);
    if (known->kind == JointKind::v_groove) {
        add("groove_included_angle_error_deg", &GrooveStation::included_angle_rad, g.included_angle_deg, kDegree);
        add("groove_depth_error_mm", &GrooveStation::depth_mm, g.depth_mm, 1);
        add("groove_root_face_error_mm", &GrooveStation::root_face_mm, g.root_face_mm, 1);
        add("groove_area_error_mm2", &GrooveStation::area_mm2, g.area_mm2, 1);
    }
}

}  // namespace

void measure_truth(const PartResult& part, const Truth& truth, const SceneOptions* scene, Measurements& to) {
    const Score fitted = score(part.models, truth);
    add_score("extracted_", score(part.extraction.seams, truth), to);
    add_score("fitted_", fitted, to);
    to.add("fitted_tangent_p95_deg", fitted.tangent_p95_deg);
    to.add("fitted_frechet_mm", worst_frechet(part, truth));
    to.add("fitted_error_sigmas", error_in_sigmas(part, truth));
    add_path(part, truth, to);
    if (scene) {
        add_saddle(part, *scene, to);
    }
    add_groove(part, truth, to);
}

}  // namespace seampath
