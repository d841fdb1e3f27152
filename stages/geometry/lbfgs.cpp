#include "stages/geometry/lbfgs.hpp"

#include <cmath>
#include <deque>
#include <limits>
#include <vector>

namespace seampath {
namespace {

using Eigen::VectorXd;

// More pairs than the unknowns of a table of points make it BFGS; each costs two inner products an iteration.
constexpr std::size_t kPairs = 30;

/// One step and how it changed the gradient.
struct Pair {
    VectorXd s;
    VectorXd y;
    double rho;  ///< 1 / s.y
};

/// H g by the two-loop recursion (alg. 7.4).
VectorXd times_inverse_hessian(const std::deque<Pair>& pairs, const VectorXd& g) {
    VectorXd q = g;
    std::vector<double> alpha(pairs.size());
    for (std::size_t i = pairs.size(); i-- > 0;) {
        alpha[i] = pairs[i].rho * pairs[i].s.dot(q);
        q -= alpha[i] * pairs[i].y;
    }
    if (!pairs.empty()) {
        q *= 1 / (pairs.back().rho * pairs.back().y.squaredNorm());
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        q += (alpha[i] - pairs[i].rho * pairs[i].y.dot(q)) * pairs[i].s;
    }
    return q;
}

/// A point with its value and gradient.
struct Iterate {
    VectorXd x;
    double value;
    VectorXd gradient;
};

/// The search for one minimum.
class Search {
public:
    Search(const Differentiable& f, int max_evaluations) : f_(f), left_(max_evaluations) {}

    Iterate evaluate(VectorXd x) {
        Iterate p{std::move(x), 0, {}};
        p.gradient.resize(p.x.size());
        p.value = f_(p.x, p.gradient);
        --left_;
        ++count_;
        return p;
    }

    /// A step along d that keeps both weak Wolfe conditions, or the best that is left when evaluations or digits end.
    Iterate step(const Iterate& from, const VectorXd& d, double length) {
        constexpr double kDecrease = 1e-4, kSlope = 0.9;
        const double slope = from.gradient.dot(d);
        double low = 0, high = std::numeric_limits<double>::infinity();
        Iterate best = from;
        while (left_ > 0) {
            const Iterate p = evaluate(from.x + length * d);
            if (!(p.value <= from.value + kDecrease * length * slope)) {  // also when not finite
                high = length;
            } else {
                best = p;
                if (p.gradient.dot(d) >= kSlope * slope) {
                    break;
                }
                low = length;
            }
            const double next = std::isinf(high) ? 2 * low : (low + high) / 2;
            if (next == length || next == low || length * d.norm() <= 1e-16 * (1 + from.x.norm())) {
                break;
            }
            length = next;
        }
        return best;
    }

    int left() const { return left_; }
    int count() const { return count_; }

private:
    const Differentiable& f_;
    int left_;
    int count_ = 0;
};

}  // namespace

Minimum minimise(const Differentiable& f, const VectorXd& start, double tolerance, int max_evaluations) {
    Search search(f, max_evaluations);
    Iterate at = search.evaluate(start);
    std::deque<Pair> pairs;
    bool converged = false;
    while (search.left() > 0) {
        const VectorXd d = -times_inverse_hessian(pairs, at.gradient);
        const double slope = at.gradient.dot(d);
        if (!pairs.empty() && -slope / 2 <= tolerance * std::abs(at.value)) {
            converged = true;
            break;
        }
        // Without curvature known, a step that would move by about one unit at most.
        const Iterate next = search.step(at, d, pairs.empty() ? std::min(1.0, 1 / d.norm()) : 1.0);
        if (!(next.value < at.value)) {
            converged = -slope <= 1e-12 * std::abs(at.value);
            if (converged || pairs.empty()) {
                break;  // no lower point within rounding
            }
            pairs.clear();
            continue;
        }
        Pair pair{next.x - at.x, next.gradient - at.gradient, 0};
        const double curvature = pair.s.dot(pair.y);
        if (curvature > 0) {
            pair.rho = 1 / curvature;
            pairs.push_back(std::move(pair));
        }
        if (pairs.size() > kPairs) {
            pairs.pop_front();
        }
        at = next;
    }
    return {at.x, at.value, search.count(), converged};
}

}  // namespace seampath
