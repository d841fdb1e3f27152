#include "stages/depth/depth.hpp"

#include <cmath>

#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

/// Depths in mm along one row or column; 0 where there is none.
class DepthLine {
public:
    DepthLine(const GreyImage& image, double mm_per_unit, int column, int row, int step_x, int step_y)
        : image_(image), scale_(mm_per_unit), column_(column), row_(row), step_x_(step_x), step_y_(step_y) {}

    /// So many pixels from the line's pixel; 0 beyond the border, too.
    double operator()(int i) const {
        const int c = column_ + i * step_x_, r = row_ + i * step_y_;
        return c < 0 || r < 0 || c >= image_.width || r >= image_.height ? 0 : scale_ * image_.at(c, r);
    }

private:
    const GreyImage& image_;
    double scale_;
    int column_, row_, step_x_, step_y_;
};

/// 1-sigma of a depth over its square. Second differences see no slopes, and their median no steps.
double noise_of_depths(const GreyImage& image, double mm_per_unit) {
    constexpr double kSigmaOfMedian = 1.4826;
    constexpr int kRowsLeftOut = 2;
    std::vector<double> differences;
    for (int r = 0; r < image.height; r += 1 + kRowsLeftOut) {
        for (int c = 1; c + 1 < image.width; ++c) {
            const DepthLine z(image, mm_per_unit, c, r, 1, 0);
            if (z(-1) > 0 && z(0) > 0 && z(1) > 0) {
                differences.push_back(std::abs(z(-1) - 2 * z(0) + z(1)) / (z(0) * z(0)));
            }
        }
    }
    return kSigmaOfMedian * quantile(differences, 0.5) / std::sqrt(6.0);
}

/// The depth that one side, `reach` pixels away, would have at the pixel if it were drawn out; 0 where there is no such
/// side.
double drawn_out(const DepthLine& z, int reach) {
    const double near = z(reach), far = z(2 * reach);
    return near > 0 && far > 0 ? 2 * near - far : near;
}

/// `steepest`: mm of depth a pixel of the steepest surface.
bool is_mixed_along(const DepthLine& z, int reach, double sigma, double steepest) {
    constexpr double kSigmas = 5;
    const double here = z(0), before = z(-reach), after = z(reach);
    const bool between = (here - before) * (after - here) > 0;
    if (!(before > 0 && after > 0) || !between || std::abs(after - before) <= 2 * reach * steepest + kSigmas * sigma) {
        return false;
    }
    return std::abs(here - drawn_out(z, -reach)) > kSigmas * sigma &&
           std::abs(here - drawn_out(z, reach)) > kSigmas * sigma;
}

bool is_mixed(const GreyImage& image, const CameraModel& camera, double mm_per_unit, double noise, int column,
              int row) {
    constexpr double kSteepest = 5.67;  // tan(80 degrees): depth over breadth of the flattest sight of a surface
    const DepthLine along_row(image, mm_per_unit, column, row, 1, 0),
        along_column(image, mm_per_unit, column, row, 0, 1);
    const double z = along_row(0);
    // Of rounding to whole units, and of the sensor.
    const double sigma = std::hypot(mm_per_unit / std::sqrt(12.0), noise * z * z);
    // Where a step runs slantwise, the neighbour may be mixed as well.
    const auto is_between = [&](int reach) {
        return is_mixed_along(along_row, reach, sigma, kSteepest * z / camera.focal_px.x()) ||
               is_mixed_along(along_column, reach, sigma, kSteepest * z / camera.focal_px.y());
    };
    return is_between(1) || is_between(2);
}

}  // namespace

DepthScan scan_of_depth(const GreyImage& depth, const CameraModel& camera, double mm_per_unit,
                        const Eigen::Isometry3d& base_from_camera) {
    ensure(depth.width == camera.width && depth.height == camera.height, "the image has the camera's size");
    DepthScan result;
    result.noise_per_mm2 = noise_of_depths(depth, mm_per_unit);
    Scan& scan = result.scan;
    const Vector3d sensor = base_from_camera.translation();
    scan.origin_mm = sensor.array().round();  // taking it off is exact
    for (int r = 0; r < depth.height; ++r) {
        for (int c = 0; c < depth.width; ++c) {
            const double z = mm_per_unit * depth.at(c, r);
            const auto direction = z > 0 ? direction_of(camera, {c, r}) : std::nullopt;
            if (!direction) {
                ++result.without_depth;
            } else if (is_mixed(depth, camera, mm_per_unit, result.noise_per_mm2, c, r)) {
                ++result.mixed;
            } else {
                const Vector3d p = base_from_camera * (z * *direction);
                scan.points.push_back((p - scan.origin_mm).cast<float>());
                scan.pixel.push_back(static_cast<std::uint32_t>(r * depth.width + c));
            }
        }
    }
    scan.width = static_cast<std::uint32_t>(depth.width);
    scan.height = static_cast<std::uint32_t>(depth.height);
    scan.sensor_mm = sensor;
    scan.mm_per_unit = mm_per_unit;
    scan.points_in_file = std::uint64_t{scan.width} * scan.height;
    scan.dropped_not_finite = result.without_depth + result.mixed;
    return result;
}

}  // namespace seampath
