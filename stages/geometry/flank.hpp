#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "stages/geometry/robust.hpp"
#include "stages/geometry/scale.hpp"

/// One flank of a joint as a surface, fitted to the points beside the seam in the largest window that one surface
/// explains. Coordinates: u = distance from the seam within the flank, s = along the seam, z = along the flank's
/// normal; mm.
namespace seampath {

/// Extent of the fits, mm: along the seam (half), and away from it. What lies closer than `band` is left out: real
/// corners have radii, tacks and multiple reflections.
struct SectionWindow {
    double along = 0;
    double away = 0;
    double band = 0;
};

/// Window to follow a seam with: small enough for bends, wide enough to see two surfaces through the noise.
SectionWindow following_window(const ScanScale& scale);

/// Window to measure with. Noise of scanners is correlated, so means over small patches hardly improve on a single
/// point; fits shrink it where the flank is not one surface that far, or bends by more than it tells of itself.
SectionWindow measuring_window(const ScanScale& scale);

/// One fitted flank: z(u, s) over u = distance from the seam, s = along it, z = along the normal of the section it was
/// fitted in; u and s divided by the window's size. The fit knows that a bent surface is round (see QuadraticFit).
struct Flank {
    QuadraticFit fit;
    SectionWindow window;    ///< the one in which the surface is that within the noise
    double height = 0;       ///< z of the surface at the seam
    double slope = 0;        ///< dz/du there
    double slope_along = 0;  ///< dz/ds there
    double sigma = 0;        ///< 1-sigma of height, mm
    double edge = 0;         ///< mm from the seam up to which it is used: a band before its end; infinity: no end seen
    double noise = 0;        ///< mm, of a point on this very surface
    double unit = 0;   ///< mm, 1-sigma of a point as far as means over many go: noise that neighbours share counts
    double share = 1;  ///< of the points in the window that took part
    double slab_points = 0;  ///< points per mm^2 of the flank right at the section
};

/// A point of the scan in a flank's coordinates.
struct FlankPoint {
    float u, s, z;
    std::uint32_t lot;  ///< the same for the same point, in whatever order the points came
};

struct FlankPoints {
    std::vector<FlankPoint> points;
    double share = 1;  ///< of the scan's points there
};

/// Keeps, by lot, as many samples as say something new: with more the noise that neighbours share only shows more
/// often.
void thin_out(FlankPoints& samples);

/// The scan's noise, or what counts as such where a scan has none; mm.
double noise_of(const ScanScale& scale);

/// What is left of a sample's z when the flank's surface is taken off, mm.
inline double residual(const Flank& flank, double u, double s, double z) {
    return flank.fit.residual(u / flank.window.away, s / flank.window.along, z);
}

/// How far the truth may lie off the flank's surface where it is carried on to (u, s), beyond its window; mm.
inline double continuation_doubt(const Flank& flank, double u, double s) {
    constexpr double kContinuation = 0.15;  // slope by which a surface may leave the continuation of its inner part
    return kContinuation * std::max({0.0, u - flank.window.away, std::abs(s) - flank.window.along});
}

/// Samples further off the surface than this belong to something else, a step, an edge, another wall; mm.
inline double gate(const Flank& flank, double u, double s) {
    return 4 * flank.noise + continuation_doubt(flank, u, s);
}

/// The flank in the largest window within the limit in which one surface explains what it holds; mostly that is the
/// limit. Empty when too few samples lie there.
std::optional<Flank> fit_flank(const FlankPoints& samples, const ScanScale& scale, SectionWindow limit);

/// Carries a flank on to the largest such window within a wider limit.
void widen(Flank& flank, const FlankPoints& samples, const ScanScale& scale, SectionWindow limit);

/// Takes back curvature that the fit is not sure of: a flat surface is then known nearly as well as if it had been
/// known to be flat.
void settle_flank(Flank& flank, const ScanScale& scale);

/// Sets height, slopes, sigma and density of the fitted flank for a seam at u, s = 0.
void finish_flank(Flank& flank, const ScanScale& scale, double u);

}  // namespace seampath
