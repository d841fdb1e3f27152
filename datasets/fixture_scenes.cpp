#include "datasets/fixture_scenes.hpp"

#include <cmath>

#include "datasets/fixture_draws.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

enum FixtureStream : std::uint64_t { kFixturePose = 900, kFixtureBalls, kFixtureClutter, kFixtureMoved };

/// A scan in the making, seen along `sight` (unit, away from the sensor).
class Exposure {
public:
    Exposure(const Isometry3d& base_from_part, const Vector3d& origin, double sigma)
        : T_(base_from_part), origin_(origin), sigma_(sigma) {}

    /// A point of the part's frame, with noise along the line of sight.
    void add(const Vector3d& in_part, const Vector3d& sight, Draws& draws) {
        const Vector3d p = T_ * (in_part + sigma_ * draws.normal() * sight);
        points_.push_back((p - origin_).cast<float>());
    }

    /// The cap of a ball that faces the sensor.
    void add_cap(const Vector3d& centre, double radius, double cap, int count, const Vector3d& sight, Draws& draws) {
        const Vector3d up = -sight, e0 = up.unitOrthogonal(), e1 = up.cross(e0);
        for (int i = 0; i < count; ++i) {
            const double z = draws.uniform(std::cos(cap), 1), a = draws.uniform(0, 2 * portable::kPi);
            const double s = std::sqrt(1 - z * z);
            add(centre + radius * (s * std::cos(a) * e0 + s * std::sin(a) * e1 + z * up), sight, draws);
        }
    }

    Scan scan() && {
        Scan scan;
        scan.name = "fixture";
        scan.format = "made";
        scan.unit_reason = "made in mm";
        scan.origin_mm = origin_;
        scan.points = std::move(points_);
        scan.points_in_file = scan.points.size();
        return scan;
    }

private:
    Isometry3d T_;
    Vector3d origin_;
    double sigma_;
    std::vector<Eigen::Vector3f> points_;
};

/// Plate, stems, pipes, blocks and balls of other sizes about the balls.
void add_ball_clutter(Exposure& exposure, const BallScene& scene, const Vector3d& sight, Draws& draws) {
    const double radius = scene.diameter_mm / 2;
    const int share = scene.clutter / 6;
    for (int i = 0; i < 2 * share; ++i) {  // plate
        exposure.add({draws.uniform(-80, 480), draws.uniform(-80, 380), 0}, sight, draws);
    }
    for (const NamedPoint& ball : scene.balls) {  // stems, as thick as half a ball
        for (int i = 0; i < share / static_cast<int>(scene.balls.size()); ++i) {
            const double a = draws.uniform(0, 2 * portable::kPi);
            const Vector3d side(std::cos(a), std::sin(a), 0);
            if (side.dot(sight) < 0) {
                exposure.add({ball.p.x() + radius / 2 * side.x(), ball.p.y() + radius / 2 * side.y(),
                              draws.uniform(0, ball.p.z() - radius)},
                             sight, draws);
            }
        }
    }
    for (int k = 0; k < 3; ++k) {  // pipes of the balls' own radius, and of others
        const double r = radius * (0.8 + 0.2 * k), x = 120 + 70 * k;
        for (int i = 0; i < share / 3; ++i) {
            const double a = draws.uniform(0, 2 * portable::kPi);
            const Vector3d side(std::cos(a), 0, std::sin(a));
            if (side.dot(sight) < 0) {
                exposure.add(Vector3d(x, draws.uniform(20, 280), 30) + r * side, sight, draws);
            }
        }
    }
    for (int k = 0; k < 4; ++k) {  // balls of other sizes
        exposure.add_cap({60.0 + 80 * k, 330, 25}, radius * (k < 2 ? 0.6 + 0.15 * k : 1 + 0.15 * k), 1.2, share / 8,
                         sight, draws);
    }
    for (int i = 0; i < share / 2; ++i) {  // a block's two faces
        const bool top = i % 2 == 0;
        exposure.add(
            {draws.uniform(200, 260), draws.uniform(120, top ? 180 : 120.001), top ? 35 : draws.uniform(0, 35)}, sight,
            draws);
    }
    for (int i = 0; i < share / 20; ++i) {  // strays
        exposure.add({draws.uniform(-100, 500), draws.uniform(-100, 400), draws.uniform(0, 250)}, sight, draws);
    }
}

}  // namespace

FixtureScan make_ball_scan(const BallScene& scene, std::uint64_t seed) {
    Draws placing(seed, kFixturePose), balls(seed, kFixtureBalls), clutter(seed, kFixtureClutter),
        moving(seed, kFixtureMoved);
    FixtureScan made;
    made.base_from_part = placing.pose(800);
    const Vector3d sight = (Vector3d(0, 0, -1) + 0.3 * placing.direction()).normalized();
    const Vector3d shift = scene.moved_mm * moving.direction();
    Exposure exposure(made.base_from_part, made.base_from_part.translation(), scene.sigma_mm);
    for (const NamedPoint& ball : scene.balls) {
        Vector3d centre = ball.p + (ball.name == scene.moved ? shift : Vector3d::Zero());
        if (scene.mirrored) {
            centre.x() = -centre.x();
        }
        exposure.add_cap(centre, scene.diameter_mm / 2, portable::radians(scene.cap_deg), scene.points_per_ball, sight,
                         balls);
    }
    add_ball_clutter(exposure, scene, sight, clutter);
    made.scan = std::move(exposure).scan();
    return made;
}

}  // namespace seampath
