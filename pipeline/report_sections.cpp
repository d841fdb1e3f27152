#include "pipeline/report_sections.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pipeline/report_checks.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/report_traces.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/grid.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Sections of all seams together and of one, and points of a section: together some 400 kB of the page.
constexpr std::size_t kMostSections = 300, kSectionsOfSeam = 60, kMostPoints = 240;

/// How far a section reaches, in distances of scan points; of a groove also in its depths: both bevels and their tops.
constexpr double kReachSpacings = 24, kReachDepths = 2.2;

/// A section takes points from so far to both sides, in distances of scan points, and up to some times farther
/// until it has enough.
constexpr double kSlabSpacings = 1.5;
constexpr std::size_t kEnoughPoints = 80;
constexpr int kWidenings = 2;

SectionPlane plane_at(const SeamModel& model, const ArcLength& arc, double station) {
    const FlankSample flanks = flanks_at(model, station);
    const double u = arc.parameter(station);
    SectionPlane plane{position(model.curve, u), tangent(model.curve, u), {}, {}, {}, {}};
    const Vector3d air = flanks.n1 + flanks.n2;
    plane.y = (air - air.dot(plane.t) * plane.t).normalized();
    plane.x = plane.t.cross(plane.y);
    const double outwards = model.kind == JointKind::corner ? -1 : 1;
    for (int k = 0; k < 2; ++k) {
        const Vector3d n = k == 0 ? flanks.n1 : flanks.n2;
        plane.n[k] = plane.in_plane(n).normalized();
        plane.d[k] = (k == 0 ? outwards : -outwards) * plane.in_plane(plane.t.cross(n)).normalized();
    }
    return plane;
}

/// Raw points near all seams.
PointGrid grid_of(const PartResult& part, double reach) {
    Eigen::AlignedBox3d box;
    for (const Seam& seam : part.extraction.seams) {
        for (const SeamPoint& point : seam.points) {
            box.extend(point.p - part.scan.origin_mm);
        }
    }
    const Vector3d margin = Vector3d::Constant(2 * reach);
    const Eigen::AlignedBox3f near((box.min() - margin).cast<float>(), (box.max() + margin).cast<float>());
    std::vector<std::uint8_t> keep(part.scan.points.size());
    std::transform(part.scan.points.begin(), part.scan.points.end(), keep.begin(),
                   [&](const auto& p) { return near.contains(p) ? 1 : 0; });
    return {part.scan.points, 0.5 * reach, keep};
}

std::vector<Vector2d> points_in(const PointGrid& grid, const Vector3d& origin, const SectionPlane& plane, double reach,
                                double half) {
    std::vector<Vector2d> points;
    const Vector3d p = plane.p - origin;
    grid.for_points_in_ball(p, std::hypot(reach, half), [&](const Eigen::Vector3f& q, double) {
        const Vector3d v = q.cast<double>() - p;
        const Vector2d at = plane.in_plane(v);
        if (std::abs(v.dot(plane.t)) <= half && at.norm() <= reach) {
            points.push_back(at);
        }
    });
    return points;
}

/// Even steps along the checked samples, and the worst places.
std::vector<std::size_t> sections_of(const Deviation& deviation, const SeamModel& model, std::size_t most) {
    std::vector<std::size_t> covered, chosen = worst_samples(deviation, model);
    for (std::size_t k = 0; k < deviation.samples.size(); ++k) {
        if (deviation.samples[k].covered) {
            covered.push_back(k);
        }
    }
    const std::size_t count = std::min(most, covered.size());
    for (std::size_t i = 0; i < count; ++i) {
        chosen.push_back(covered[i * covered.size() / count]);
    }
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    return chosen;
}

double reach_of(const PartResult& part, std::size_t i) {
    const double by_spacing = kReachSpacings * part.extraction.spacing_mm;
    std::vector<double> depths;
    for (const GrooveStation& groove : part.extraction.seams[i].groove) {
        if (std::isfinite(groove.depth_mm.value)) {
            depths.push_back(groove.depth_mm.value);
        }
    }
    return std::max({by_spacing, kReachDepths * quantile(depths, 0.5), 1e-3});
}

SeamSection section_at(const PartResult& part, std::size_t i, const ArcLength& arc, const PointGrid& grid,
                       const DeviationSample& sample, double reach) {
    const Seam& seam = part.extraction.seams[i];
    const SectionPlane plane = plane_at(part.models[i], arc, sample.station_mm);
    SeamSection section{sample, kSlabSpacings * part.extraction.spacing_mm, {}, {}};
    std::vector<Vector2d> points = points_in(grid, part.scan.origin_mm, plane, reach, section.half_mm);
    for (int w = 0; w < kWidenings && points.size() < kEnoughPoints; ++w) {
        section.half_mm *= 2;
        points = points_in(grid, part.scan.origin_mm, plane, reach, section.half_mm);
    }
    for (const Trace& trace : section_traces(part, seam, plane, points, sample, reach)) {
        section.traces.emplace_back();
        for (const Vector2d& q : trace) {
            section.traces.back().push_back(q.cast<float>());
        }
    }
    const std::size_t step = points.size() / kMostPoints + 1;
    for (std::size_t k = 0; k < points.size(); k += step) {
        section.points.push_back(points[k].cast<float>());
    }
    return section;
}

std::string packed(const std::vector<Eigen::Vector2f>& points, double reach) {
    std::string bytes;
    for (const Eigen::Vector2f& p : points) {
        for (const float coordinate : p) {
            const double share = std::clamp(static_cast<double>(coordinate) / reach, -1.0, 1.0);
            const auto step = static_cast<unsigned>(std::lround(32767 * share)) & 0xffffU;
            bytes += static_cast<char>(step & 0xff);
            bytes += static_cast<char>(step >> 8);
        }
    }
    return base64(bytes);
}

}  // namespace

std::vector<SeamSections> seam_sections(const PartResult& part) {
    std::vector<SeamSections> seams(part.nominal ? 0 : part.models.size());
    if (seams.empty() || part.scan.points.empty()) {
        return seams;
    }
    double widest = 0;
    for (std::size_t i = 0; i < seams.size(); ++i) {
        seams[i].reach_mm = reach_of(part, i);
        widest = std::max(widest, seams[i].reach_mm);
    }
    const PointGrid grid = grid_of(part, widest);
    const std::size_t most = std::min(kSectionsOfSeam, kMostSections / seams.size());
    for (std::size_t i = 0; i < seams.size(); ++i) {
        const ArcLength arc(part.models[i].curve);
        for (const std::size_t k : sections_of(part.deviations[i], part.models[i], most)) {
            seams[i].sections.push_back(
                section_at(part, i, arc, grid, part.deviations[i].samples[k], seams[i].reach_mm));
        }
    }
    return seams;
}

std::string sections_json(const std::vector<SeamSections>& seams) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const SeamSections& seam : seams) {
        nlohmann::ordered_json sections = nlohmann::ordered_json::array();
        for (const SeamSection& section : seam.sections) {
            nlohmann::ordered_json traces = nlohmann::ordered_json::array();
            for (const auto& trace : section.traces) {
                traces.push_back(packed(trace, seam.reach_mm));
            }
            const DeviationSample& s = section.sample;
            sections.push_back({{"station", s.station_mm},
                                {"distance", s.distance_mm},
                                {"sigma", s.sigma_mm},
                                {"flanks", {s.flank1_mm, s.flank2_mm}},
                                {"half", section.half_mm},
                                {"points", packed(section.points, seam.reach_mm)},
                                {"traces", std::move(traces)}});
        }
        all.push_back({{"reach", seam.reach_mm}, {"sections", std::move(sections)}});
    }
    return all.dump();
}

}  // namespace seampath
