#include "datasets/station.hpp"

#include <cmath>
#include <limits>

#include "datasets/portable_math.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using portable::radians;

constexpr double kAzimuthJitter = 8;    // deg; an operator does not measure where he puts the sensor
constexpr double kElevationJitter = 4;  // deg
constexpr double kBorder = 2;           // pixels around the part
constexpr double kMostPixels = 1e8;     // of one view; each takes about 60 bytes in the making

/// Direction from the part to the sensor.
Vector3d draw_direction(const Scene& scene, const ScannerOptions& o, const Random& placing, int index) {
    const std::uint64_t draw = 2 * static_cast<std::uint64_t>(index);
    // The first station has the middle between its two eyes before the joint.
    const double azimuth = 2 * portable::kPi * index / o.views +
                           radians(placing.uniform(draw, -kAzimuthJitter, kAzimuthJitter) - o.triangulation_deg / 2);
    const auto [sa, ca] = portable::sincos(azimuth);
    const auto [se, ce] =
        portable::sincos(radians(o.elevation_deg + placing.uniform(draw + 1, -kElevationJitter, kElevationJitter)));
    const Vector3d left = Vector3d::UnitZ().cross(scene.front);
    return ce * (ca * scene.front + sa * left) + se * Vector3d::UnitZ();
}

/// Sets the raster so that the box around the part lies within it.
void frame_part(Station& station, const Eigen::AlignedBox3d& box, bool moves, double pitch_y) {
    const Eigen::Isometry3d sensor_from_scene = station.scene_from_sensor.inverse();
    Eigen::AlignedBox2d picture;
    station.nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 8; ++i) {
        const Vector3d p = sensor_from_scene * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
        const double row = moves ? p.y() / pitch_y : station.focal_y * p.y() / p.z();
        picture.extend(Eigen::Vector2d(station.focal_x * p.x() / p.z(), row));
        station.nearest = std::min(station.nearest, p.z());
        station.farthest = std::max(station.farthest, p.z());
    }
    if (!(station.nearest > 0)) {
        throw InputError("dataset: the part reaches the sensor; make working_distance_mm larger than the part");
    }
    const Eigen::Vector2d size = picture.sizes();
    if (!(size.x() * size.y() < kMostPixels)) {
        throw InputError(
            "dataset: a view would have more than 100 million pixels; make pitch_x_mm and pitch_y_mm larger");
    }
    station.centre_x = std::ceil(kBorder - picture.min().x());
    station.centre_y = std::ceil(kBorder - picture.min().y());
    station.width = static_cast<std::uint32_t>(std::ceil(picture.max().x() + station.centre_x + kBorder));
    station.height = static_cast<std::uint32_t>(std::ceil(picture.max().y() + station.centre_y + kBorder));
}

}  // namespace

Station make_station(const Scene& scene, const ScannerOptions& o, const Random& placing, int index) {
    const bool moves = o.sensor == SensorKind::profile;
    const Vector3d target = scene.box.center();
    const Vector3d z = -draw_direction(scene, o, placing, index);
    const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
    const Vector3d y = z.cross(x);
    Station station;
    station.scene_from_sensor.linear() << x, y, z;
    station.scene_from_sensor.translation() = target - o.working_distance_mm * z;
    const auto [s, c] = portable::sincos(radians(o.triangulation_deg));
    station.other_eye = target + o.working_distance_mm * (s * (moves ? -y : x) - c * z);
    station.focal_x = o.working_distance_mm / o.pitch_x_mm;
    station.focal_y = moves ? std::numeric_limits<double>::infinity() : o.working_distance_mm / o.pitch_y_mm;
    frame_part(station, scene.box, moves, o.pitch_y_mm);
    if (moves) {
        station.row_step = o.pitch_y_mm * y;
        station.scene_from_sensor.translation() -= station.centre_y * station.row_step;
        station.other_eye -= station.centre_y * station.row_step;
    }
    return station;
}

}  // namespace seampath
