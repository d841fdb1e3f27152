#include "stages/calibrate/sight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stages/error.hpp"
#include "stages/geometry/parallel.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Array2i;
using Eigen::Vector3d;

constexpr double kPixel = 2.5;      // of the points' distance: six points each, so that few are empty by chance
constexpr double kSteepest = 0.17;  // cosine of 80 degrees: what lies flatter in the line of sight is not measured
constexpr std::size_t kLeastDirections = 3;  // fewer may be empty pixels
constexpr double kNextDirection = 0.3;       // rad: every direction has some of kSights so near
constexpr double kMostPixels = 4e6;

// Evenly over the sphere, along the golden spiral.
Vector3d direction_of(std::size_t i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / kSights, r = std::sqrt(1 - z * z),
                 a = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    return {r * std::cos(a), r * std::sin(a), z};
}

/// A picture of points along a direction.
class Silhouette {
public:
    Silhouette(const Vector3d& direction, const SidedCloud& points, const Eigen::AlignedBox3d& box, double pixel)
        : d_(direction),
          u_(d_.unitOrthogonal()),
          v_(d_.cross(u_)),
          middle_(box.center()),
          pixel_(pixel),
          side_(2 + static_cast<std::size_t>(box.diagonal().norm() / pixel)),
          nearest_(side_ * side_, -std::numeric_limits<float>::infinity()) {
        for (std::size_t i = 0; i < points.points.size(); ++i) {
            const Vector3d p = points.position(i) - middle_;
            float& height = nearest_[cell(p)];
            height = std::max(height, static_cast<float>(d_.dot(p)));
        }
    }

    bool shows(const Surfel& s) const {
        const double cosine = s.n.dot(d_);
        if (cosine < kSteepest) {
            return false;
        }
        // Of its own plane, points of the same pixel stand out by its diagonal times the slope.
        const double own = 1.5 * pixel_ * std::sqrt(1 / (cosine * cosine) - 1) + pixel_ / 2;
        return d_.dot(s.p - middle_) + own > nearest_[cell(s.p - middle_)];
    }

private:
    std::size_t cell(const Vector3d& p) const {
        const auto along = [&](const Vector3d& axis) {
            const double at = axis.dot(p) / pixel_ + static_cast<double>(side_) / 2;
            return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(side_ - 1)));
        };
        return along(v_) * side_ + along(u_);
    }

    Vector3d d_, u_, v_, middle_;
    double pixel_;
    std::size_t side_;
    std::vector<float> nearest_;
};

}  // namespace

void find_sights(std::vector<Surfel>& surfels, const SidedCloud& points, double point_spacing) {
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < points.points.size(); ++i) {
        box.extend(points.position(i));
    }
    const double pixel = std::max(kPixel * point_spacing, box.diagonal().norm() / std::sqrt(kMostPixels));
    std::vector<std::vector<std::uint8_t>> shown(kSights);
    parallel_for(kSights, 1, [&](std::size_t k) {
        const Silhouette picture(direction_of(k), points, box, pixel);
        for (const Surfel& s : surfels) {
            shown[k].push_back(picture.shows(s));
        }
    });
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        for (std::size_t k = 0; k < kSights; ++k) {
            surfels[i].sights[k] = shown[k][i] != 0;
        }
    }
    std::erase_if(surfels, [](const Surfel& s) { return s.sights.count() < kLeastDirections; });
}

Sights sights_from(const std::optional<Vector3d>& sensor, const Eigen::AlignedBox3d& box) {
    if (!sensor) {
        return Sights().set();
    }
    const Vector3d to = *sensor - box.center();
    // The surface itself spreads over so much as seen from there.
    const double wide = std::asin(std::min(1.0, box.diagonal().norm() / 2 / std::max(to.norm(), 1e-9)));
    Sights sights;
    for (std::size_t k = 0; k < kSights; ++k) {
        sights[k] = direction_of(k).dot(to.normalized()) > std::cos(kNextDirection + wide);
    }
    return sights;
}

DepthMap::DepthMap(const SidedCloud& scan, double point_spacing) {
    ensure(scan.sensor.has_value() && !scan.points.empty(), "a depth map is that of a sensor which saw something");
    sensor_ = *scan.sensor;
    Vector3d ahead = Vector3d::Zero();
    double distance = 0;
    const double n = static_cast<double>(scan.points.size());
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Vector3d ray = scan.position(i) - sensor_;
        ahead += ray.normalized() / n;
        distance += ray.norm() / n;
    }
    axes_.col(2) = ahead.normalized();
    axes_.col(0) = axes_.col(2).unitOrthogonal();
    axes_.col(1) = axes_.col(2).cross(axes_.col(0));
    pixel_ = kPixel * point_spacing / distance;
    Array2i low = Array2i::Constant(std::numeric_limits<int>::max()), high = -low;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        if (const auto at = pixel_of(scan.position(i) - sensor_)) {
            low = low.min(*at);
            high = high.max(*at);
        }
    }
    if ((high < low).any() || (high - low + 1).cast<double>().prod() > kMostPixels) {
        return;  // seen from amid its points: there is no picture
    }
    low_ = low;
    size_ = high - low + 1;
    nearest_.assign(static_cast<std::size_t>(size_.prod()), std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Vector3d ray = scan.position(i) - sensor_;
        if (const auto at = pixel_of(ray)) {
            const Array2i cell = *at - low_;
            float& depth = nearest_[index_of(cell)];
            depth = std::min(depth, static_cast<float>(ray.norm()));
        }
    }
}

std::optional<Array2i> DepthMap::pixel_of(const Vector3d& ray) const {
    const Vector3d r = axes_.transpose() * ray;
    if (!(r.z() > 0.2 * ray.norm())) {
        return std::nullopt;  // beside or behind the picture
    }
    return Array2i(static_cast<int>(std::floor(r.x() / r.z() / pixel_)),
                   static_cast<int>(std::floor(r.y() / r.z() / pixel_)));
}

std::size_t DepthMap::index_of(const Array2i& pixel) const {
    return static_cast<std::size_t>(pixel.y()) * static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(pixel.x());
}

bool DepthMap::sees_past(const Vector3d& p, double tolerance) const {
    const Vector3d ray = p - sensor_;
    const auto at = pixel_of(ray);
    if (!at) {
        return false;
    }
    const double least = ray.norm() + tolerance;
    bool any = false;
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            const Array2i cell = *at - low_ + Array2i(x, y);
            if ((cell < 0).any() || (cell >= size_).any()) {
                continue;
            }
            const float depth = nearest_[index_of(cell)];
            if (depth < least) {
                return false;
            }
            any = any || std::isfinite(depth);
        }
    }
    return any;
}

}  // namespace seampath::calibrating
