#include "datasets/photo_picture.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

enum PhotoStream : std::uint64_t { kGrains = 70, kRust, kTackPlaces, kHolePlaces, kShine, kPhotoNoise };

/// Smooth noise of about mean 0, variance 1, and one length: normal numbers on a lattice, blended bilinearly.
double lattice_noise(const Random& random, const Vector2d& p, double length) {
    const double u = p.x() / length + 1000, v = p.y() / length + 1000;  // never below 0
    const double c = std::floor(u), r = std::floor(v), x = u - c, y = v - r;
    const auto at = [&](double column, double row) {
        return random.normal(static_cast<std::uint64_t>(row) * 65536 + static_cast<std::uint64_t>(column));
    };
    const double wx[2] = {1 - x, x}, wy[2] = {1 - y, y};
    double sum = 0, squares = 0;
    for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
            sum += wx[i] * wy[j] * at(c + i, r + j);
            squares += wx[i] * wy[j] * wx[i] * wy[j];
        }
    }
    return sum / std::sqrt(squares);
}

/// Distance from the course, positive to its right.
double signed_distance(const std::vector<Vector2d>& course, const Vector2d& p) {
    double nearest = INFINITY, side = 1;
    for (std::size_t i = 0; i + 1 < course.size(); ++i) {
        const Vector2d along = course[i + 1] - course[i], from = p - course[i];
        const double x = std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0);
        const double d2 = (from - x * along).squaredNorm();
        if (d2 < nearest) {
            nearest = d2;
            side = along.x() * from.y() - along.y() * from.x() > 0 ? 1 : -1;
        }
    }
    return side * std::sqrt(nearest);
}

/// A round thing on the picture.
struct Spot {
    Vector2d middle;
    double radius = 0;
};

/// So many at random places of the course, each in its own part of it.
std::vector<Spot> spots_on(const PhotoPicture& picture, int count, double radius, const Random& random) {
    std::vector<Spot> spots;
    for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::uint64_t>(i);
        const double share = (i + random.uniform(3 * k, 0.3, 0.7)) / count;
        const double at = share * static_cast<double>(picture.course.size() - 1);
        const auto piece = std::min(static_cast<std::size_t>(at), picture.course.size() - 2);
        const double x = at - static_cast<double>(piece);
        const Vector2d p = (1 - x) * picture.course[piece] + x * picture.course[piece + 1];
        const double size = radius * random.uniform(3 * k + 1, 0.67, 1.33);
        spots.push_back({p + Vector2d(size * random.uniform(3 * k + 2, -0.4, 0.4), 0.2 * size), size});
    }
    return spots;
}

std::vector<Spot> spots_anywhere(const PhotoPicture& picture, int count, double radius, const Random& random) {
    std::vector<Spot> spots;
    for (int i = 0; i < count; ++i) {
        const auto k = 2 * static_cast<std::uint64_t>(i);
        spots.push_back({{picture.width * random.uniform(k), picture.height * random.uniform(k + 1)}, radius});
    }
    return spots;
}

/// The sheets and what lies on them, before lens and sensor.
class FlatJoint {
public:
    FlatJoint(const PhotoPicture& picture, const PhotoNoise& noise, std::uint64_t seed)
        : picture_(picture),
          noise_(noise),
          grains_(seed, kGrains),
          rust_(seed, kRust),
          tacks_(spots_on(picture, noise.tacks, noise.spot_px, Random(seed, kTackPlaces))),
          holes_(spots_on(picture, noise.holes, noise.spot_px, Random(seed, kHolePlaces))),
          shine_(spots_anywhere(picture, noise.highlights, noise.highlight_px, Random(seed, kShine))) {}

    double grey(const Vector2d& p) const {
        const double off = signed_distance(picture_.course, p);
        const double sheet = surface(p) * picture_.sheet_grey[off > 0 ? 0 : 1];
        const double gap = std::clamp(0.5 * picture_.gap_px + 0.5 - std::abs(off), 0.0, 1.0);
        double grey = (1 - gap) * sheet + gap * picture_.gap_grey;
        for (const Spot& tack : tacks_) {
            const double cover = cover_of(tack, p),
                         rings = std::abs(portable::sincos(0.9 * (p - tack.middle).norm()).sin);
            grey += cover * (60 + 180 * rings * rings - grey);
        }
        for (const Spot& hole : holes_) {
            grey += cover_of(hole, p) * (10 - grey);
        }
        return lit(p) * grey + glare(p);
    }

private:
    /// Of the sheets, 1 on average.
    double surface(const Vector2d& p) const {
        double grain = 0;
        int octaves = 0;
        for (double length = 2; length <= 32; length *= 2, ++octaves) {
            grain += lattice_noise(grains_, p, length);
        }
        // Patches: where smooth noise of two lengths is high. 1.2 sigmas a unit of share about one half.
        const double patch = 0.8 * lattice_noise(rust_, p, 40) + 0.6 * lattice_noise(rust_, p, 9);
        const double rusty = std::clamp(4 * (patch - 2.5 * (0.5 - noise_.rust)), 0.0, 1.0);
        return (1 + noise_.texture * grain / std::sqrt(octaves)) * (noise_.rust > 0 ? 1 - rusty / 3 : 1);
    }

    double lit(const Vector2d& p) const {
        return 1 - noise_.shade * 0.5 * (p.x() / picture_.width + p.y() / picture_.height);
    }

    double glare(const Vector2d& p) const {
        double sum = 0;
        for (const Spot& spot : shine_) {
            sum += 400 * portable::exp(-0.5 * (p - spot.middle).squaredNorm() / (spot.radius * spot.radius));
        }
        return sum;
    }

    static double cover_of(const Spot& spot, const Vector2d& p) {
        return std::clamp(spot.radius - (p - spot.middle).norm() + 0.5, 0.0, 1.0);
    }

    const PhotoPicture& picture_;
    const PhotoNoise& noise_;
    Random grains_, rust_;
    std::vector<Spot> tacks_, holes_, shine_;
};

/// A Gaussian along rows or along columns.
GreyImage blurred(const GreyImage& image, double sigma, bool along_rows) {
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    std::vector<double> weight;
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) {
        weight.push_back(sigma > 0 ? portable::exp(-0.5 * i * i / (sigma * sigma)) : 1);
        sum += weight.back();
    }
    GreyImage result{image.width, image.height, image.white, {}};
    for (int r = 0; r < image.height; ++r) {
        for (int c = 0; c < image.width; ++c) {
            double grey = 0;
            for (int i = -reach; i <= reach; ++i) {
                grey += weight.begin()[i + reach] *
                        static_cast<double>(along_rows ? image.clamped(c + i, r) : image.clamped(c, r + i));
            }
            result.value.push_back(static_cast<float>(grey / sum));
        }
    }
    return result;
}

}  // namespace

GreyImage draw_photo(const PhotoPicture& picture, const PhotoNoise& noise, std::uint64_t seed) {
    const FlatJoint joint(picture, noise, seed);
    GreyImage sharp{picture.width, picture.height, 255, {}};
    for (int r = 0; r < picture.height; ++r) {
        for (int c = 0; c < picture.width; ++c) {
            sharp.value.push_back(static_cast<float>(joint.grey(Vector2d(c, r))));
        }
    }
    GreyImage image = blurred(blurred(sharp, noise.blur_px, true), noise.blur_px, false);
    const Random pixels(seed, kPhotoNoise);
    for (std::size_t i = 0; i < image.value.size(); ++i) {
        const double grey = static_cast<double>(image.value[i]) + noise.sigma * pixels.normal(i);
        image.value[i] = static_cast<float>(std::clamp(std::floor(grey + 0.5), 0.0, 255.0));
    }
    return image;
}

}  // namespace seampath
