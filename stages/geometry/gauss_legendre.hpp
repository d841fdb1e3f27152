#pragma once

#include <array>
#include <cstddef>

namespace seampath {

/// Integral of a smooth function of one variable from a to b by the eight-point Gauss-Legendre rule, exact for
/// polynomials of degree 15 (Abramowitz & Stegun, table 25.4).
template <typename Function>
double gauss_legendre(const Function& f, double a, double b) {
    constexpr std::array<double, 4> kNode{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                          0.9602898564975363};
    constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                            0.1012285362903763};
    const double half = 0.5 * (b - a), middle = 0.5 * (a + b);
    double sum = 0;
    for (std::size_t k = 0; k < kNode.size(); ++k) {
        sum += kWeight[k] * (f(middle - half * kNode[k]) + f(middle + half * kNode[k]));
    }
    return half * sum;
}

}  // namespace seampath
