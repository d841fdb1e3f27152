#include "stages/stripe/ridge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

/// A Gaussian and its derivatives at whole pixels from -radius to radius.
struct RidgeKernel {
    double sigma = 1;
    int radius = 0;
    std::vector<double> g, g1, g2;
};

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

struct Derivatives {
    double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
};

Derivatives derivatives(const GreyImage& image, const RidgeKernel& k, int column, int row) {
    Derivatives d;
    for (int j = -k.radius; j <= k.radius; ++j) {
        double s = 0, s1 = 0, s2 = 0;
        const auto add = [&](int i, double value) {
            const auto n = static_cast<std::size_t>(i + k.radius);
            s += k.g[n] * value, s1 += k.g1[n] * value, s2 += k.g2[n] * value;
        };
        if (column >= k.radius && column + k.radius < image.width) {
            const int r = std::clamp(row + j, 0, image.height - 1);
            const float* line = &image.value[static_cast<std::size_t>(r) * static_cast<std::size_t>(image.width) +
                                             static_cast<std::size_t>(column - k.radius)];
            for (int i = -k.radius; i <= k.radius; ++i) {
                add(i, line[i + k.radius]);
            }
        } else {
            for (int i = -k.radius; i <= k.radius; ++i) {
                add(i, image.clamped(column + i, row + j));
            }
        }
        const auto n = static_cast<std::size_t>(j + k.radius);
        d.x += k.g[n] * s1, d.xx += k.g[n] * s2;
        d.y += k.g1[n] * s, d.xy += k.g1[n] * s1;
        d.yy += k.g2[n] * s;
    }
    return d;
}

/// Unit vector of the Hessian's most negative eigenvalue, pointing down, and that eigenvalue.
struct Across {
    Vector2d n;
    double curvature;
};

Across across(const Derivatives& d) {
    const double half = 0.5 * (d.xx - d.yy), root = std::hypot(half, d.xy);
    const double low = 0.5 * (d.xx + d.yy) - root;
    Vector2d n = half < 0 ? Vector2d(root - half, -d.xy) : Vector2d(d.xy, -(root + half));
    n = root > 0 ? Vector2d(n.normalized()) : Vector2d(0, 1);
    return {n.y() < 0 ? Vector2d(-n) : n, low};
}

/// The stripe about one link of a chain.
struct LinkShape {
    double sigma = 0;       ///< of the Gaussian that the stripe is like, px
    Vector2d normal{0, 1};  ///< from the chain's course
    double background = 0;  ///< slope of the ground across it, grey values a px
    bool drowned = false;   ///< the ground on either side is cut off at white: no middle can be told
};

/// Links about one of them, which a mean is taken over.
struct LinkWindow {
    std::size_t begin, end;
    LinkWindow(std::size_t i, std::size_t links)
        : begin(i > kReach ? i - kReach : 0), end(std::min(links, i + kReach + 1)) {}
    static constexpr std::size_t kReach = 12;
};

/// What a column shows of a slanted stripe is longer than the stripe is wide. The ground is seen where nothing of the
/// stripe is left: two heights are nearly six sigmas.
LinkShape shape_at(const GreyImage& image, const std::vector<ChainLink>& links, std::size_t i) {
    constexpr double kSigmaPerHeight = 0.345;  // a Gaussian's 1-sigma over the height of the bar that fits it best
    const LinkWindow window(i, links.size());
    std::vector<double> heights;
    for (std::size_t k = window.begin; k < window.end; ++k) {
        heights.push_back(links[k].bar.height);
    }
    const ChainLink &first = links[window.begin], &last = links[window.end - 1];
    const double slope = (last.bar.y - first.bar.y) / std::max(1.0, static_cast<double>(last.column - first.column));
    LinkShape shape;
    shape.normal = Vector2d(-slope, 1).normalized();
    const double width = quantile(heights, 0.5) * shape.normal.y();
    shape.sigma = kSigmaPerHeight * width;
    const Vector2d middle(links[i].column, links[i].bar.y), away = 2 * width * shape.normal;
    const auto grey = [&](const Vector2d& p) {
        return static_cast<double>(
            image.clamped(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))));
    };
    const double above = grey(middle - away), below = grey(middle + away);
    shape.background = (below - above) / (4 * width);
    shape.drowned = above >= image.white || below >= image.white;
    return shape;
}

std::vector<LinkShape> shapes_along(const GreyImage& image, const Chain& chain) {
    std::vector<LinkShape> shapes;
    std::vector<double> sums{0};  // of the ground's slopes, up to each link
    for (std::size_t i = 0; i < chain.links.size(); ++i) {
        shapes.push_back(shape_at(image, chain.links, i));
        sums.push_back(sums.back() + shapes.back().background);
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const LinkWindow window(i, shapes.size());
        shapes[i].background = (sums[window.end] - sums[window.begin]) / static_cast<double>(window.end - window.begin);
    }
    return shapes;
}

/// The point of the ridge nearest to a pixel of the column, begun at a row.
std::optional<StripePoint> ridge_point(const GreyImage& image, const RidgeKernel& k, const ChainLink& link,
                                       const LinkShape& shape, double noise) {
    constexpr double kHalfPixel = 0.5 + 1e-9;
    constexpr double kNearest = 0.75;   // px: where either neighbour of the middle points to the other
    constexpr double kSteepest = 0.42;  // of the normal's y: a stripe at 65 degrees
    const int tries = 2 + static_cast<int>(k.sigma);
    // 1-sigma of the curvature in white noise: the root of the integrals of g''^2 and g^2, 3/(8 sqrt(pi) s^5) and
    // 1/(2 sqrt(pi) s); and of the slope, 1/(4 sqrt(pi) s^3).
    const double s2 = k.sigma * k.sigma;
    const double curvature_noise = noise * std::sqrt(3 / (16 * std::numbers::pi)) / (s2 * k.sigma);
    const double slope_noise = noise / (std::sqrt(8 * std::numbers::pi) * s2);
    int row = std::clamp(static_cast<int>(std::lround(link.bar.y)), 0, image.height - 1);
    double nearest = kNearest;
    std::optional<StripePoint> best;
    for (int i = 0; i < tries; ++i) {
        const Derivatives d = derivatives(image, k, link.column, row);
        const auto [n, curvature] = across(d);
        if (!(curvature < -4 * curvature_noise) || n.y() < kSteepest) {
            return std::nullopt;
        }
        const double ground = shape.background * n.dot(shape.normal);
        const double t = -(d.x * n.x() + d.y * n.y() - ground) / curvature;
        const Vector2d step = t * n;
        const double off = step.cwiseAbs().maxCoeff();
        if (off < nearest) {
            nearest = off;
            best = StripePoint{Vector2d(link.column, row) + step, n, 0, -slope_noise / curvature};
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

/// How many times more the points scatter along the stripe than white noise explains, at least 1: speckle is part of
/// it. From second differences over neighbours that share no pixels.
double extra_scatter(const std::vector<StripePoint>& points, double widest_sigma) {
    const auto step = static_cast<std::size_t>(std::ceil(4 * widest_sigma));
    std::vector<double> ratios;
    for (std::size_t i = step; i + step < points.size(); ++i) {
        const StripePoint &a = points[i - step], &b = points[i], &c = points[i + step];
        if (c.p.x() - a.p.x() < 2.5 * static_cast<double>(step)) {
            const double off = b.normal.dot(b.p - 0.5 * (a.p + c.p));
            ratios.push_back(std::abs(off) / (std::sqrt(1.5) * b.sigma_px));
        }
    }
    constexpr double kSigmaOfMedian = 1.4826;
    return ratios.size() < 10 ? 1 : std::max(1.0, kSigmaOfMedian * quantile(ratios, 0.5));
}

}  // namespace

Stripe follow_ridge(const GreyImage& image, const Chain& chain, double noise) {
    constexpr double kFwhm = 2.355;       // a Gaussian's width at half height over its 1-sigma
    constexpr double kLeastSigma = 0.85;  // below, derivatives at whole pixels are not those of the picture
    constexpr double kGrid = 0.25;        // px, of sigmas: one kernel serves many points
    Stripe stripe;
    stripe.contrast = median_of(chain, &Bar::contrast);
    std::map<int, RidgeKernel> kernels;
    const std::vector<LinkShape> shapes = shapes_along(image, chain);
    double widest = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const double sigma = std::max(kLeastSigma, shapes[i].sigma);
        const int index = static_cast<int>(std::lround(sigma / kGrid));
        auto kernel = kernels.find(index);
        if (kernel == kernels.end()) {
            kernel = kernels.emplace(index, make_kernel(index * kGrid)).first;
        }
        auto point = ridge_point(image, kernel->second, chain.links[i], shapes[i], noise);
        const bool follows = point && (stripe.points.empty() || point->p.x() > stripe.points.back().p.x());
        if (follows && !shapes[i].drowned) {
            point->width_px = kFwhm * shapes[i].sigma;
            stripe.points.push_back(*point);
            widest = std::max(widest, sigma);
        }
    }
    const double extra = extra_scatter(stripe.points, widest);
    for (StripePoint& point : stripe.points) {
        point.sigma_px *= extra;
    }
    return stripe;
}

}  // namespace seampath
