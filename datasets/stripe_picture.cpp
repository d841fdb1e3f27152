#include "datasets/stripe_picture.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

enum StripeStream : std::uint64_t { kPixelNoise = 50, kSpeckle, kColumnLoss };

constexpr double kStripeReach = 4;  // 1-sigmas: beyond, a Gaussian is a tenth of a grey value
constexpr double kFwhm = 2.354820;  // of a Gaussian: 2 sqrt(2 log 2)

double squared_distance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
    const Vector2d along = b - a;
    const double length2 = along.squaredNorm();
    const double x = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0;
    return (p - a - x * along).squaredNorm();
}

/// Nearly normal, mean 0, variance 1: the sum of four uniform numbers (Irwin and Hall), which one hash gives. A picture
/// has many pixels.
double quick_normal(std::uint64_t bits) {
    constexpr double kSigma = 0.57735026918962576;  // sqrt(4 / 12)
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
        sum += (static_cast<double>((bits >> (16 * i)) & 0xffff) + 0.5) * 0x1p-16 - 0.5;
    }
    return sum / kSigma;
}

/// One number a pixel.
class Plane2d {
public:
    Plane2d(int width, int height, double value)
        : width_(width), value_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}
    double& at(int column, int row) {
        return value_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(column)];
    }

private:
    int width_;
    std::vector<double> value_;
};

/// Squared distance of each pixel from the nearest course that is moved down by `offset`; infinite where none is near.
Plane2d distances(const StripePicture& picture, double offset, double reach) {
    Plane2d nearest(picture.width, picture.height, INFINITY);
    const Vector2d down(0, offset);
    for (const auto& course : picture.courses) {
        for (std::size_t i = 0; i + 1 < course.size(); ++i) {
            const Vector2d a = course[i] + down, b = course[i + 1] + down;
            const auto low = [&](double v) { return std::max(0, static_cast<int>(std::floor(v - reach))); };
            const auto high = [&](double v, int size) {
                return std::min(size - 1, static_cast<int>(std::ceil(v + reach)));
            };
            for (int row = low(std::min(a.y(), b.y())); row <= high(std::max(a.y(), b.y()), picture.height); ++row) {
                for (int c = low(std::min(a.x(), b.x())); c <= high(std::max(a.x(), b.x()), picture.width); ++c) {
                    double& d2 = nearest.at(c, row);
                    d2 = std::min(d2, squared_distance(Vector2d(c, row), a, b));
                }
            }
        }
    }
    return nearest;
}

}  // namespace

GreyImage draw_stripes(const StripePicture& picture, const StripeNoise& noise, std::uint64_t seed) {
    const double sigma = picture.width_px / kFwhm, reach = kStripeReach * sigma;
    Plane2d stripe = distances(picture, 0, reach);
    Plane2d halo(0, 0, 0);
    if (noise.halo > 0) {
        halo = distances(picture, noise.halo_offset_px, reach);
    }
    const Random pixels(seed, kPixelNoise), grains(seed, kSpeckle), columns(seed, kColumnLoss);
    GreyImage image{picture.width, picture.height, 255, {}};
    for (int row = 0; row < picture.height; ++row) {
        for (int c = 0; c < picture.width; ++c) {
            const auto i = static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(picture.width) +
                           static_cast<std::uint64_t>(c);
            const auto grain = static_cast<std::uint64_t>(row / 2) * 65536 + static_cast<std::uint64_t>(c / 2);
            const auto light = [&](double d2) {
                return d2 < INFINITY ? portable::exp(-0.5 * d2 / (sigma * sigma)) : 0;
            };
            double lit = light(stripe.at(c, row));
            lit += noise.halo > 0 ? noise.halo * light(halo.at(c, row)) : 0;
            lit *=
                noise.speckle > 0 && lit > 0 ? std::max(0.0, 1 + noise.speckle * quick_normal(grains.bits(grain))) : 1;
            lit *= columns.uniform(static_cast<std::uint64_t>(c / 8)) < noise.dropout ? 0 : 1;
            const double far = (Vector2d(c, row) - noise.glow_at).norm() / noise.glow_radius_px;
            const double glow = noise.glow > 0 ? noise.glow * portable::exp(-0.5 * far * far) : 0;
            const double grey = noise.exposure * (picture.ground + picture.peak * lit + glow);
            const double noisy = grey + noise.sigma * quick_normal(pixels.bits(i));
            image.value.push_back(static_cast<float>(std::clamp(std::floor(noisy + 0.5), 0.0, 255.0)));
        }
    }
    return image;
}

}  // namespace seampath
