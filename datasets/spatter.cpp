#include <cmath>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"
#include "datasets/scene_parts.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

enum SpatterStream : std::uint64_t { kBalls = 3, kTacks = 4 };  // of spatter_seed

constexpr double kSmallestRadius = 0.15;  // mm
constexpr double kLargestRadius = 1.5;    // mm
constexpr double kReach = 25;             // mm from the seam to either side
constexpr double kFlight = 100;           // mm, from where balls come down on the joint

double length(const TruthSeam& seam) {
    return (seam.points.size() - 1) * (seam.points[1].p - seam.points[0].p).norm();
}

void add_ball(Scene& scene, const Vector3d& centre, double radius) {
    add_solid(scene, {SphereShape{centre, radius}});
    scene.box.extend(Vector3d(centre - Vector3d::Constant(radius)));
    scene.box.extend(Vector3d(centre + Vector3d::Constant(radius)));
}

/// Where something that comes down on the joint, `across` from the seam, lands.
std::optional<std::pair<Vector3d, Vector3d>> landing(const Scene& bare, const TruthPoint& at, double across) {
    const Vector3d up = (at.n1 + at.n2).normalized();
    const Ray fall{at.p + across * up.cross(at.tangent) + kFlight * up, -up};
    const auto hit = first_hit(bare.surfaces, fall, 2 * kFlight);
    if (!hit) {
        return std::nullopt;
    }
    const Vector3d p = fall.origin + hit->t * fall.direction;
    return std::pair(p, normal(bare.surfaces[hit->surface].shape, p));
}

/// Between half sunk and lying on the surface, dense near the seam.
void add_balls(Scene& scene, const Scene& bare, const TruthSeam& seam, double per_100mm, const Random& random,
               std::uint64_t& draw) {
    const int balls = static_cast<int>(std::floor(per_100mm * length(seam) / 100 + 0.5));
    for (int i = 0; i < balls; ++i) {
        const auto n = static_cast<double>(seam.points.size());
        const TruthPoint& at = seam.points[static_cast<std::size_t>(random.uniform(draw) * n)];
        const double spread = random.uniform(draw + 1, -1, 1);
        const double radius = random.uniform(draw + 2, kSmallestRadius, kLargestRadius);
        const double height = random.uniform(draw + 3, 0, 1) * radius;
        draw += 4;
        if (const auto place = landing(bare, at, kReach * spread * std::abs(spread))) {
            add_ball(scene, place->first + height * place->second, radius);
        }
    }
}

/// Short round beads with round ends, on the seam and so wide that they reach `leg` along either flank.
void add_tacks(Scene& scene, const TruthSeam& seam, const SceneOptions& o, const Random& random, std::uint64_t& draw) {
    const double leg = *o.tack_leg_mm;
    const double step = length(seam) / static_cast<double>(seam.points.size() - 1);
    const double half = *o.tack_length_mm / 2;
    const int tacks = static_cast<int>(std::floor(length(seam) / *o.tack_spacing_mm + 0.5));
    for (int i = 0; i < tacks; ++i) {
        const double station = (i + 0.5) * length(seam) / tacks + random.uniform(draw++, -1, 1) * half;
        const auto index = static_cast<std::size_t>(station / step);
        if (station - half - leg < 0 || station + half + leg > length(seam)) {
            continue;  // it would stand out beyond the part
        }
        const TruthPoint& at = seam.points[index];
        const Vector3d begin = at.p - half * at.tangent;
        add_bar(scene, {begin, at.tangent, leg}, 2 * half);
        add_ball(scene, begin, leg);
        add_ball(scene, begin + 2 * half * at.tangent, leg);
    }
}

}  // namespace

void add_spatter(Scene& scene, const SceneOptions& o) {
    const Scene bare = scene;
    const auto seed = static_cast<std::uint64_t>(o.spatter_seed);
    std::uint64_t ball = 0;
    std::uint64_t tack = 0;
    for (const TruthSeam& seam : bare.truth.seams) {
        add_balls(scene, bare, seam, *o.spatter_per_100mm, Random(seed, kBalls), ball);
        add_tacks(scene, seam, o, Random(seed, kTacks), tack);
    }
}

}  // namespace seampath
