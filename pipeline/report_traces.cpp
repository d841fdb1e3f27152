#include "pipeline/report_traces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/geometry/flank_surface.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A trace ends with the points that are so near to it, in sigmas of the scan's noise.
constexpr double kNearTrace = 4;

/// How far points lie on the line from `from` along d.
double supported(const std::vector<Vector2d>& points, const Vector2d& from, const Vector2d& d, double near) {
    double most = 0;
    for (const Vector2d& p : points) {
        const Vector2d v = p - from;
        const double along = v.dot(d);
        if ((v - along * d).norm() <= near) {
            most = std::max(most, along);
        }
    }
    return most;
}

/// b, or where the way from a to it leaves the reach; a lies within it.
Vector2d within_reach(const Vector2d& a, const Vector2d& b, double reach) {
    const Vector2d way = b - a;
    const double along = a.dot(way), square = way.squaredNorm();
    if (b.norm() <= reach || square == 0) {
        return b;
    }
    const double root = along * along + square * (reach * reach - a.squaredNorm());
    return a + (std::sqrt(std::max(0.0, root)) - along) / square * way;
}

/// The cut of a curved surface: each point of the straight line from `from` along d, as far as the section reaches,
/// moved onto it along the flank's normal n; as far as points lie beside it.
Trace on_surface(const SurfaceFit& surface, const SectionPlane& plane, const Vector2d& from, std::size_t k,
                 const std::vector<Vector2d>& points, double reach) {
    constexpr int kSteps = 12, kRounds = 6;
    constexpr double kLeastSlope = 0.2;  // of the surface against n; below it, it runs out of the plane
    Trace trace;
    for (int i = 0; i <= kSteps; ++i) {
        Vector2d q = from + reach * i / kSteps * plane.d[k];
        for (int round = 0; round < kRounds; ++round) {
            const Vector3d at = plane.in_space(q);
            const double slope = plane.in_plane(surface.normal(at)).dot(plane.n[k]);
            q -= surface.distance(at) / (std::abs(slope) < kLeastSlope ? kLeastSlope : slope) * plane.n[k];
        }
        trace.push_back(q);
    }
    const auto beside = [&](const Vector2d& q) {
        return std::any_of(points.begin(), points.end(),
                           [&](const Vector2d& p) { return (p - q).norm() < reach / kSteps; });
    };
    while (trace.size() > 2 && (trace.back().norm() > reach || !beside(trace.back()))) {
        trace.pop_back();
    }
    return trace;
}

/// Flank k where it was measured, from the curve as far as points lie on it.
Trace flank_trace(const Seam& seam, const SectionPlane& plane, const std::vector<Vector2d>& points, double flank_mm,
                  double near, double reach, std::size_t k) {
    const Vector2d from = -flank_mm * plane.n[k];
    const auto& surface = k == 0 ? seam.surfaces.first : seam.surfaces.second;
    if (surface && surface->explains && surface->shape != SurfaceShape::plane) {
        return on_surface(surface_fit(*surface, Vector3d::Zero()), plane, from, k, points, reach);
    }
    return {from, from + supported(points, from, plane.d[k], near) * plane.d[k]};
}

Vector2d turned(const Vector2d& v, double angle) {
    return Eigen::Rotation2Dd(angle) * v;
}

/// Bevels and tops of a groove, or the tops of a butt joint, from the numbers that extraction measured here. Side k
/// lies along d[k], to the right of travel for the first.
std::vector<Trace> groove_traces(JointKind kind, const GrooveStation& groove, const SectionPlane& plane, double reach) {
    std::vector<Trace> traces;
    for (std::size_t k = 0; k < 2; ++k) {
        const double side = k == 0 ? 1 : -1;
        const double gap = std::isfinite(groove.gap_mm.value) ? groove.gap_mm.value : 0;
        const double step = std::isfinite(groove.mismatch_mm.value) ? groove.mismatch_mm.value : 0;
        const Vector2d foot(0.5 * side * gap, 0);
        if (kind == JointKind::butt) {
            const Vector2d edge = foot + Vector2d(0, -0.5 * side * step);
            traces.push_back({edge, within_reach(edge, edge + 2 * reach * plane.d[k], reach)});
            continue;
        }
        const double bevel = k == 0 ? groove.bevel1_rad.value : groove.bevel2_rad.value;
        if (!std::isfinite(bevel) || !std::isfinite(groove.depth_mm.value)) {
            continue;
        }
        // The plate's upright is the bevel's direction turned back by the bevel's angle; its top is square to that.
        const Vector2d upright = turned(plane.d[k], side * bevel);
        const double height = groove.depth_mm.value - 0.5 * side * step;
        const Vector2d edge = foot + height / std::cos(bevel) * plane.d[k];
        const Vector2d out = turned(upright, -0.5 * side * std::numbers::pi);
        traces.push_back({foot, edge, within_reach(edge, edge + 2 * reach * out, reach)});
    }
    return traces;
}

/// What extraction measured of a groove nearest to a place.
const GrooveStation& nearest_groove(const Seam& seam, const Vector3d& p) {
    const auto nearest = std::min_element(seam.points.begin(), seam.points.end(), [&](const auto& a, const auto& b) {
        return (a.p - p).squaredNorm() < (b.p - p).squaredNorm();
    });
    return seam.groove[static_cast<std::size_t>(nearest - seam.points.begin())];
}

}  // namespace

std::vector<Trace> section_traces(const PartResult& part, const Seam& seam, const SectionPlane& plane,
                                  const std::vector<Vector2d>& points, const DeviationSample& sample, double reach) {
    if (!seam.groove.empty()) {
        return groove_traces(seam.kind, nearest_groove(seam, plane.p), plane, reach);
    }
    const double near = kNearTrace * part.extraction.noise_mm;
    return {flank_trace(seam, plane, points, sample.flank1_mm, near, reach, 0),
            flank_trace(seam, plane, points, sample.flank2_mm, near, reach, 1)};
}

}  // namespace seampath
