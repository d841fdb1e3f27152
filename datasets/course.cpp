#include "datasets/course.hpp"

#include <cmath>

#include "datasets/portable_math.hpp"
#include "datasets/scene_parts.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {

using Eigen::Vector3d;

CourseLine::CourseLine(const SceneOptions& o) : kind_(o.course), half_length_(*o.length_mm / 2) {
    if (kind_ == Course::arc) {
        radius_ = *o.course_radius_mm;
        require(half_length_ < 0.95 * radius_, "an arc of radius " + shortest(radius_) + " mm can't be " +
                                                   shortest(*o.length_mm) +
                                                   " mm long; make course_radius_mm larger or length_mm shorter");
        const double chord = std::sqrt(radius_ * radius_ - half_length_ * half_length_);
        reach_ = (radius_ - chord) / 2;
        centre_ = reach_ - radius_;
    } else if (kind_ == Course::s_curve) {
        amplitude_ = *o.amplitude_mm;
        wave_number_ = 2 * portable::kPi / *o.wavelength_mm;
        reach_ = std::abs(amplitude_);
    }
}

CourseLine::Point CourseLine::at(double x) const {
    switch (kind_) {
        case Course::straight:
            return {{x, 0, 0}, Vector3d::UnitY()};
        case Course::arc: {
            const double up = std::sqrt(radius_ * radius_ - x * x);
            return {{x, centre_ + up, 0}, Vector3d(x, up, 0) / radius_};
        }
        case Course::s_curve: {
            const auto [s, c] = portable::sincos(wave_number_ * x);
            return {{x, amplitude_ * s, 0}, Vector3d(-amplitude_ * wave_number_ * c, 1, 0).normalized()};
        }
    }
    ensure(false, "every course has its points");
    return {};
}

SceneShape CourseLine::flank(double across, double z, double bevel, double side) const {
    const auto [s, c] = portable::sincos(bevel);
    if (kind_ == Course::s_curve) {
        ensure(across == 0 && bevel == 0, "walls along an S-curve are upright and on the line");
        return SineWall{amplitude_, wave_number_, 0, side};
    }
    if (kind_ == Course::straight) {
        return PlaneShape{{0, across, z}, {0, side * c, s}};
    }
    const double radius = radius_ + across;
    if (bevel == 0) {
        return CylinderShape{{0, centre_, 0}, Vector3d::UnitZ(), radius, side};
    }
    // The radius grows by -side tan(bevel) per mm of height: a cone that opens downwards or upwards.
    const double opens = side * s < 0 ? 1 : -1;
    require(radius > 0, "an arc of radius " + shortest(radius_) + " mm is too small for the part; make it larger");
    return ConeShape{{0, centre_, z - opens * radius * c / std::abs(s)}, {0, 0, opens}, std::abs(s), c, side};
}

}  // namespace seampath
