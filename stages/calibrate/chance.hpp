#pragma once

#include <cmath>

namespace seampath::calibrating {

/// Probability that a chi-squared of k degrees of freedom is at least x: the regularised upper incomplete gamma
/// function Q(k / 2, x / 2), by its finite sum (Abramowitz and Stegun 26.4.4 and 26.4.5). 1 for k = 0.
inline double chi_squared_tail(double x, int k) {
    if (k <= 0) {
        return 1;
    }
    if (k > 300) {  // the sum would lose itself in exp(-x / 2); Wilson and Hilferty's cube root is good to 1e-4 here
        const double v = 2.0 / (9 * k);
        return 0.5 * std::erfc((std::cbrt(x / k) - (1 - v)) / std::sqrt(2 * v));
    }
    double sum = k % 2 == 0 ? std::exp(-x / 2) : std::erfc(std::sqrt(x / 2));
    double term = k % 2 == 0 ? sum : std::sqrt(2 * x / std::acos(-1.0)) * std::exp(-x / 2);
    if (k % 2 == 0) {
        for (int i = 1; i < k / 2; ++i) {
            term *= x / (2 * i);
            sum += term;
        }
        return sum;
    }
    for (int i = 1; i <= (k - 1) / 2; ++i) {
        sum += term;
        term *= x / (2 * i + 1);
    }
    return sum;
}

}  // namespace seampath::calibrating
