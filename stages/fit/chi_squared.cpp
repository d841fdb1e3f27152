#include "stages/fit/chi_squared.hpp"

#include <algorithm>
#include <cmath>

namespace seampath {
namespace {

constexpr double kNormal99 = 2.3263478740408408;

}  // namespace

double chi_squared_limit(double freedom) {
    const double v = 2 / (9 * freedom), root = 1 - v + kNormal99 * std::sqrt(v);
    return root * root * root;
}

ChiSquared chi_squared(const std::vector<Eigen::Vector2d>& z, bool closed) {
    const std::size_t n = z.size();
    double all = 0;
    for (const auto& r : z) {
        all += r.squaredNorm();
    }
    ChiSquared test;
    if (n == 0 || !(all > 0)) {
        return {0, chi_squared_limit(1), 1};
    }
    double squares = 1;  // of the correlations at all lags, 0 among them
    for (std::size_t k = 1; k < n; ++k) {
        double sum = 0;
        for (std::size_t i = 0; i + (closed ? 0 : k) < n; ++i) {
            sum += z[i].dot(z[(i + k) % n]);
        }
        squares += (closed ? 1 : 2) * sum * sum / (all * all);
    }
    test.freedom = std::max(1.0, static_cast<double>(n) / squares);
    test.per_freedom = all / static_cast<double>(n);
    test.limit = chi_squared_limit(test.freedom);
    return test;
}

}  // namespace seampath
