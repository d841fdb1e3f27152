#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "stages/geometry/flank.hpp"
#include "stages/geometry/grid.hpp"

/// The measurement at the heart of the program: at one place of a seam, fit both flank surfaces to the raw points
/// around it, leaving out the corner itself, and intersect them in the section plane.
namespace seampath {

/// Where to look. Flank k lies in the plane of normal n_k; t = n1 x n2 / |n1 x n2| is the direction of the seam.
/// Directions away from the seam within the flanks: d1 = t x n1, d2 = n2 x t (concave joints).
struct Section {
    Eigen::Vector3d p;   ///< mm, in the frame of the grid
    Eigen::Vector3d n1;  ///< unit, out of the material
    Eigen::Vector3d n2;
};

/// Coordinates at a section: a point of flank k is p + u d[k] + s t + z n[k].
struct SectionFrame {
    Eigen::Vector3d p, t, n[2], d[2];
};

struct SectionFit {
    SectionFrame frame;  ///< that the flanks are expressed in
    Section section;     ///< p: where the fitted flanks meet; normals: of the fitted flanks there
    Eigen::Vector3d t;   ///< unit, n1 x n2
    Flank flank[2];
    double bend = 0;   ///< rad, angle between n1 and n2: 0 is flat
    double shift = 0;  ///< mm, how far p moved from where the search began
    double sigma = 0;  ///< mm, root of the variance of p across the seam
};

/// One of each flank. Both reach as far along the seam.
class SectionWindows {
public:
    SectionWindows(const SectionWindow& first, const SectionWindow& second) : of_{first, second} {}
    const SectionWindow& operator[](std::size_t k) const { return of_[k]; }

private:
    SectionWindow of_[2];
};

/// The windows of a joint whose second flank is a wall only `height` mm high: of the wall, what lies clear of its foot
/// and of its top.
SectionWindows beside_wall(const ScanScale& scale, const SectionWindow& window, double height);

/// Fits both flanks around `guess`; empty when one of them has too few points, or they do not meet within the window.
std::optional<SectionFit> fit_section(const PointGrid& grid, const ScanScale& scale, const Section& guess,
                                      const SectionWindows& windows);
inline std::optional<SectionFit> fit_section(const PointGrid& grid, const ScanScale& scale, const Section& guess,
                                             const SectionWindow& window) {
    return fit_section(grid, scale, guess, SectionWindows(window, window));
}

/// Repeats fit_section from its own result until the point moves by less than a tenth of its sigma; at most `rounds`
/// times.
std::optional<SectionFit> settle_section(const PointGrid& grid, const ScanScale& scale, const Section& guess,
                                         const SectionWindows& windows, int rounds);
inline std::optional<SectionFit> settle_section(const PointGrid& grid, const ScanScale& scale, const Section& guess,
                                                const SectionWindow& window, int rounds) {
    return settle_section(grid, scale, guess, SectionWindows(window, window), rounds);
}

}  // namespace seampath
