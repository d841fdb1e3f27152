#pragma once

#include <cmath>
#include <cstdint>

/// Elementary functions built from + - * / and sqrt only, which IEEE 754 fixes to the last bit. The C library's own
/// differ in their last digit between versions and processors; data sets must be the same bytes everywhere.
namespace seampath::portable {

inline constexpr double kPi = 3.14159265358979323846;

struct SinCos {
    double sin;
    double cos;
};

/// Sine and cosine for |x| up to about 1e5, to about 2e-16: Taylor series after reduction to |x| <= pi/4, with pi/2 in
/// two parts (Cody and Waite).
inline SinCos sincos(double x) {
    const double kHalfPiHigh = 1.5707963267341256;    // the leading 33 bits of pi/2
    const double kHalfPiLow = 6.077100506506192e-11;  // pi/2 less those
    const double quadrant = std::floor(x * (2 / kPi) + 0.5);
    const double r = (x - quadrant * kHalfPiHigh) - quadrant * kHalfPiLow;
    const double r2 = r * r;
    double s = 1;
    double c = 1;
    for (int k = 17; k >= 3; k -= 2) {  // next terms: (pi/4)^19 / 19! = 8e-20 and (pi/4)^18 / 18! = 2e-18
        s = 1 - s * r2 / (k * (k - 1));
        c = 1 - c * r2 / ((k - 1) * (k - 2));
    }
    s *= r;
    switch (static_cast<std::int64_t>(quadrant) & 3) {
        case 0:
            return {s, c};
        case 1:
            return {c, -s};
        case 2:
            return {-s, -c};
        default:
            return {-c, s};
    }
}

/// Arc tangent: the argument is halved three times (tan(a/2) = t / (1 + sqrt(1 + t^2))), then the Taylor series.
inline double atan(double t) {
    for (int i = 0; i < 3; ++i) {
        t = t / (1 + std::sqrt(1 + t * t));
    }
    double sum = 0;
    for (int k = 23; k >= 1; k -= 2) {  // |t| <= tan(pi/16) = 0.199; next term 0.199^25 / 25 = 1e-19
        sum = 1.0 / k - t * t * sum;
    }
    return 8 * t * sum;
}

/// Arc cosine for -1 < x <= 1.
inline double acos(double x) {
    return 2 * atan(std::sqrt((1 - x) / (1 + x)));
}

/// Natural logarithm of x > 0: ln(m 2^e) = e ln 2 + 2 artanh((m - 1) / (m + 1)).
inline double log(double x) {
    int exponent = 0;
    double m = std::frexp(x, &exponent);
    if (m < 0.70710678118654752) {
        m *= 2;
        --exponent;
    }
    const double y = (m - 1) / (m + 1);  // |y| <= 0.172
    double sum = 0;
    for (int k = 23; k >= 1; k -= 2) {
        sum = 1.0 / k + y * y * sum;
    }
    return 2 * y * sum + exponent * 0.69314718055994530942;
}

/// Exponential for |x| < 700: x = k ln 2 + r, Taylor series in r.
inline double exp(double x) {
    const double k = std::floor(x / 0.69314718055994530942 + 0.5);
    const double r = x - k * 0.69314718055994530942;  // |r| <= 0.347
    double sum = 1;
    for (int n = 15; n >= 1; --n) {  // next term: 0.347^16 / 16! = 2e-21
        sum = 1 + sum * r / n;
    }
    return std::ldexp(sum, static_cast<int>(k));
}

inline double radians(double degrees) {
    return degrees * (kPi / 180);
}
inline double sin(double x) {
    return sincos(x).sin;
}
inline double cos(double x) {
    return sincos(x).cos;
}

}  // namespace seampath::portable
