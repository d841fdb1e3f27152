#include "stages/geometry/interpolation_check.hpp"

#include <algorithm>
#include <cmath>

#include "stages/error.hpp"
#include "stages/geometry/golden_section.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

constexpr int kSamples = 64;  ///< of an interval

double sample(const Interpolant& line, std::size_t i, int k) {
    return k == kSamples ? line.t[i + 1] : line.t[i] + (line.t[i + 1] - line.t[i]) * k / kSamples;
}

/// Shortest distance of p from interval i of the line, or `best` where that is less: the best sample, refined between
/// its neighbours.
double nearer(const Interpolant& line, std::size_t i, const Vector2d& p, double best) {
    const auto away = [&](double t) { return (line.at(t) - p).norm(); };
    for (int k = 0; k < kSamples; ++k) {
        // No point of the piece is nearer than its ends by more than half its length.
        const double here = std::min(away(sample(line, i, k)), away(sample(line, i, k + 1)));
        const double piece = (line.at(sample(line, i, k + 1)) - line.at(sample(line, i, k))).norm();
        if (here - piece < best) {
            best = std::min(best, away(golden_section(away, sample(line, i, k), sample(line, i, k + 1))));
        }
    }
    return best;
}

/// Shortest distance of p from the line, |e| at most. From the interval that holds p.x outwards, on either side until
/// all nodes to come are farther off in x, and one interval more for lines that swing out.
double distance(const Interpolant& line, std::span<const double> nodes, const Vector2d& p, double error) {
    const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, p.x());
    const auto middle = static_cast<std::size_t>(above - nodes.begin()) - 1;
    double best = nearer(line, middle, p, error);
    for (std::size_t i = middle + 1; i + 1 < nodes.size() && nodes[i - 1] - p.x() <= best; ++i) {
        best = nearer(line, i, p, best);
    }
    for (std::size_t i = middle; i > 0 && p.x() - nodes[i + 1] <= best; --i) {
        best = nearer(line, i - 1, p, best);
    }
    return best;
}

struct Statistics {
    double mean = 0, squares = 0, max = 0;  ///< squares: their mean

    explicit Statistics(const std::vector<double>& values) {
        for (const double v : values) {
            mean += v;
            squares += v * v;
            max = std::max(max, v);
        }
        mean /= static_cast<double>(values.size());
        squares /= static_cast<double>(values.size());
    }
};

int sign(double value, double rounding) {
    return value > rounding ? 1 : value < -rounding ? -1 : 0;
}

/// The y of the nodes as runs up and down.
class Data {
public:
    explicit Data(std::span<const double> y) {
        const auto [low, high] = std::minmax_element(y.begin(), y.end());
        rounding_ = 1e-12 * (*high - *low) + 1e-15 * std::max(std::abs(*low), std::abs(*high));
        for (std::size_t i = 0; i + 1 < y.size(); ++i) {
            way_.push_back(sign(y[i + 1] - y[i], 0));
        }
    }
    double rounding() const { return rounding_; }
    /// +1 or -1 in a monotone interval, else 0.
    int monotone(std::size_t i) const {
        const bool before = i == 0 || way_[i - 1] * way_[i] >= 0;
        const bool after = i + 1 == way_.size() || way_[i] * way_[i + 1] >= 0;
        return before && after ? way_[i] : 0;
    }
    const std::vector<int>& ways() const { return way_; }

private:
    double rounding_;
    std::vector<int> way_;
};

/// Counts changes from up to down and back.
struct Turns {
    int way = 0, count = 0;
    void go(int next) {
        count += next * way < 0 ? 1 : 0;
        way = next != 0 ? next : way;
    }
};

/// Walks along the samples of all intervals and notes what the line does.
class Walk {
public:
    Walk(const Interpolant& line, std::span<const double> y) : line_(line), y_(y), data_(y) {}

    Shape shape() {
        for (std::size_t i = 0; i + 1 < y_.size(); ++i) {
            Vector2d last = line_.at(line_.t[i]);
            last.y() = y_[i];  // of two values where formulas meet, the node's
            for (int k = 1; k <= kSamples; ++k) {
                Vector2d next = line_.at(sample(line_, i, k));
                next.y() = k == kSamples ? y_[i + 1] : next.y();
                step(i, k, last, next);
                last = next;
            }
        }
        shape_.turns = turns_.count;
        Turns of_data;
        for (const int way : data_.ways()) {
            of_data.go(way);
        }
        shape_.data_turns = of_data.count;
        return std::move(shape_);
    }

private:
    void step(std::size_t i, int k, const Vector2d& from, const Vector2d& to) {
        const int way = sign(to.y() - from.y(), data_.rounding());
        turns_.go(way);
        shape_.runs_back |= to.x() < from.x();
        const int wanted = data_.monotone(i);
        const bool reversed = way * wanted < 0;
        if (reversed) {
            reverse(i, k, from, to);
        }
        within_ = reversed;
        const auto [low, high] = std::minmax(y_[i], y_[i + 1]);
        const double out = std::max(low - to.y(), to.y() - high);
        if (wanted != 0 && out > std::max(shape_.overshoot, data_.rounding())) {
            shape_.overshoot = out;
            shape_.overshoot_x = to.x();
        }
    }

    void reverse(std::size_t i, int k, const Vector2d& from, const Vector2d& to) {
        if (!within_) {
            shape_.reversals.push_back({from.x(), to.x(), from.x(), 0});
        }
        Reversal& reversal = shape_.reversals.back();
        reversal.to_x = to.x();
        // The steepest place between the samples, by differences over a hundredth of one.
        const double width = (line_.t[i + 1] - line_.t[i]) / kSamples / 100;
        for (int fine = 0; fine < 10; ++fine) {
            const double t = sample(line_, i, k - 1) + width * (10 * fine + 4.5);
            const Vector2d rise = line_.at(t + width) - line_.at(t);
            const double slope = rise.y() / rise.x();
            if (slope * data_.monotone(i) < 0 && std::abs(slope) > std::abs(reversal.slope)) {
                reversal.slope = slope;
                reversal.x = line_.at(t + width / 2).x();
            }
        }
    }

    const Interpolant& line_;
    std::span<const double> y_;
    Data data_;
    Turns turns_;
    bool within_ = false;  ///< a reversal
    Shape shape_;
};

/// Formulas change at nodes and at U = 1/4, 1/2 and 3/4.
void find_jump(const Interpolant& line, std::span<const double> x, Shape& shape) {
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
        for (const double u : {0.0, 0.25, 0.5, 0.75}) {
            const double at = x[i] + u * (x[i + 1] - x[i]);
            const double width = 1e-9 * (x[i + 1] - x[i]);
            if (at - 3 * width < x.front()) {
                continue;
            }
            // Across the place, less what the slope beside it makes.
            const double across = line.value(at + width) - line.value(at - width);
            const double beside = line.value(at - width) - line.value(at - 3 * width);
            const double jump = std::abs(across - beside);
            if (jump > shape.jump) {
                shape.jump = jump;
                shape.jump_x = at;
            }
        }
    }
}

}  // namespace

CheckStatistics check_points(const Interpolant& line, std::span<const Vector2d> points) {
    ensure(!points.empty(), "a check point at least");
    std::vector<double> nodes;
    for (const double t : line.t) {
        nodes.push_back(line.at(t).x());
    }
    CheckStatistics s;
    for (const Vector2d& p : points) {
        s.error.push_back(std::abs(p.y() - line.value(p.x())));
        s.distance.push_back(distance(line, nodes, p, s.error.back()));
    }
    const Statistics error(s.error), away(s.distance);
    const double n = static_cast<double>(points.size());
    s.mean = error.mean;
    s.rms = std::sqrt(error.squares);
    for (const double e : s.error) {
        s.variance += (e - s.mean) * (e - s.mean) / n;
    }
    if (points.size() > 1) {
        s.sample_variance = s.variance * n / (n - 1);
    }
    s.max = error.max;
    s.max_x = points[static_cast<std::size_t>(std::max_element(s.error.begin(), s.error.end()) - s.error.begin())].x();
    s.distance_mean = away.mean;
    s.distance_rms = std::sqrt(away.squares);
    s.distance_max = away.max;
    return s;
}

Shape shape_of(const Interpolant& line, std::span<const double> x, std::span<const double> y) {
    Shape shape = Walk(line, y).shape();
    find_jump(line, x, shape);
    const auto [low, high] = std::minmax_element(y.begin(), y.end());
    if (shape.jump <= 1e-6 * (*high - *low) + 1e-12 * std::max(std::abs(*low), std::abs(*high))) {
        shape.jump = 0;  // within what the differences above leave
    }
    return shape;
}

}  // namespace seampath
