#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
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

/// How many printed parameters are off by one unit of their fourth and last digit at most.
inline int within_a_digit(const std::vector<double>& printed, const std::vector<double>& t) {
    int near = 0;
    for (std::size_t i = 0; i < printed.size(); ++i) {
        near += std::abs(std::round(1e4 * printed[i]) - std::round(1e4 * t[i])) <= 1 ? 1 : 0;
    }
    return near;
}

/// t^WC of table VI against the chords of table V, whose row 3 is misprinted.
struct WorkCentre {
    double worst = 0;            ///< difference of the parameters from row 4 on
    double over_row_3 = 0;       ///< chords from row 2 over 3 to 4
    double over_row_3_by_t = 0;  ///< the same by the parameters
};

inline WorkCentre work_centre() {
    const Eigen::MatrixXd p = as_matrix(paper_points("marin_table_5.csv"));
    const auto t = paper_column("marin_table_6.csv", 1);
    std::vector<double> chord;
    for (Eigen::Index i = 0; i + 1 < p.rows(); ++i) {
        chord.push_back((p.row(i + 1) - p.row(i)).norm());
    }
    const double scale = std::accumulate(chord.begin() + 4, chord.end(), 0.0) / (1 - t[4]);
    WorkCentre result{0, chord[2] + chord[3], scale * (t[4] - t[2])};
    double at = t[4];
    for (std::size_t i = 4; i < chord.size(); ++i) {
        at += chord[i] / scale;
        result.worst = std::max(result.worst, std::abs(at - t[i + 1]));
    }
    return result;
}

}  // namespace seampath
