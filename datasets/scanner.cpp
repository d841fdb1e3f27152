#include "datasets/scanner.hpp"

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using portable::radians;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Streams of random numbers; those of view v are kPerView * (v + 1) further on.
enum Stream : std::uint64_t { kPlacing = 10, kNoise };
constexpr std::uint64_t kPerView = 100;

/// A pinhole camera that looks at the part, and a projector beside it. Camera axes: x right, y down, z away from the
/// camera.
struct Station {
    Eigen::Isometry3d scene_from_camera;
    Vector3d projector;
    std::uint32_t width, height;
    double focal_x, focal_y, centre_x, centre_y;  // pixels

    /// Direction in the camera's frame with z = 1.
    Vector3d sight(double column, double row) const {
        return {(column - centre_x) / focal_x, (row - centre_y) / focal_y, 1};
    }
};

Vector3d on_sphere(double azimuth, double elevation) {
    const auto [sa, ca] = portable::sincos(azimuth);
    const auto [se, ce] = portable::sincos(elevation);
    return {ce * ca, ce * sa, se};
}

Station make_station(const Scene& scene, const ScannerOptions& o, const Random& placing, int view) {
    const Vector3d target = scene.box.center();
    const double first = placing.uniform(0, 0, 2 * portable::kPi);
    const double azimuth = first + 2 * portable::kPi * (view + placing.uniform(2 * view + 1, -0.1, 0.1)) / o.views;
    const double elevation = radians(o.elevation_deg + placing.uniform(2 * view + 2, -6, 6));
    const Vector3d eye = target + o.working_distance_mm * on_sphere(azimuth, elevation);
    Station station;
    const Vector3d z = (target - eye).normalized();
    const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
    const Vector3d y = z.cross(x);
    station.scene_from_camera = Eigen::Isometry3d::Identity();
    station.scene_from_camera.linear() << x, y, z;
    station.scene_from_camera.translation() = eye;
    const auto [s, c] = portable::sincos(radians(o.triangulation_deg));
    station.projector = target + o.working_distance_mm * (s * x - c * z);
    station.focal_x = o.working_distance_mm / o.pitch_x_mm;
    station.focal_y = o.working_distance_mm / o.pitch_y_mm;
    Eigen::AlignedBox2d picture;
    for (int corner = 0; corner < 8; ++corner) {
        const Vector3d p = station.scene_from_camera.inverse() *
                           scene.box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
        picture.extend(Eigen::Vector2d(station.focal_x * p.x() / p.z(), station.focal_y * p.y() / p.z()));
    }
    station.centre_x = std::ceil(2 - picture.min().x());
    station.centre_y = std::ceil(2 - picture.min().y());
    station.width = static_cast<std::uint32_t>(std::ceil(picture.max().x() + station.centre_x) + 2);
    station.height = static_cast<std::uint32_t>(std::ceil(picture.max().y() + station.centre_y) + 2);
    return station;
}

/// Runs body(row) for each row. Rows must not depend on each other.
void for_rows(std::uint32_t rows, unsigned threads, const std::function<void(std::uint32_t)>& body) {
    std::atomic<std::uint32_t> next{0};
    const auto work = [&] {
        for (std::uint32_t row = next++; row < rows; row = next++) {
            body(row);
        }
    };
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; ++i) {
        others.emplace_back(work);
    }
    work();
}

/// What one pixel truly sees.
struct Sight {
    double depth = kNone;  ///< along the camera's z, mm
    double cosine = 0;     ///< of the angle of incidence
};

/// The first surface on the pixel's ray, unless the projector does not reach it.
Sight look(const Scene& scene, const Station& station, std::uint32_t column, std::uint32_t row) {
    const Vector3d sight = station.sight(column, row);
    const double stretch = sight.norm();
    const Ray ray{station.scene_from_camera.translation(), station.scene_from_camera.linear() * (sight / stretch)};
    const auto hit = first_hit(scene.surfaces, ray);
    if (!hit) {
        return {};
    }
    const Vector3d p = ray.origin + hit->t * ray.direction;
    const Vector3d n = normal(scene.surfaces[hit->surface].shape, p);
    const Vector3d to_point = p - station.projector;
    const double distance = to_point.norm();
    const double kShadowSlack = 1e-3;  // mm; the point itself must not shade itself
    if (n.dot(to_point) >= 0 ||
        first_hit(scene.surfaces, {station.projector, to_point / distance}, distance - kShadowSlack)) {
        return {};
    }
    return {hit->t / stretch, -n.dot(ray.direction)};
}

View take_view(const Scene& scene, const ScannerOptions& o, std::uint64_t seed, int index, unsigned threads) {
    const Station station = make_station(scene, o, Random(seed, kPlacing), index);
    const Random noise(seed, kNoise + kPerView * (static_cast<std::uint64_t>(index) + 1));
    View view{station.width, station.height, {}};
    view.points.assign(std::size_t{view.width} * view.height, Vector3d::Constant(kNone));
    for_rows(view.height, threads, [&](std::uint32_t row) {
        for (std::uint32_t column = 0; column < view.width; ++column) {
            const Sight sight = look(scene, station, column, row);
            if (std::isnan(sight.depth)) {
                continue;
            }
            const std::size_t pixel = std::size_t{row} * view.width + column;
            const double far = sight.depth / o.working_distance_mm;
            const double sigma = o.sigma_mm * far * far / std::max(sight.cosine, 0.2);
            const double depth = sight.depth + sigma * noise.normal(pixel);
            view.points[pixel] = station.scene_from_camera * (depth * station.sight(column, row));
        }
    });
    return view;
}

}  // namespace

std::vector<View> scan_scene(const Scene& scene, const ScannerOptions& options, std::uint64_t seed, unsigned threads) {
    std::vector<View> views;
    for (int i = 0; i < options.views; ++i) {
        views.push_back(take_view(scene, options, seed, i, threads));
    }
    return views;
}

}  // namespace seampath
