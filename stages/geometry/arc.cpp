#include "stages/geometry/arc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seampath {

NearestOnPath nearest_on_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
    const Eigen::Vector3d along = end - start;
    const double length2 = along.squaredNorm();
    const double fraction = length2 > 0 ? std::clamp((p - start).dot(along) / length2, 0.0, 1.0) : 0;
    return {(start + fraction * along - p).norm(), fraction};
}

Eigen::Vector3d CircularArc::at(double fraction) const {
    const double t = fraction * angle;
    return centre + radius * (std::cos(t) * x + std::sin(t) * y);
}

std::optional<CircularArc> arc_through(const Eigen::Vector3d& start, const Eigen::Vector3d& via,
                                       const Eigen::Vector3d& end) {
    const Eigen::Vector3d a = via - start, b = end - start;
    const Eigen::Vector3d normal = a.cross(b);
    const double area2 = normal.squaredNorm();
    if (!(area2 > 1e-20 * a.squaredNorm() * b.squaredNorm())) {
        return {};
    }
    // Circumcentre relative to the start.
    const Eigen::Vector3d to_centre =
        (a.squaredNorm() * b.cross(normal) + b.squaredNorm() * normal.cross(a)) / (2 * area2);
    CircularArc arc;
    arc.centre = start + to_centre;
    arc.radius = to_centre.norm();
    arc.x = -to_centre / arc.radius;
    arc.y = normal.normalized().cross(arc.x);
    const Eigen::Vector3d last = end - arc.centre;
    const double angle = std::atan2(last.dot(arc.y), last.dot(arc.x));
    // Start, via and end run anticlockwise about the normal by its definition.
    arc.angle = angle > 0 ? angle : angle + 2 * std::numbers::pi;
    return arc;
}

NearestOnPath nearest_on_arc(const Eigen::Vector3d& p, const CircularArc& arc) {
    const Eigen::Vector3d from_centre = p - arc.centre;
    const double t = std::atan2(from_centre.dot(arc.y), from_centre.dot(arc.x));
    // The angle of p, with the cut opposite to the arc's middle: what lies off the arc is nearest to one of its ends.
    const double middle = 0.5 * arc.angle;
    const double turned = middle + std::remainder(t - middle, 2 * std::numbers::pi);
    const double fraction = std::clamp(turned / arc.angle, 0.0, 1.0);
    return {(arc.at(fraction) - p).norm(), fraction};
}

}  // namespace seampath
