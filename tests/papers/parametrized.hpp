#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/parametrize.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {

using Points = std::vector<Eigen::VectorXd>;

inline const std::vector<double> kRobotWeights{1, 1, 2, 6, 6, 6};  // Marin, section 3

inline Parametrization solved(const Points& points, Objective objective, std::vector<double> weights = {},
                              double tolerance = 1e-12) {
    ParametrizeOptions options;
    options.objective = objective;
    options.weights = std::move(weights);
    options.tolerance = tolerance;
    return parametrize(points, options);
}

inline double worst_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = a.size() == b.size() ? 0 : 1;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        worst = std::max(worst, std::abs(a[i] - b[i]));
    }
    return worst;
}

}  // namespace seampath
