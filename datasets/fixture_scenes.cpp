#include "datasets/fixture_scenes.hpp"

#include <cmath>

#include "datasets/board_pictures.hpp"
#include "datasets/fixture_draws.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

enum FixtureStream : std::uint64_t {
    kFixturePose = 900,
    kFixtureBalls,
    kFixtureClutter,
    kFixtureMoved,
    kFixtureTouch,
    kFixtureSeams,
    kFixtureBoard,
    kFixtureProbed
};

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

TouchedPart make_touched_part(std::uint64_t seed, double sigma_mm) {
    Draws placing(seed, kFixturePose), draws(seed, kFixtureTouch);
    TouchedPart part;
    part.base_from_part = placing.pose(800);
    const auto touched = [&](const Vector3d& q) {
        const double x = draws.normal(), y = draws.normal(), z = draws.normal();
        return Vector3d(part.base_from_part * q + sigma_mm * Vector3d(x, y, z));
    };
    for (const Vector3d& q : {Vector3d(0, 0, 0), Vector3d(400, 0, 30), Vector3d(30, 290, 5), Vector3d(370, 240, 130)}) {
        part.points.push_back({q, touched(q), sigma_mm * sigma_mm * Eigen::Matrix3d::Identity()});
    }
    const auto plane = [&](const char* name, const Vector3d& normal, const std::vector<Vector3d>& places) {
        part.planes.push_back({name, normal, 0, {}});
        for (const Vector3d& q : places) {
            part.planes.back().touched.push_back({q, touched(q), sigma_mm});
        }
    };
    plane("A", {0, 0, 1}, {{20, 20, 0}, {380, 30, 0}, {150, 260, 0}, {350, 240, 0}});
    plane("B", {0, 1, 0}, {{30, 0, 20}, {370, 0, 50}});
    plane("C", {1, 0, 0}, {{0, 120, 30}});
    return part;
}

ProbedPart make_probed_part(std::uint64_t seed, double sigma_mm) {
    Draws placing(seed, kFixturePose), draws(seed, kFixtureProbed);
    ProbedPart part;
    part.base_from_part = placing.pose(800);
    Isometry3d off = Isometry3d::Identity();
    off.linear() = Eigen::AngleAxisd(portable::radians(draws.uniform(-2, 2)), draws.direction()).toRotationMatrix();
    off.translation() = draws.uniform(0, 4) * draws.direction();
    part.near = part.base_from_part * off;
    const Vector3d sight = Vector3d(-1, -1.2, -1.6).normalized();
    Exposure exposure(part.base_from_part, part.base_from_part.translation(), sigma_mm);
    for (int i = 0; i < 60000; ++i) {
        exposure.add({draws.uniform(0, 200), draws.uniform(0, 150), 0}, sight, draws);
    }
    for (int i = 0; i < 20000; ++i) {
        exposure.add({draws.uniform(0, 200), 0, draws.uniform(0, 60)}, sight, draws);
        exposure.add({0, draws.uniform(0, 150), draws.uniform(0, 60)}, sight, draws);
    }
    for (int i = 0; i < 6000; ++i) {  // a block on the first plane, a step on the second, and strays
        exposure.add({draws.uniform(80, 120), draws.uniform(60, 100), 25}, sight, draws);
        exposure.add({draws.uniform(90, 110), 4, draws.uniform(20, 40)}, sight, draws);
        if (i % 10 == 0) {
            exposure.add({draws.uniform(0, 200), draws.uniform(0, 150), draws.uniform(0, 60)}, sight, draws);
        }
    }
    part.scan = std::move(exposure).scan();
    const auto plane = [&](const char* name, const Vector3d& normal, const std::vector<Vector3d>& places) {
        part.planes.push_back({name, normal, 0, {}});
        for (const Vector3d& q : places) {
            part.planes.back().touched.push_back({q, Vector3d::Zero(), 0});
        }
    };
    plane("A", {0, 0, 1}, {{20, 20, 0}, {180, 25, 0}, {30, 130, 0}, {170, 125, 0}});
    plane("B", {0, 1, 0}, {{20, 0, 30}, {180, 0, 35}});
    plane("C", {1, 0, 0}, {{0, 80, 30}});
    return part;
}

SeenBoard make_seen_board(std::uint64_t seed, double sigma_px) {
    Draws placing(seed, kFixturePose), draws(seed, kFixtureBoard);
    const Board board{BoardKind::chessboard, 11, 8, 15, 0, 0};
    SeenBoard made;
    made.camera = {1280, 960, {1500, 1497}, {642.5, 476}, {-0.12, 0.08, 0.0004, -0.0003, 0}};
    made.part_from_board = placing.pose(200);
    const Isometry3d place = board_places(board, made.camera, 1, 40, seed).front();
    made.camera_from_part = place * made.part_from_board.inverse();
    for (const Eigen::Vector2d& p : points_of(board)) {
        const double x = draws.normal(), y = draws.normal();
        made.points.push_back(
            {p, pixel_of(made.camera, place * Vector3d(p.x(), p.y(), 0)) + sigma_px * Eigen::Vector2d(x, y)});
    }
    return made;
}

SeamScene::SeamScene()
    : seams{{"A", false, {{0, 0, 0}, {180, 0, 0}}}, {"B", false, {{0, 40, 0}, {0, 120, 60}}}, {"C", false, {}}} {
    for (int i = 0; i <= 400; ++i) {
        const double a = 0.3 + 3.6 * i / 400;
        seams[2].points.emplace_back(120 + 45 * portable::cos(a), 90 + 45 * portable::sin(a), 20);
    }
}

MeasuredSeams make_measured_seams(const SeamScene& scene, std::uint64_t seed) {
    Draws placing(seed, kFixturePose), draws(seed, kFixtureSeams);
    MeasuredSeams made;
    made.base_from_part = placing.pose(800);
    for (const NominalSeam& seam : scene.seams) {
        std::vector<MeasuredSeamPoint> points;
        for (std::size_t i = 0; i + 1 < seam.points.size(); ++i) {
            const Vector3d a = seam.points[i], d = seam.points[i + 1] - a;
            const Vector3d e0 = d.normalized().unitOrthogonal(), e1 = d.normalized().cross(e0);
            const int steps = std::max(1, static_cast<int>(d.norm()));
            for (int k = 0; k < steps; ++k) {
                const double across = draws.normal(), up = draws.normal();
                const Vector3d p = a + d * k / steps + scene.sigma_mm * (across * e0 + up * e1);
                points.push_back({made.base_from_part * p, scene.sigma_mm});
            }
        }
        const auto cut = static_cast<std::ptrdiff_t>(points.size() / 20);
        made.seams.emplace_back(points.begin() + cut, points.end() - cut);
    }
    return made;
}

}  // namespace seampath
