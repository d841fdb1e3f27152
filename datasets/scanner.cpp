#include "datasets/scanner.hpp"

#include <cmath>
#include <limits>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"
#include "datasets/rows.hpp"
#include "datasets/sensor_errors.hpp"
#include "datasets/station.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using portable::radians;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Streams of random numbers; those of view v are kPerView * (v + 1) further on.
enum ScanStream : std::uint64_t {
    kPlacing = 10,
    kScale,
    kNoise,
    kDropout,
    kBlobs,
    kMixed,
    kFlying,
    kGhosts,
    kPath,
    kPose
};
constexpr std::uint64_t kPerView = 100;

constexpr double kWidestCosine = 0.2;  // noise grows with 1/cos(incidence) up to 1/0.2
constexpr double kSmallestStep = 0.5;  // mm; smaller depth steps mix no pixels
constexpr double kGhostReach = 10;     // mm from the joint
constexpr double kGhostSigma = 0.3;    // mm

/// What one pixel truly sees.
struct Sight {
    double depth = kNone;  ///< along the sensor's z, mm
    double cosine = 0;     ///< of the angle of incidence
    Eigen::Vector3f normal{0, 0, 0};
};

/// The first surface on the pixel's ray, unless the second eye does not see it.
Sight look(const Scene& scene, const Station& station, std::uint32_t column, std::uint32_t row) {
    const Vector3d sight = station.sight(column, row);
    const double stretch = sight.norm();
    const Ray ray{station.eye(row), sight / stretch};
    const auto hit = first_hit(scene.surfaces, ray);
    if (!hit) {
        return {};
    }
    const Vector3d p = ray.origin + hit->t * ray.direction;
    const Vector3d n = normal(scene.surfaces[hit->surface].shape, p);
    const Vector3d second_eye = station.second_eye(row);
    const Vector3d to_point = p - second_eye;
    const double distance = to_point.norm();
    const double kOwnShade = 1e-3;  // mm; the point itself must not shade itself
    if (n.dot(to_point) >= 0 || first_hit(scene.surfaces, {second_eye, to_point / distance}, distance - kOwnShade)) {
        return {};
    }
    return {hit->t / stretch, -n.dot(ray.direction), n.cast<float>()};
}

/// Flanks that face each other; the tops of a butt joint and the sides of an outer corner send each other no light.
bool is_concave(const TruthSeam& seam) {
    return seam.kind != JointKind::butt && seam.kind != JointKind::corner;
}

/// The point of the concave seams nearest to p; null where there is no such seam.
const TruthPoint* nearest_concave(const Truth& truth, const Vector3d& p) {
    const TruthPoint* best = nullptr;
    for (const TruthSeam& seam : truth.seams) {
        for (const TruthPoint& point : seam.points) {
            if (is_concave(seam) && (!best || (point.p - p).squaredNorm() < (best->p - p).squaredNorm())) {
                best = &point;
            }
        }
    }
    return best;
}

/// Light that went to the point by way of the other flank: it seems to come from the mirror image of the point in the
/// plane that halves the joint. Points away from a concave joint stay where they are.
Vector3d ghost(const Truth& truth, const Vector3d& p, const Random& random, std::size_t pixel) {
    const TruthPoint* seam = nearest_concave(truth, p);
    if (!seam || (p - seam->p).norm() > kGhostReach) {
        return p;
    }
    const Vector3d across = (seam->n1 - seam->n2).normalized();
    const Vector3d spread(random.normal(4 * pixel + 1), random.normal(4 * pixel + 2), random.normal(4 * pixel + 3));
    return p - 2 * across.dot(p - seam->p) * across + kGhostSigma * spread;
}

/// Errors of the whole view: the sensor's scale, and where it thinks that it stands.
Eigen::Affine3d view_error(const Vector3d& centre, const ScannerOptions& o, std::uint64_t seed, const Random& random) {
    const double scale = 1 + o.scale_error * Random(seed, kScale).uniform(0, -1, 1);
    const Vector3d turn = radians(o.registration_deg) * Vector3d(random.normal(0), random.normal(1), random.normal(2));
    const Vector3d shift = o.registration_mm * Vector3d(random.normal(3), random.normal(4), random.normal(5));
    const Eigen::Quaterniond q(1, turn.x() / 2, turn.y() / 2, turn.z() / 2);
    return Eigen::Translation3d(centre + shift) * q.normalized() * Eigen::Scaling(scale) *
           Eigen::Translation3d(-centre);
}

/// One view in the making: what its pixels truly see, and the random numbers that spoil it.
class ViewExposure {
public:
    ViewExposure(const Scene& scene, const ScannerOptions& o, std::uint64_t seed, int index, unsigned threads)
        : scene_(scene),
          o_(o),
          seed_(seed),
          view_(static_cast<std::uint64_t>(index)),
          station_(make_station(scene, o, Random(seed, kPlacing), index)) {
        sights_.resize(std::size_t{station_.width} * station_.height);
        for_rows(station_.height, threads, [&](std::uint32_t row) {
            for (std::uint32_t column = 0; column < station_.width; ++column) {
                sights_[std::size_t{row} * station_.width + column] = look(scene_, station_, column, row);
            }
        });
        noise_ = noise_field(o_, station_, random(kNoise), threads);
        lost_ = blob_mask(o_, station_, random(kBlobs));
    }

    View develop(unsigned threads) const {
        View view{station_.width, station_.height, {}, view_error(scene_.box.center(), o_, seed_, random(kPose))};
        view.points.assign(sights_.size(), Vector3d::Constant(kNone));
        const Random path = random(kPath);
        for_rows(station_.height, threads, [&](std::uint32_t row) {
            const Vector3d eye = station_.eye(row) + path_error(o_, path, row);
            for (std::uint32_t column = 0; column < station_.width; ++column) {
                const std::size_t pixel = std::size_t{row} * station_.width + column;
                const double depth = measured_depth(column, row, pixel);
                if (!std::isnan(depth)) {
                    view.points[pixel] = view.error * seen_point(eye + depth * station_.sight(column, row), pixel);
                }
            }
        });
        return view;
    }

private:
    Random random(ScanStream stream) const { return {seed_, stream + kPerView * (view_ + 1)}; }

    double sigma(const Sight& sight) const {
        const double far = sight.depth / o_.working_distance_mm;
        return o_.sigma_mm * far * far / std::max(sight.cosine, kWidestCosine);
    }

    /// NaN when the pixel measures nothing.
    double measured_depth(std::uint32_t column, std::uint32_t row, std::size_t pixel) const {
        const Sight& sight = sights_[pixel];
        if (std::isnan(sight.depth) || lost_[pixel] ||
            random(kDropout).uniform(pixel) < dropout_share(o_.dropout, sight.cosine)) {
            return kNone;
        }
        const Random flying = random(kFlying);
        if (flying.uniform(2 * pixel) < o_.outliers) {
            return flying.uniform(2 * pixel + 1, station_.nearest, station_.farthest);
        }
        const double u = 2.0 * column / station_.width - 1;
        const double v = 2.0 * row / station_.height - 1;
        const double bow = o_.bow_mm * ((u * u + v * v) / 2 - 1.0 / 3);
        const double along_z = 1 / station_.sight(column, row).norm();
        double depth = mixed_depth(column, row, pixel) + bow + along_z * sigma(sight) * noise_[pixel];
        if (o_.quantisation_mm > 0) {
            depth = std::floor(depth / o_.quantisation_mm + 0.5) * o_.quantisation_mm;
        }
        return depth;
    }

    /// At a depth step a pixel's light may come from both sides of it: of its neighbours across a step, the one that
    /// differs most takes part.
    double mixed_depth(std::uint32_t column, std::uint32_t row, std::size_t pixel) const {
        const double depth = sights_[pixel].depth;
        const Random mixed = random(kMixed);
        if (mixed.uniform(2 * pixel) >= o_.mixed_pixels) {
            return depth;
        }
        double other = depth;
        const auto look_at = [&](int right, int down) {
            const std::uint32_t c = column + static_cast<std::uint32_t>(right);
            const std::uint32_t r = row + static_cast<std::uint32_t>(down);
            if (c >= station_.width || r >= station_.height) {
                return;  // beyond the border; -1 has become the largest number
            }
            const double there = sights_[std::size_t{r} * station_.width + c].depth;
            if (std::abs(there - depth) > std::abs(other - depth) && is_step(column, row, c, r)) {
                other = there;
            }
        };
        look_at(-1, 0);
        look_at(1, 0);
        look_at(0, -1);
        look_at(0, 1);
        return depth + mixed.uniform(2 * pixel + 1) * (other - depth);
    }

    /// Neither pixel lies where the other's tangent plane would put it: not one slanted surface, nor a crease.
    bool is_step(std::uint32_t column, std::uint32_t row, std::uint32_t other_column, std::uint32_t other_row) const {
        const double smallest = std::max(kSmallestStep, 5 * sigma(sight_at(column, row)));
        return off_plane(column, row, other_column, other_row) > smallest &&
               off_plane(other_column, other_row, column, row) > smallest;
    }

    /// How far, in depth, the second pixel's point is from the tangent plane of the first's.
    double off_plane(std::uint32_t column, std::uint32_t row, std::uint32_t other_column,
                     std::uint32_t other_row) const {
        const Sight& sight = sight_at(column, row);
        const Vector3d n = sight.normal.cast<double>();
        const Vector3d p = station_.eye(row) + sight.depth * station_.sight(column, row);
        const double depth = n.dot(p - station_.eye(other_row)) / n.dot(station_.sight(other_column, other_row));
        return std::abs(sight_at(other_column, other_row).depth - depth);
    }

    const Sight& sight_at(std::uint32_t column, std::uint32_t row) const {
        return sights_[std::size_t{row} * station_.width + column];
    }

    Vector3d seen_point(const Vector3d& p, std::size_t pixel) const {
        const Random ghosts = random(kGhosts);
        return ghosts.uniform(8 * pixel) < o_.ghosts ? ghost(scene_.truth, p, ghosts, pixel) : p;
    }

    const Scene& scene_;
    const ScannerOptions& o_;
    std::uint64_t seed_;
    std::uint64_t view_;
    Station station_;
    std::vector<Sight> sights_;
    std::vector<double> noise_;
    std::vector<char> lost_;
};

}  // namespace

View take_view(const Scene& scene, const ScannerOptions& options, std::uint64_t seed, int index, unsigned threads) {
    return ViewExposure(scene, options, seed, index, threads).develop(threads);
}

}  // namespace seampath
