#pragma once

#include "datasets/rng.hpp"
#include "stages/fit/fit.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/place/place.hpp"
#include "tests/geometry/curves.hpp"

/// Seams with noise, and how far their models are from the shape.
namespace seampath {

inline SeamModel model_of(const Seam& seam) {
    return fit(seam, place(seam, {}), {});
}

/// Sigma is of the distance from the seam: each of the two directions across has its share.
inline Seam noisy(Seam seam, double sigma, std::uint64_t seed) {
    const Random random(seed, 0);
    for (std::size_t i = 0; i < seam.points.size(); ++i) {
        SeamPoint& point = seam.points[i];
        point.p += sigma / std::sqrt(2.0) * (random.normal(2 * i) * point.n1 + random.normal(2 * i + 1) * point.n2);
        point.sigma_mm = sigma;
    }
    return seam;
}

/// Largest distance of the model's curve from a shape.
template <class Curve>
double largest_error(const SeamModel& model, const Curve& shape) {
    const ArcLength arc(model.curve);
    double worst = 0;
    for (int i = 0; i <= 300; ++i) {
        worst = std::max(worst, distance_to(shape, position(model.curve, arc.parameter(arc.length() * i / 300))));
    }
    return worst;
}

}  // namespace seampath
