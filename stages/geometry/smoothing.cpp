#include "stages/geometry/smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace seampath {
namespace {

// Neighbours' errors go together where their measuring windows overlap, so that what is left over tells too little. Up
// to this many times the variance left over is noise, as far as the stated sigma allows.
constexpr double kOverlap = 16;

// Of exact points: a millionth of the stated sigma.
constexpr double kExactNoise = 1e-12;

// Freedom is counted dearer than in theory: against following noise by chance (Kim & Gu 2004 have 1.4 in GCV).
constexpr double kCaution = 1.4;

// Coefficients within a window of common lambda: fewer and the lambdas would be noise themselves.
constexpr double kWindow = 4;

void solve(PenalisedSpline& spline, const CurvePoints& points, Smoothing& s) {
    spline.solve(s.lambda);
    double used = 0;
    s.freedom = spline.freedom();
    s.misfit = 0;
    for (std::size_t i = 0; i < points.p.size(); ++i) {
        if (points.weight[i] > 0) {
            used += 1;
            s.misfit += points.weight[i] * (spline.at_point(i) - points.p[i]).squaredNorm();
        }
    }
    const double left = s.misfit / std::max(used - s.freedom, 1e-3 * used);  // exact points may use up all freedom
    s.noise = std::max({kExactNoise, left, std::min(1.0, kOverlap * left)});
}

// Spans, before the first and beyond the last in a ring.
struct Window {
    std::ptrdiff_t first, last;
};

// Around each span the fewest in which the curve has kWindow coefficients.
std::vector<Window> windows_of(const PenalisedSpline& spline, const Smoothing& s) {
    const auto n = static_cast<std::ptrdiff_t>(spline.spans());
    const bool ring = spline.curve().periodic;
    std::vector<double> free(spline.spans());
    for (std::size_t k = 0; k < free.size(); ++k) {
        free[k] = spline.freedom(k, s.lambda[k]);
    }
    std::vector<Window> windows;
    for (std::ptrdiff_t k = 0; k < n; ++k) {
        Window w{k, k};
        double sum = free[static_cast<std::size_t>(k)];
        const auto widen = [&](std::ptrdiff_t& end, std::ptrdiff_t by) {
            const bool can = w.last - w.first + 1 < n && (ring || (end + by >= 0 && end + by < n));
            end += can ? by : 0;
            sum += can ? free[static_cast<std::size_t>((end + n) % n)] : 0;
            return can;
        };
        bool wider = true;
        while (sum < kWindow && wider) {
            wider = widen(w.first, -1);
            wider = widen(w.last, 1) || wider;
        }
        windows.push_back(w);
    }
    return windows;
}

}  // namespace

void smooth_evenly(PenalisedSpline& spline, const CurvePoints& points, Smoothing& s) {
    constexpr int kMostSteps = 30;
    constexpr double kNear = 0.1;                          // of log lambda: a change of freedom by 2 %
    constexpr double kMostStep = 8;                        // of log lambda
    double before = 0, slope = -0.25, step = 0, last = 0;  // secant method for log lambda; the first slope is typical
    for (int round = 0; round < kMostSteps; ++round) {
        solve(spline, points, s);
        double rough = 0, free = 0, highest = 0;
        for (std::size_t k = 0; k < spline.spans(); ++k) {
            rough += spline.roughness(k);
            free += spline.freedom(k, s.lambda[k]);
            highest = std::max(highest, s.lambda[k]);
        }
        const double now = rough > 0 ? std::log(s.noise * free / rough / highest) : 0;
        // The spline may hold lambda where it is; and one that has not been solved with must not be left behind.
        const bool held = round > 0 && std::abs(std::log(highest / last)) < kNear;
        if (std::abs(now) < kNear || held || round + 1 == kMostSteps) {
            break;
        }
        last = highest;
        if (round > 0 && step != 0) {
            slope = std::clamp((now - before) / step, -1.0, -0.15);
        }
        before = now;
        step = std::clamp(-now / slope, -kMostStep, kMostStep);
        s.lambda.assign(spline.spans(), highest * std::exp(step));
    }
}

void smooth_locally(PenalisedSpline& spline, const CurvePoints& points, Smoothing& s) {
    constexpr int kLocalRounds = 10;
    constexpr double kMostChange = 1e3;
    solve(spline, points, s);
    const std::vector<Window> windows = windows_of(spline, s);
    const auto n = static_cast<std::ptrdiff_t>(spline.spans());
    std::vector<double> free(spline.spans()), rough(spline.spans());
    for (int round = 0; round < kLocalRounds; ++round) {
        for (std::size_t k = 0; k < spline.spans(); ++k) {
            free[k] = spline.freedom(k, s.lambda[k]);
            rough[k] = spline.roughness(k);
        }
        for (std::size_t k = 0; k < spline.spans(); ++k) {
            double r = 0, f = 0;
            for (std::ptrdiff_t j = windows[k].first; j <= windows[k].last; ++j) {
                r += rough[static_cast<std::size_t>((j + n) % n)];
                f += free[static_cast<std::size_t>((j + n) % n)];
            }
            s.lambda[k] *= r > 0 ? std::clamp(s.noise * f / r / s.lambda[k], 1 / kMostChange, kMostChange) : 1;
        }
        solve(spline, points, s);
    }
}

double set_level(PenalisedSpline& spline, const CurvePoints& points, Smoothing& s) {
    solve(spline, points, s);
    const double noise = s.noise;
    const auto risk = [noise](const Smoothing& t) { return t.misfit + 2 * kCaution * noise * t.freedom; };
    Smoothing best = s;
    for (const double step : {16.0, 2.0}) {
        for (const double factor : {step, 1 / step}) {
            Smoothing trial = best;
            while (true) {
                for (double& lambda : trial.lambda) {
                    lambda *= factor;
                }
                solve(spline, points, trial);
                if (!(risk(trial) < (1 - 1e-9) * risk(best))) {
                    break;
                }
                best = trial;
            }
        }
    }
    s = best;
    solve(spline, points, s);
    s.noise = noise;
    return risk(s);
}

}  // namespace seampath
