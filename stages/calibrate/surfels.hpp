#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "stages/types.hpp"

/// Surfaces as pieces of quadrics, which a nominal mesh, a golden scan and a scan are all turned into.
namespace seampath::calibrating {

/// Directions, evenly over the sphere, 15 degrees apart.
inline constexpr std::size_t kSights = 192;
using Sights = std::bitset<kSights>;

/// A piece of surface: near p its height over the tangent plane is d' K d / 2.
struct Surfel {
    Eigen::Vector3d p;               ///< mm
    Eigen::Vector3d n;               ///< unit, out of the material
    Eigen::Matrix3d K;               ///< 1/mm, symmetric, K n = 0
    double rms = 0;                  ///< mm, of the points about the quadric
    Sights sights = Sights().set();  ///< directions from which the rest of its surface does not hide it
    double distance(const Eigen::Vector3d& q) const {
        const Eigen::Vector3d d = q - p;
        return n.dot(d) - 0.5 * d.dot(K * d);
    }
    Eigen::Vector3d normal(const Eigen::Vector3d& q) const { return (n - K * (q - p)).normalized(); }
};

/// Points in an order of their own, so that sums over them do not hang on the order given, and from which side each was
/// seen.
struct SidedCloud {
    std::vector<Eigen::Vector3f> points;  ///< from `origin`
    std::vector<Eigen::Vector3f> sides;   ///< of each: unit, out of the material or towards the sensor
    bool normals = false;                 ///< `sides` are normals
    Eigen::Vector3d origin{0, 0, 0};
    std::optional<Eigen::Vector3d> sensor;  ///< about where it stood, where the sides are not normals
    Eigen::Vector3d position(std::size_t i) const { return origin + points[i].cast<double>(); }
};

/// The sides are the scan's normals or, without them, point to where the sensor stood: as given, as the file says, or
/// at the origin of the scan's frame where that lies clear of the points. Throws InputError when none of this is known.
SidedCloud sided(const Scan& scan, const std::optional<Eigen::Vector3d>& sensor_mm);

/// One surfel for each cell of `spacing` and side, fitted to the points of the same side within `radius`; none where
/// they are too few. Frame of the scan.
std::vector<Surfel> surfels_of(const SidedCloud& cloud, double spacing, double radius);

/// Those whose points lie about them no worse than `factor` times the median, or than `allowed_mm`.
std::vector<Surfel> smooth_ones(std::vector<Surfel> surfels, double factor, double allowed_mm);

/// At most one for each cell of `spacing` and side.
std::vector<Surfel> thinned(const std::vector<Surfel>& surfels, double spacing);

/// Which surfels are within `reach` of a place: lists by cell.
class SurfelGrid {
public:
    SurfelGrid(std::span<const Surfel> surfels, double reach);

    /// Every surfel within reach of q is among these, with some that are further away.
    std::span<const std::uint32_t> near(const Eigen::Vector3d& q) const {
        const Eigen::Vector3d at = (q - low_) / cell_;
        if (!((at.array() >= 0).all() && (at.array() < count_.cast<double>().array()).all())) {
            return {};
        }
        const std::size_t c = index(at.cast<int>());
        return {list_.data() + start_[c], start_[c + 1] - start_[c]};
    }

private:
    std::size_t index(const Eigen::Vector3i& at) const {
        const auto n = count_.cast<std::size_t>(), i = at.cast<std::size_t>();
        return (i.z() * n.y() + i.y()) * n.x() + i.x();
    }
    template <class F>
    void for_cells_about(const Eigen::Vector3d& p, double reach, const F& f) const;

    double cell_;
    Eigen::Vector3d low_;
    Eigen::Vector3i count_;
    std::vector<std::uint32_t> start_, list_;
};

}  // namespace seampath::calibrating
