#include "datasets/scanner.hpp"

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"
#include "datasets/station.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using portable::radians;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Streams of random numbers; those of view v are kPerView * (v + 1) further on.
enum Stream : std::uint64_t { kPlacing = 10, kScale, kNoise, kDropout, kBlobs, kMixed, kFlying, kGhosts, kPath, kPose };
constexpr std::uint64_t kPerView = 100;

constexpr double kWidestCosine = 0.2;  // noise grows with 1/cos(incidence) up to 1/0.2
constexpr double kSmallestStep = 0.5;  // mm; smaller depth steps mix no pixels
constexpr double kGhostReach = 10;     // mm from the joint
constexpr double kGhostSigma = 0.3;    // mm
constexpr double kMostDropout = 0.95;  // share of missing pixels at grazing incidence

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
    double depth = kNone;  ///< along the sensor's z, mm
    double cosine = 0;     ///< of the angle of incidence
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
    return {hit->t / stretch, -n.dot(ray.direction)};
}

std::vector<double> gaussian_kernel(double sigma) {
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    std::vector<double> kernel;
    double power = 0;
    for (int i = -reach; i <= reach; ++i) {
        kernel.push_back(sigma > 0 ? portable::exp(-i * i / (2 * sigma * sigma)) : 1);
        power += kernel.back() * kernel.back();
    }
    for (double& weight : kernel) {
        weight /= std::sqrt(power);  // independent values of variance 1 keep variance 1
    }
    return kernel;
}

/// Noise of variance 1 for each pixel, white or tied to its neighbours: along the row and, for a picture that is taken
/// at once, down the column.
std::vector<double> noise_field(const ScannerOptions& o, const Station& station, const Random& random,
                                unsigned threads) {
    const std::vector<double> across = gaussian_kernel(o.correlation_px);
    const std::vector<double> down = gaussian_kernel(o.sensor == SensorKind::camera ? o.correlation_px : 0);
    const std::size_t width = station.width;
    const std::size_t white_width = width + across.size() - 1;
    const auto rows = static_cast<std::uint32_t>(station.height + down.size() - 1);
    std::vector<double> blurred(rows * width);
    for_rows(rows, threads, [&](std::uint32_t row) {
        std::vector<double> white(white_width);
        for (std::size_t i = 0; i < white_width; ++i) {
            white[i] = random.normal(row * white_width + i);
        }
        for (std::size_t column = 0; column < width; ++column) {
            double sum = 0;
            for (std::size_t k = 0; k < across.size(); ++k) {
                sum += across[k] * white[column + k];
            }
            blurred[row * width + column] = sum;
        }
    });
    std::vector<double> field(station.height * width);
    for_rows(station.height, threads, [&](std::uint32_t row) {
        for (std::size_t k = 0; k < down.size(); ++k) {
            for (std::size_t column = 0; column < width; ++column) {
                field[row * width + column] += down[k] * blurred[(row + k) * width + column];
            }
        }
    });
    return field;
}

/// Pixels lost in round spots whose diameters are 1 to 5 mm.
std::vector<char> blob_mask(const ScannerOptions& o, const Station& station, const Random& random) {
    const double kMeanArea = portable::kPi * (2.5 * 2.5 * 2.5 - 0.5 * 0.5 * 0.5) / (3 * (2.5 - 0.5));  // mm^2
    const double area = station.width * o.pitch_x_mm * station.height * o.pitch_y_mm;
    const auto spots = static_cast<std::uint64_t>(o.blobs * area / kMeanArea);
    std::vector<char> mask(std::size_t{station.width} * station.height);
    for (std::uint64_t i = 0; i < spots; ++i) {
        const double column = random.uniform(3 * i, 0, station.width);
        const double row = random.uniform(3 * i + 1, 0, station.height);
        const double radius = random.uniform(3 * i + 2, 0.5, 2.5);
        const double reach_x = radius / o.pitch_x_mm;
        const double reach_y = radius / o.pitch_y_mm;
        for (double r = std::max(0.0, std::ceil(row - reach_y)); r <= std::min(station.height - 1.0, row + reach_y);
             ++r) {
            for (double c = std::max(0.0, std::ceil(column - reach_x));
                 c <= std::min(station.width - 1.0, column + reach_x); ++c) {
                const double dx = (c - column) / reach_x;
                const double dy = (r - row) / reach_y;
                if (dx * dx + dy * dy <= 1) {
                    mask[static_cast<std::size_t>(r) * station.width + static_cast<std::size_t>(c)] = 1;
                }
            }
        }
    }
    return mask;
}

/// p0 face on, growing between 60 and 80 degrees of incidence.
double dropout_share(double p0, double cosine) {
    const double t = std::clamp((portable::acos(cosine) - radians(60)) / radians(20), 0.0, 1.0);
    return p0 + std::max(0.0, kMostDropout - p0) * t * t * (3 - 2 * t);
}

/// Error of the robot's path at a row: three waves per axis, each of a third of the amplitude, 20 to 300 mm long.
Vector3d path_error(const ScannerOptions& o, const Random& random, std::uint32_t row) {
    Vector3d error = Vector3d::Zero();
    for (std::uint64_t i = 0; i < 9 && o.path_error_mm > 0; ++i) {
        const double wavelength = random.uniform(2 * i, 20, 300);
        const double phase = random.uniform(2 * i + 1, 0, 2 * portable::kPi);
        error[static_cast<int>(i % 3)] +=
            o.path_error_mm / 3 * portable::sin(phase + 2 * portable::kPi * row * o.pitch_y_mm / wavelength);
    }
    return error;
}

const TruthPoint& nearest_truth(const Truth& truth, const Vector3d& p) {
    const TruthPoint* best = &truth.seams.front().points.front();
    for (const TruthSeam& seam : truth.seams) {
        for (const TruthPoint& point : seam.points) {
            if ((point.p - p).squaredNorm() < (best->p - p).squaredNorm()) {
                best = &point;
            }
        }
    }
    return *best;
}

/// Light that went to the point by way of the other flank: it seems to come from the mirror image of the point in the
/// plane that halves the joint. Points away from the joint stay where they are.
Vector3d ghost(const Truth& truth, const Vector3d& p, const Random& random, std::size_t pixel) {
    const TruthPoint& seam = nearest_truth(truth, p);
    if ((p - seam.p).norm() > kGhostReach) {
        return p;
    }
    const Vector3d across = (seam.n1 - seam.n2).normalized();
    const Vector3d spread(random.normal(4 * pixel + 1), random.normal(4 * pixel + 2), random.normal(4 * pixel + 3));
    return p - 2 * across.dot(p - seam.p) * across + kGhostSigma * spread;
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
class Exposure {
public:
    Exposure(const Scene& scene, const ScannerOptions& o, std::uint64_t seed, int index, unsigned threads)
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
        View view{station_.width, station_.height, {}};
        view.points.assign(sights_.size(), Vector3d::Constant(kNone));
        const Eigen::Affine3d error = view_error(scene_.box.center(), o_, seed_, random(kPose));
        const Random path = random(kPath);
        for_rows(station_.height, threads, [&](std::uint32_t row) {
            const Vector3d eye = station_.eye(row) + path_error(o_, path, row);
            for (std::uint32_t column = 0; column < station_.width; ++column) {
                const std::size_t pixel = std::size_t{row} * station_.width + column;
                const double depth = measured_depth(column, row, pixel);
                if (!std::isnan(depth)) {
                    view.points[pixel] = error * seen_point(eye + depth * station_.sight(column, row), pixel);
                }
            }
        });
        return view;
    }

private:
    Random random(Stream stream) const { return {seed_, stream + kPerView * (view_ + 1)}; }

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

    /// At a depth step a pixel's light may come from both sides of it.
    double mixed_depth(std::uint32_t column, std::uint32_t row, std::size_t pixel) const {
        const double depth = sights_[pixel].depth;
        const Random mixed = random(kMixed);
        if (mixed.uniform(2 * pixel) >= o_.mixed_pixels) {
            return depth;
        }
        const double smallest = std::max(kSmallestStep, 5 * sigma(sights_[pixel]));
        double other = depth;
        const auto look_at = [&](bool exists, std::size_t neighbour) {
            if (exists && std::abs(sights_[neighbour].depth - depth) > std::max(smallest, std::abs(other - depth))) {
                other = sights_[neighbour].depth;
            }
        };
        look_at(column > 0, pixel - 1);
        look_at(column + 1 < station_.width, pixel + 1);
        look_at(row > 0, pixel - station_.width);
        look_at(row + 1 < station_.height, pixel + station_.width);
        return depth + mixed.uniform(2 * pixel + 1) * (other - depth);
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
    return Exposure(scene, options, seed, index, threads).develop(threads);
}

}  // namespace seampath
