#include "stages/stripe/ridge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "stages/geometry/robust.hpp"
#include "stages/geometry/steger.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

/// The stripe about one link of a chain.
struct LinkShape {
    double sigma = 0;  ///< of the Gaussian that the stripe is like, px
    GroundSlope ground;
    bool drowned = false;  ///< the ground on either side is cut off at white: no middle can be told
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
    shape.ground.normal = Vector2d(-slope, 1).normalized();
    const double width = quantile(heights, 0.5) * shape.ground.normal.y();
    shape.sigma = kSigmaPerHeight * width;
    const Vector2d middle(links[i].column, links[i].bar.y), away = 2 * width * shape.ground.normal;
    const auto grey = [&](const Vector2d& p) {
        return static_cast<double>(
            image.clamped(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))));
    };
    const double above = grey(middle - away), below = grey(middle + away);
    shape.ground.slope = (below - above) / (4 * width);
    shape.drowned = above >= image.white || below >= image.white;
    return shape;
}

std::vector<LinkShape> shapes_along(const GreyImage& image, const Chain& chain) {
    std::vector<LinkShape> shapes;
    std::vector<double> sums{0};  // of the ground's slopes, up to each link
    for (std::size_t i = 0; i < chain.links.size(); ++i) {
        shapes.push_back(shape_at(image, chain.links, i));
        sums.push_back(sums.back() + shapes.back().ground.slope);
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const LinkWindow window(i, shapes.size());
        shapes[i].ground.slope =
            (sums[window.end] - sums[window.begin]) / static_cast<double>(window.end - window.begin);
    }
    return shapes;
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

/// The ridge of one line, column by column.
class RidgeLine {
public:
    RidgeLine(const GreyImage& image, double noise)
        : image_(image), noise_(noise), at_(static_cast<std::size_t>(image.width)) {}

    void find(const ChainLink& link, const LinkShape& shape) {
        if (!shape.drowned) {
            at(link.column) = look(link.column, link.bar.y, shape);
        }
    }

    /// Follows the ridge on into the columns beside those that have a point: bars end before a crossing, where they do
    /// not stand free, the ridge does not. It goes on where it is at least a third as sharp as at the end, and straight
    /// ahead.
    void grow(int end, int step, const LinkShape& shape) {
        const auto slope = slope_at(end, step);
        for (int c = end + step; slope && has(c - step) && c >= 0 && c < image_.width && !at(c); c += step) {
            const double ahead = at(end)->p.y() + *slope * (c - at(end)->p.x());
            const auto point = look(c, ahead, shape);
            if (point && point->sigma_px < 3 * at(end)->sigma_px &&
                std::abs(point->p.y() - ahead - *slope * (point->p.x() - c)) < shape.sigma) {
                at(c) = point;
            }
        }
    }

    bool has(int column) const {
        return column >= 0 && column < image_.width && at_[static_cast<std::size_t>(column)].has_value();
    }

    std::vector<StripePoint> points() const {
        std::vector<StripePoint> all;
        for (const auto& point : at_) {
            if (point && (all.empty() || point->p.x() > all.back().p.x())) {
                all.push_back(*point);
            }
        }
        return all;
    }

private:
    std::optional<StripePoint>& at(int column) { return at_[static_cast<std::size_t>(column)]; }

    std::optional<StripePoint> look(int column, double y, const LinkShape& shape) {
        constexpr double kFwhm = 2.355;       // a Gaussian's width at half height over its 1-sigma
        constexpr double kLeastSigma = 0.85;  // below, derivatives at whole pixels are not those of the picture
        constexpr double kGrid = 0.25;        // px, of sigmas: one kernel serves many points
        const int index = static_cast<int>(std::lround(std::max(kLeastSigma, shape.sigma) / kGrid));
        auto kernel = kernels_.find(index);
        if (kernel == kernels_.end()) {
            kernel = kernels_.emplace(index, make_kernel(index * kGrid)).first;
        }
        const auto ridge = ridge_point(image_, kernel->second, column, y, shape.ground, noise_);
        return ridge ? std::optional(StripePoint{ridge->p, ridge->normal, kFwhm * shape.sigma, ridge->sigma_px})
                     : std::nullopt;
    }

    /// Rows a column before an end, from the points there; empty when there are too few.
    std::optional<double> slope_at(int end, int step) const {
        constexpr int kReach = 12;
        constexpr double kFewest = 6;
        double n = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (int c = end; std::abs(c - end) <= kReach && has(c); c -= step) {
            const Vector2d& p = at_[static_cast<std::size_t>(c)]->p;
            const double u = p.x() - end;
            ++n, x += u, y += p.y(), xx += u * u, xy += u * p.y();
        }
        return n < kFewest ? std::nullopt : std::optional((n * xy - x * y) / (n * xx - x * x));
    }

    const GreyImage& image_;
    double noise_;
    std::vector<std::optional<StripePoint>> at_;
    std::map<int, RidgeKernel> kernels_;
};

}  // namespace

Stripe follow_ridge(const GreyImage& image, const Chain& chain, double noise) {
    const std::vector<LinkShape> shapes = shapes_along(image, chain);
    RidgeLine line(image, noise);
    double widest = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        line.find(chain.links[i], shapes[i]);
        widest = std::max(widest, shapes[i].sigma);
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        for (const int step : {-1, 1}) {
            const int end = chain.links[i].column;
            if (line.has(end) && !line.has(end + step)) {
                line.grow(end, step, shapes[i]);
            }
        }
    }
    Stripe stripe{line.points(), median_of(chain, &Bar::contrast)};
    const double extra = extra_scatter(stripe.points, widest);
    for (StripePoint& point : stripe.points) {
        point.sigma_px *= extra;
    }
    return stripe;
}

}  // namespace seampath
