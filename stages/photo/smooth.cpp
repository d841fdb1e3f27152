#include "stages/photo/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

constexpr double kSigmaOfMedianOff = 1.4826;
constexpr double kShortest = 6;  // distances: shorter waves have too few heights

/// Solves (W + lambda D'D) f = W y, D: second differences; W + lambda D'D = L diag(d) L' with two bands in L.
std::vector<double> penalised(const std::vector<double>& y, const std::vector<double>& weight, double lambda) {
    const std::size_t n = y.size();
    std::vector<double> d(n), e(n, 0), g(n, 0), f(n);
    const auto times = [&](std::size_t i, std::size_t lag) {  // of D'D, the entry (i, i + lag)
        double sum = 0;
        constexpr double kRow[3] = {1, -2, 1};
        for (std::size_t k = i + lag < 2 ? 0 : i + lag - 2; k <= i && k + 2 < n; ++k) {
            sum += kRow[i - k] * kRow[i + lag - k];
        }
        return lambda * sum;
    };
    for (std::size_t i = 0; i < n; ++i) {
        const double g2 = i > 1 ? g[i - 2] : 0, e1 = i > 0 ? e[i - 1] : 0;
        d[i] = weight[i] + times(i, 0) - (i > 0 ? e1 * e1 * d[i - 1] : 0) - (i > 1 ? g2 * g2 * d[i - 2] : 0);
        e[i] = i + 1 < n ? (times(i, 1) - (i > 0 ? e1 * g[i - 1] * d[i - 1] : 0)) / d[i] : 0;
        g[i] = i + 2 < n ? times(i, 2) / d[i] : 0;
        f[i] = weight[i] * y[i] - (i > 0 ? e1 * f[i - 1] : 0) - (i > 1 ? g2 * f[i - 2] : 0);
    }
    for (std::size_t i = n; i-- > 0;) {
        f[i] = f[i] / d[i] - (i + 1 < n ? e[i] * f[i + 1] : 0) - (i + 2 < n ? g[i] * f[i + 2] : 0);
    }
    return f;
}

double median_off(const Heights& heights, const std::vector<double>& f) {
    std::vector<double> off;
    for (std::size_t i = 0; i < f.size(); ++i) {
        if (heights.measured[i]) {
            off.push_back(std::abs(heights.y[i] - f[i]));
        }
    }
    return quantile(off, 0.5);
}

std::vector<double> robust_line(const Heights& heights, double length) {
    constexpr double kNothing = 1e-9;  // so that a line without heights is one
    constexpr int kRounds = 15;
    const double lambda = std::pow(length / (2 * std::numbers::pi), 4);
    std::vector<double> weight(heights.y.size()), f;
    for (std::size_t i = 0; i < weight.size(); ++i) {
        weight[i] = heights.measured[i] ? 1 : kNothing;
    }
    for (int round = 0;; ++round) {
        f = penalised(heights.y, weight, lambda);
        if (round == kRounds) {
            return f;
        }
        const double unit = std::max(1e-3, median_off(heights, f));
        for (std::size_t i = 0; i < weight.size(); ++i) {
            weight[i] = heights.measured[i] ? 1 / std::hypot(1, (heights.y[i] - f[i]) / unit) : kNothing;
        }
    }
}

/// How well lines predict blocks of heights that they are made without.
struct Prediction {
    double error = 0;  ///< mean of the blocks' mean sizes of errors
    double sigma = 0;  ///< 1-sigma of that mean
    double off = 0;    ///< root mean square of the blocks' mean errors
};

/// Errors beyond `most` count as that.
Prediction predict_blocks(const Heights& heights, std::size_t block, double length, double most) {
    constexpr std::size_t kTurns = 3;
    std::vector<double> sizes((heights.y.size() + block - 1) / block, 0), offs(sizes.size(), 0),
        counts(sizes.size(), 0);
    for (std::size_t turn = 0; turn < kTurns; ++turn) {
        Heights others = heights;
        for (std::size_t i = 0; i < heights.y.size(); ++i) {
            others.measured[i] = heights.measured[i] && i / block % kTurns != turn;
        }
        const std::vector<double> f = robust_line(others, length);
        for (std::size_t i = 0; i < f.size(); ++i) {
            if (heights.measured[i] && !others.measured[i]) {
                const double error = std::clamp(heights.y[i] - f[i], -most, most);
                sizes[i / block] += std::abs(error);
                offs[i / block] += error;
                ++counts[i / block];
            }
        }
    }
    Prediction p;
    double n = 0, squares = 0;
    for (std::size_t b = 0; b < sizes.size(); ++b) {
        if (counts[b] > 0) {
            const double size = sizes[b] / counts[b], off = offs[b] / counts[b];
            p.error += size, squares += size * size, p.off += off * off, ++n;
        }
    }
    p.error /= n;
    p.off = std::sqrt(p.off / n);
    p.sigma = n > 1 ? std::sqrt(std::max(0.0, squares / n - p.error * p.error) / (n - 1)) : 0;
    return p;
}

struct ChosenLength {
    double length = 0;
    Prediction prediction;
};

ChosenLength best_length(const Heights& heights, std::size_t block) {
    constexpr double kOutlier = 4;  // times the usual error: more counts no more
    const double most = kOutlier * std::max(1e-3, median_off(heights, robust_line(heights, 2 * kShortest)));
    std::vector<double> lengths;
    std::vector<Prediction> predictions;
    for (double length = kShortest; length <= 2 * static_cast<double>(heights.y.size());
         length *= std::numbers::sqrt2) {
        lengths.push_back(length);
        predictions.push_back(predict_blocks(heights, block, length, most));
    }
    if (lengths.empty()) {
        return {kShortest, {}};
    }
    const auto less = [](const Prediction& a, const Prediction& b) { return a.error < b.error; };
    const Prediction best = *std::min_element(predictions.begin(), predictions.end(), less);
    std::size_t i = lengths.size() - 1;
    while (predictions[i].error > best.error + best.sigma) {
        --i;
    }
    return {lengths[i], predictions[i]};
}

}  // namespace

SmoothLine smooth_line(const Heights& heights, std::size_t block) {
    const ChosenLength chosen = best_length(heights, block);
    SmoothLine line;
    line.length = chosen.length;
    line.y = robust_line(heights, line.length);
    // Of the kernel that the penalty amounts to, its value at 0: 1 / (2 sqrt(2) lambda^(1/4)).
    const double own = std::numbers::pi / (std::numbers::sqrt2 * line.length);
    line.scatter = kSigmaOfMedianOff * median_off(heights, line.y) / std::sqrt(1 - own);
    // Half of a block's error is its own, half that of the line that predicts it.
    line.sigma = std::max(line.scatter * std::sqrt(own), chosen.prediction.off / std::numbers::sqrt2);
    return line;
}

}  // namespace seampath::detail
