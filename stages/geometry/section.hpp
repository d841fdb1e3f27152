#pragma once

#include <optional>

#include <Eigen/Core>

#include "stages/geometry/grid.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/scale.hpp"

/// The measurement at the heart of the program: at one place of a seam, fit both flank surfaces to the raw points around
/// it, leaving out the corner itself, and intersect them in the section plane.
namespace seampath {

/// Where to look. Flank k lies in the plane of normal n_k; t = n1 x n2 / |n1 x n2| is the direction of the seam. Directions
/// away from the seam within the flanks: d1 = t x n1, d2 = n2 x t (concave joints).
struct Section {
    Eigen::Vector3d p;       ///< mm, in the frame of the grid
    Eigen::Vector3d n1;      ///< unit, out of the material
    Eigen::Vector3d n2;
};

/// Extent of the fits, mm: along the seam (half), and away from it. What lies closer than `band` is left out: real corners
/// have radii, tacks and multiple reflections.
struct SectionWindow {
    double along = 0;
    double away = 0;
    double band = 0;
};

/// Window to follow a seam with: small enough for bends, wide enough to see two surfaces through the noise.
SectionWindow following_window(const ScanScale& scale);

/// Window to measure with. Noise of scanners is correlated, so means over small patches hardly improve on a single point;
/// fits shrink it where the surface is not quadratic that far.
SectionWindow measuring_window(const ScanScale& scale);

/// One fitted flank: z(u, s) over u = distance from the seam, s = along it, z = along the normal of the section it was
/// fitted in; u and s divided by the window's size.
struct Flank {
    QuadraticFit fit;
    SectionWindow window;          ///< the one in which the surface is quadratic within the noise
    double height = 0;             ///< z of the surface at the seam
    double slope = 0;              ///< dz/du there
    double slope_along = 0;        ///< dz/ds there
    double sigma = 0;              ///< 1-sigma of height, mm
    double edge = 0;               ///< mm from the seam up to which it is used: a band before its end; infinity: no end seen
    double noise = 0;              ///< mm, of a point on this very surface
    double share = 1;              ///< of the points in the window that took part
    double slab_points = 0;        ///< points per mm^2 of the flank right at the section
};

struct SectionFit {
    Section section;               ///< p: where the fitted flanks meet; normals: of the fitted flanks there
    Eigen::Vector3d t;             ///< unit, n1 x n2
    Flank flank[2];
    double bend = 0;               ///< rad, angle between n1 and n2: 0 is flat
    double shift = 0;              ///< mm, how far p moved from where the search began
    double sigma = 0;              ///< mm, root of the variance of p across the seam
};

/// Fits both flanks around `guess`; empty when one of them has too few points, or they do not meet within the window.
std::optional<SectionFit> fit_section(const PointGrid& grid, const ScanScale& scale, const Section& guess, const SectionWindow& window);

/// Repeats fit_section from its own result until the point moves by less than a tenth of its sigma; at most `rounds` times.
std::optional<SectionFit> settle_section(const PointGrid& grid, const ScanScale& scale, const Section& guess, const SectionWindow& window, int rounds);

}  // namespace seampath
