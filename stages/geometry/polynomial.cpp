#include "stages/geometry/polynomial.hpp"

#include "stages/error.hpp"

namespace seampath {

std::vector<double> divided_differences(std::span<const double> x, std::span<const double> y) {
    ensure(x.size() == y.size(), "a value for each abscissa");
    std::vector<double> difference(y.begin(), y.end());
    for (std::size_t order = 1; order < x.size(); ++order) {
        for (std::size_t i = x.size(); i-- > order;) {
            difference[i] = (difference[i] - difference[i - 1]) / (x[i] - x[i - order]);
        }
    }
    return difference;
}

double newton_value(std::span<const double> x, std::span<const double> differences, double at) {
    double sum = 0;
    for (std::size_t i = x.size(); i-- > 0;) {
        sum = sum * (at - x[i]) + differences[i];
    }
    return sum;
}

double lagrange_value(std::span<const double> x, std::span<const double> y, double at) {
    double above = 0, below = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (at == x[i]) {
            return y[i];
        }
        double weight = 1 / (at - x[i]);
        for (std::size_t j = 0; j < x.size(); ++j) {
            weight /= j == i ? 1 : x[i] - x[j];
        }
        above += weight * y[i];
        below += weight;
    }
    return above / below;
}

std::vector<double> power_coefficients(std::span<const double> x, std::span<const double> differences) {
    std::vector<double> a(x.size(), 0);
    for (std::size_t i = x.size(); i-- > 0;) {  // a = a * (x - x_i) + difference_i
        for (std::size_t k = x.size() - 1; k > 0; --k) {
            a[k] = a[k - 1] - x[i] * a[k];
        }
        a[0] = differences[i] - x[i] * a[0];
    }
    return a;
}

}  // namespace seampath
