#include "stages/geometry/golden_section.hpp"

namespace seampath {

double golden_section(const std::function<double(double)>& f, double low, double high) {
    constexpr double kRatio = 0.61803398874989485;
    constexpr int kSections = 48;  // kRatio^48 = 9e-11
    double a = high - kRatio * (high - low), b = low + kRatio * (high - low);
    double fa = f(a), fb = f(b);
    for (int i = 0; i < kSections; ++i) {
        if (fb < fa) {
            low = a, a = b, fa = fb;
            b = low + kRatio * (high - low), fb = f(b);
        } else {  // also where both are beyond where f is defined
            high = b, b = a, fb = fa;
            a = high - kRatio * (high - low), fa = f(a);
        }
    }
    return (low + high) / 2;
}

}  // namespace seampath
