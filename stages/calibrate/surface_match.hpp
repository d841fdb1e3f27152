#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "stages/calibrate/frame_solver.hpp"
#include "stages/calibrate/sight.hpp"
#include "stages/calibrate/surfels.hpp"

/// Points held against a surface, and the frame that makes their distances least.
namespace seampath::calibrating {

/// A point, base frame, and its side: unit, out of the material or towards the sensor.
struct SidedPoint {
    Eigen::Vector3d p;
    Eigen::Vector3d side;
};

/// A point and the piece of surface that it lies on.
struct Contact {
    std::size_t point = 0;
    std::uint32_t surfel = 0;
    double distance = 0;     ///< mm, above 0 outside the material
    Eigen::Vector3d normal;  ///< base frame
};

/// From where points were seen, and what they may lie on.
struct Seeing {
    double least_cosine = 0;                ///< of a point's side to the normal of what it lies on
    std::optional<Eigen::Vector3d> sensor;  ///< base frame; what it can't see they do not lie on
};

/// A surface to hold points against.
class TargetSurface {
public:
    TargetSurface(std::vector<Surfel> surfels, double spacing)
        : surfels_(std::move(surfels)), spacing_(spacing), grid_(surfels_, 1.5 * spacing) {
        for (const Surfel& s : surfels_) {
            box_.extend(s.p);
        }
    }

    const std::vector<Surfel>& surfels() const { return surfels_; }
    double spacing() const { return spacing_; }

    /// The directions from which what saw the points may see the surface.
    Sights sights(const Seeing& seeing, const Eigen::Isometry3d& base_from_part) const {
        return sights_from(
            seeing.sensor ? std::optional<Eigen::Vector3d>(base_from_part.inverse() * *seeing.sensor) : std::nullopt,
            box_);
    }

    /// Of each point that lies within `gate` of a surfel turned to its side and in sight, no further along the surface
    /// than the surfel reaches, the nearest by that distance. In the order of the points.
    std::vector<Contact> contacts(std::span<const SidedPoint> points, const Eigen::Isometry3d& base_from_part,
                                  double gate, const Seeing& seeing) const;

private:
    std::vector<Surfel> surfels_;
    double spacing_;
    SurfelGrid grid_;
    Eigen::AlignedBox3d box_;
};

/// Point-to-plane least squares with Tukey's biweight, whose width shrinks from the surfels' spacing for as long as the
/// residuals leave it empty.
struct FrameFit {
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
    double gate_mm = 0;     ///< half width of the biweight at the end
    double scale_mm = 0;    ///< robust 1-sigma of the residuals
    double weak_ratio = 0;  ///< share of the mean information below which a direction was left as it was
    std::vector<Contact> contacts;
    Reference reference;
    LevelStep last;  ///< in the axes of base, about the reference, turns scaled by its length in `weak` alone
};

/// `least_scale_mm` keeps the width from collapsing on exact data. Empty contacts when nothing is near.
FrameFit fit_to_surface(const TargetSurface& surface, std::span<const SidedPoint> points,
                        const Eigen::Isometry3d& start, double first_gate, double least_scale_mm, const Seeing& seeing,
                        double weak_ratio);

/// Weight, and derivative of weight times residual, of Tukey's biweight at x = residual / half width.
inline double tukey_weight(double x) {
    return std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
}
inline double tukey_slope(double x) {
    return std::abs(x) < 1 ? (1 - x * x) * (1 - 5 * x * x) : 0;
}

/// Derivative of a contact's distance by a step (v, w) of the frame about the reference.
Vector6 contact_row(const Contact& contact, const Eigen::Vector3d& p, const Eigen::Vector3d& about);

}  // namespace seampath::calibrating
