#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "stages/angle.hpp"
#include "stages/geometry/density_edge.hpp"
#include "stages/geometry/flank.hpp"
#include "stages/geometry/groove_points.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/scale.hpp"
#include "stages/types.hpp"

/// The measurement of a groove at one place: the tops and bevels of both plates are fitted as lines or arcs of the
/// section, corners being left out, and intersected; a bevel's lower end is where it is seen to turn into the root
/// face, else where its points end. Side 0 is the plate on the right of travel, with the seam's first flank, side 1 the
/// one on the left.
namespace seampath {

/// A side more upright than this has no bevel; rad.
inline constexpr double kSquareSide = 8 * kDegree;

/// Third component of the cross product of vectors in the section.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a[0] * b[1] - a[1] * b[0];
}

/// Where the faces of a section are, well enough to find their points.
struct GrooveShape {
    std::array<Eigen::Vector2d, 2> corner;  ///< top edges, (a, h), mm
    std::array<Eigen::Vector2d, 2> end;     ///< a place on each bevel; its lower end where that is known
    std::array<Eigen::Vector2d, 2> out;     ///< unit, along each top away from the groove
};

struct GrooveWindow {
    double back = 0;  ///< mm along the groove, from the place
    double ahead = 0;
    double away = 0;  ///< mm, along the tops
    double band = 0;  ///< mm, left out at the corners
};

/// The same window as for flanks, both ways along the groove.
GrooveWindow groove_window(const SectionWindow& window);

/// Of a window at a place that lies this far from both ends of an open groove: what ends cut off on one side is added
/// to the other.
GrooveWindow near_ends(const GrooveWindow& window, double to_begin, double to_end);

/// A face's line in the section: o + u d + z(u) n, with z = c0 + c1 u / length + c2 (u / length)^2.
struct GrooveFace {
    Eigen::Vector2d o, d, n;
    double length = 1;                   ///< mm
    Eigen::Vector3d c{0, 0, 0};          ///< mm
    Eigen::Matrix3d covariance;          ///< of c, from noise, mm^2
    double slope_along = 0;              ///< dz/ds at the place: the line is not quite the groove's own
    double scale = 0;                    ///< mm, robust 1-sigma of the points
    std::vector<Eigen::Vector3d> shift;  ///< by how much c changes when a view's points move by 1 mm along n

    Eigen::Vector2d at(double u) const;
    Eigen::Vector2d tangent(double u) const;  ///< unit
    double off(const Eigen::Vector2d& x) const;
    double along(const Eigen::Vector2d& x) const { return d.dot(x - o); }
    Eigen::Vector2d gradient() const { return n - c[1] / length * d; }  ///< of off(), about o
};

/// How deep below its own top a bevel ends.
struct BevelDepth {
    double depth = 0;           ///< mm
    double sigma = 0;           ///< mm, from noise
    std::vector<double> share;  ///< of each view in it
    bool turns = false;         ///< the surface is seen to turn upright there, into the root face
};

/// What kind of root a groove has, along all of it.
struct GrooveRoot {
    bool closed = false;                         ///< the bevels meet in a line
    std::optional<int> square;                   ///< the side without a bevel
    std::array<bool, 2> as_other{false, false};  ///< the bevel's end is hidden, and taken to be as deep as the other's
    bool unseen = false;  ///< the bevels may go on in shadow: no root is so wide, or nothing confirms the end
};

/// Of one place, as measured: the numbers hang on what the root is.
struct GrooveFit {
    std::array<GrooveFace, 2> top, bevel;
    std::array<std::optional<BevelDepth>, 2> seen;  ///< where each bevel's points end, here
    std::array<BevelDepth, 2> lower;                ///< where each bevel ends, by all that is known
    std::array<double, 2> density{0, 0};            ///< of each bevel's points right at the place, per mm^2
    GrooveShape shape;                              ///< as fitted: where to look next
};

/// Root and numbers of a fitted section.
struct GrooveNumbers {
    static constexpr int kCount = 9;
    using Vector = Eigen::Matrix<double, kCount, 1>;
    /// a and h of the root, gap, mismatch, bevels 1 and 2, included angle, depth, area.
    Vector value = Vector::Zero();
    Vector variance = Vector::Zero();       ///< from noise
    Vector shift = Vector::Zero();          ///< per variance of the views' shifts along any direction
    std::array<Eigen::Vector2d, 2> normal;  ///< of the bevels at the root, in the section

    Eigen::Vector2d root() const { return value.head<2>(); }
    Measured number(int i, double registration) const;
    /// 1-sigma of the root across the seam.
    double sigma(double registration) const;
};

/// Fits the faces about `guess`; empty when one of them has too few points.
std::optional<GrooveFit> fit_groove(const PointGrid& grid, std::span<const std::size_t> view_starts,
                                    const ScanScale& scale, const GrooveFrame& frame, const GrooveShape& guess,
                                    const GrooveWindow& window, int rounds);

/// The faces' whereabouts where only the root, at the frame's own place, and both bevels' normals in the section are
/// known, by `back` and `ahead` mm of the groove: a bevel's upper end is where its points end, and the top is the line
/// beside it that most points lie on. Empty where there are no bevels.
std::optional<GrooveShape> shape_about(const PointGrid& grid, const ScanScale& scale, const GrooveFrame& frame,
                                       const std::array<Eigen::Vector2d, 2>& normals, double back, double ahead);

/// Where the bevels end by all places together, in order along the groove and `step` mm apart, each of which saw
/// `window` mm of it; sets `lower` of each. A bevel's end is often hidden in the shadow of the other plate: it is then
/// where it is seen elsewhere, and no deeper than that shadow where it is not. Empty when no place saw any.
std::optional<GrooveRoot> pool_roots(std::span<GrooveFit> fits, double step, double window);

/// Of side k's bevel from the upright of its plate, at the place u of its line; rad.
double bevel_angle(const GrooveFit& fit, std::size_t k, double u);

/// How deep below side k's top the lines of both bevels meet, mm.
double crossing_depth(const GrooveFit& fit, std::size_t k);

/// Empty when the faces do not make a groove.
std::optional<GrooveNumbers> numbers_of(const GrooveFit& fit, const GrooveRoot& root);

GrooveStation station_of(const GrooveNumbers& numbers, double registration);

}  // namespace seampath
