#pragma once

#include <Eigen/Core>

#include "datasets/scenes.hpp"

namespace seampath {

/// The line that a joint follows, seen from above: it runs along +x from x = -length/2 to x = length/2 in the plane
/// z = 0. Straight: y = 0. Arc: a circle that bulges to +y. S-curve: y = amplitude sin(wave number x). "Across" is the
/// distance to its left, which is the +y side; of an S-curve it is along y.
class CourseLine {
public:
    /// Throws InputError for an arc whose circle is too small for its length.
    explicit CourseLine(const SceneOptions& o);

    /// Foot of x on the line, with the unit vector to its left.
    struct Point {
        Eigen::Vector3d p;
        Eigen::Vector3d left;
    };
    Point at(double x) const;

    /// Surface through what lies `across` from the line at the height z, with the material on the right for side = +1,
    /// on the left for side = -1. It leans back by `bevel` (rad) from the upright, so that it faces up for bevel > 0.
    /// Arcs and straight lines only, unless bevel and across are 0.
    SceneShape flank(double across, double z, double bevel, double side) const;
    SceneShape wall(double across, double side) const { return flank(across, 0, 0, side); }

    double half_length() const { return half_length_; }
    double reach() const { return reach_; }  ///< largest |y| of the line

private:
    Course kind_;
    double half_length_;
    double reach_ = 0;
    double radius_ = 0;  // arc
    double centre_ = 0;  // arc: y of the circle's centre
    double amplitude_ = 0;
    double wave_number_ = 0;
};

}  // namespace seampath
