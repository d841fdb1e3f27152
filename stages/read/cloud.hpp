#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "stages/read/parallel.hpp"

namespace seampath {

/// Coordinates beyond this, in the file's unit, count as not finite: no scanner reaches so far, and their squares must
/// not overflow in the stages that follow.
inline constexpr double kCoordinateLimit = 1e12;

/// A point cloud in the file's own unit, finite records only.
struct Cloud {
    std::string format;
    Eigen::Vector3d origin{0, 0, 0};  ///< position of point i is origin + points[i]
    std::vector<Eigen::Vector3f> points;
    std::vector<Eigen::Vector3f> normals;  ///< as in the file, or empty
    std::vector<std::uint32_t> record;     ///< record number of each point, ascending; organised clouds only
    std::uint64_t records = 0;             ///< in the file, finite or not
    std::uint64_t dropped = 0;             ///< of these, not finite
    std::uint32_t width = 0;               ///< raster of an organised cloud, or 0
    std::uint32_t height = 0;
    std::optional<Eigen::Vector3d> sensor;
};

/// Where to put the origin of coordinates that have more digits than a float: 0 where the cloud lies within some eight
/// times its own size of 0 (a float then keeps a millionth of that size), else near the median of the samples. A
/// multiple of a power of two, so that taking it off is exact.
Eigen::Vector3d choose_origin(const std::vector<Eigen::Vector3d>& samples);

/// Writes the finite records of one block to consecutive slots.
class Slots {
public:
    Slots(Cloud& cloud, std::size_t first)
        : origin_(cloud.origin),
          point_(cloud.points.data() + first),
          normal_(cloud.normals.empty() ? nullptr : cloud.normals.data() + first),
          record_(cloud.record.empty() ? nullptr : cloud.record.data() + first) {}

    std::size_t kept() const { return kept_; }

    /// `normal` is read only where the cloud has normals.
    void add(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, std::size_t record) {
        if (!(std::abs(p.x()) <= kCoordinateLimit && std::abs(p.y()) <= kCoordinateLimit &&
              std::abs(p.z()) <= kCoordinateLimit)) {
            return;
        }
        point_[kept_] = (p - origin_).cast<float>();
        if (normal_) {
            normal_[kept_] = normal.cast<float>();
        }
        if (record_) {
            record_[kept_] = static_cast<std::uint32_t>(record);
        }
        ++kept_;
    }

    /// The same for coordinates that are floats already, in a cloud without normals or record numbers and of origin 0.
    void add_plain(const Eigen::Vector3f& p) {
        constexpr float kLimit = static_cast<float>(kCoordinateLimit);
        if (std::abs(p.x()) <= kLimit && std::abs(p.y()) <= kLimit && std::abs(p.z()) <= kLimit) {
            point_[kept_++] = p;
        }
    }

private:
    Eigen::Vector3d origin_;
    Eigen::Vector3f* point_;
    Eigen::Vector3f* normal_;
    std::uint32_t* record_;
    std::size_t kept_ = 0;
};

struct CloudParts {
    bool normals = false;
    bool record_numbers = false;
};

/// Fills a cloud block by block, in parallel: block b holds the records first[b] .. first[b + 1] and
/// `decode(b, slots)` adds them in order. Records that were not finite leave no gap.
void fill_cloud(Cloud& cloud, const std::vector<std::size_t>& first, CloudParts parts,
                const std::function<void(std::size_t block, Slots& slots)>& decode);

}  // namespace seampath
