#include "stages/validate/verdict.hpp"

#include <cmath>

#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath::detail {
namespace {

constexpr double kWide = 0.5;  // mm; a default beyond it is more than the welds of thin plates can bear
constexpr double kGuard = 2;   // sigmas of the measurement taken off the tolerance (ISO 14253-1)

}  // namespace
}  // namespace seampath::detail

namespace seampath {

double guard_mm(const Deviation& deviation) {
    std::vector<double> sigma;
    for (const DeviationSample& s : deviation.samples) {
        if (s.covered) {
            sigma.push_back(s.sigma_mm);
        }
    }
    return detail::kGuard * quantile(sigma, 0.5);
}

bool wide_by_noise(const Deviation& deviation, const ValidateOptions& options) {
    return options.tolerance_mm == 0 && deviation.tolerance_mm > detail::kWide;
}

}  // namespace seampath

namespace seampath::detail {

void summarise(Deviation& result, const ValidateOptions& options) {
    std::vector<double> distance;
    double sum = 0, signed_sum = 0;
    for (const DeviationSample& s : result.samples) {
        if (s.covered) {
            distance.push_back(s.distance_mm);
            sum += s.distance_mm * s.distance_mm;
            signed_sum += 0.5 * (s.flank1_mm + s.flank2_mm);
        }
    }
    const auto n = static_cast<double>(distance.size());
    result.coverage = result.samples.empty() ? 0 : n / static_cast<double>(result.samples.size());
    if (!distance.empty()) {
        result.signed_mean_mm = signed_sum / n;
        result.rms_mm = std::sqrt(sum / n);
        result.p50_mm = quantile(distance, 0.5);
        result.p95_mm = quantile(distance, 0.95);
        result.p997_mm = quantile(distance, 0.997);
        result.max_mm = quantile(distance, 1);
    }
    const double guard = guard_mm(result), guarded = result.p997_mm + guard;
    const bool covered = result.coverage >= options.min_coverage, inside = guarded <= result.tolerance_mm;
    result.pass = covered && inside && !distance.empty();
    result.verdict = std::string(result.pass ? "pass" : "fail") + ": p99.7 " + fixed(result.p997_mm, 3) +
                     " mm + guard " + fixed(guard, 3) + " mm " + (inside ? "within" : "exceeds") + " tolerance " +
                     fixed(result.tolerance_mm, 3) + " mm; " + fixed(100 * result.coverage, 1) +
                     " % of the seam measured" +
                     (covered ? "" : ", less than " + fixed(100 * options.min_coverage, 1) + " %");
    if (wide_by_noise(result, options)) {
        result.verdict += "; the tolerance is only what the scan's noise of " +
                          fixed(result.tolerance_mm / kNoiseTolerance, 2) +
                          " mm allows: set validate.tolerance_mm to what the weld needs";
    }
}

}  // namespace seampath::detail
