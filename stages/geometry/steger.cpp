#include "stages/geometry/steger.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seampath {
namespace {

using Eigen::Vector2d;

struct GreyDerivatives {
    double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
};

GreyDerivatives grey_derivatives(const GreyImage& image, const RidgeKernel& k, int column, int row) {
    GreyDerivatives d;
    const std::size_t n = k.g.size();
    const int left = column - k.radius, top = row - k.radius;
    const bool inside = left >= 0 && column + k.radius < image.width;
    for (std::size_t j = 0; j < n; ++j) {
        const int r = std::clamp(top + static_cast<int>(j), 0, image.height - 1);
        const float* line = image.value.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(image.width);
        double s = 0, s1 = 0, s2 = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const int c = left + static_cast<int>(i);
            const double value = line[inside ? c : std::clamp(c, 0, image.width - 1)];
            s += k.g[i] * value, s1 += k.g1[i] * value, s2 += k.g2[i] * value;
        }
        d.x += k.g[j] * s1, d.xx += k.g[j] * s2;
        d.y += k.g1[j] * s, d.xy += k.g1[j] * s1;
        d.yy += k.g2[j] * s;
    }
    return d;
}

/// Unit vector of the Hessian's most negative eigenvalue, pointing down, and that eigenvalue.
struct RidgeAcross {
    Vector2d n;
    double curvature;
};

RidgeAcross ridge_across(const GreyDerivatives& d) {
    const double half = 0.5 * (d.xx - d.yy), root = std::hypot(half, d.xy);
    const double low = 0.5 * (d.xx + d.yy) - root;
    Vector2d n = half < 0 ? Vector2d(root - half, -d.xy) : Vector2d(d.xy, -(root + half));
    n = root > 0 ? Vector2d(n.normalized()) : Vector2d(0, 1);
    return {n.y() < 0 ? Vector2d(-n) : n, low};
}

}  // namespace

RidgeKernel make_kernel(double sigma) {
    RidgeKernel k{sigma, static_cast<int>(std::ceil(3.5 * sigma)), {}, {}, {}};
    const double scale = 1 / (std::sqrt(2 * std::numbers::pi) * sigma), s2 = sigma * sigma;
    for (int i = -k.radius; i <= k.radius; ++i) {
        const double g = scale * std::exp(-0.5 * i * i / s2);
        k.g.push_back(g);
        k.g1.push_back(i / s2 * g);  // of a convolution: the sign is that of the pixel's offset
        k.g2.push_back((i * i / s2 - 1) / s2 * g);
    }
    // Cut off and sampled, the second derivative would see a ridge in even grey.
    double sum = 0;
    for (const double value : k.g2) {
        sum += value;
    }
    for (double& value : k.g2) {
        value -= sum / static_cast<double>(k.g2.size());
    }
    return k;
}

std::optional<RidgePoint> ridge_point(const GreyImage& image, const RidgeKernel& k, int column, double y,
                                      const GroundSlope& ground, double noise) {
    constexpr double kHalfPixel = 0.5 + 1e-9;
    constexpr double kNearest = 0.75;   // px: where either neighbour of the middle points to the other
    constexpr double kSteepest = 0.42;  // of the normal's y: a line at 65 degrees
    const int tries = 2 + static_cast<int>(k.sigma);
    // 1-sigma of the curvature in white noise: the root of the integrals of g''^2 and g^2, 3/(8 sqrt(pi) s^5) and
    // 1/(2 sqrt(pi) s); and of the slope, 1/(4 sqrt(pi) s^3).
    const double s2 = k.sigma * k.sigma;
    const double curvature_noise = noise * std::sqrt(3 / (16 * std::numbers::pi)) / (s2 * k.sigma);
    const double slope_noise = noise / (std::sqrt(8 * std::numbers::pi) * s2);
    int row = std::clamp(static_cast<int>(std::lround(y)), 0, image.height - 1);
    double nearest = kNearest;
    std::optional<RidgePoint> best;
    for (int i = 0; i < tries; ++i) {
        const GreyDerivatives d = grey_derivatives(image, k, column, row);
        const auto [n, curvature] = ridge_across(d);
        if (!(curvature < -4 * curvature_noise) || n.y() < kSteepest) {
            return std::nullopt;
        }
        const double background = ground.slope * n.dot(ground.normal);
        const double t = -(d.x * n.x() + d.y * n.y() - background) / curvature;
        const Vector2d step = t * n;
        const double off = step.cwiseAbs().maxCoeff();
        if (off < nearest) {
            nearest = off;
            best = RidgePoint{Vector2d(column, row) + step, n, -slope_noise / curvature};
        }
        if (off <= kHalfPixel) {
            break;
        }
        // Along the column, to where the ridge's line crosses it; a far jump is a wrong one.
        const int move = static_cast<int>(std::lround(std::clamp(t / n.y(), -k.sigma - 1, k.sigma + 1)));
        row = std::clamp(row + (move ? move : (t > 0 ? 1 : -1)), 0, image.height - 1);
    }
    return best;
}

}  // namespace seampath
