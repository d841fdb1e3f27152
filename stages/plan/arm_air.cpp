#include "stages/plan/arm_air.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/geometry/parametrize.hpp"
#include "stages/geometry/piecewise_cubic.hpp"

namespace seampath::planning {
namespace {

// Times at which the limits are looked at, and every how many of them is handed out.
constexpr int kLooks = 400, kEvery = 20;

// What may lie between two looks.
constexpr double kSlack = 1.002;

// Of all axes, through the points at those parameters, from 0 to 1.
struct Splines {
    std::vector<double> t;
    std::array<PiecewiseCubic, kArmAxes> axes;
};

Splines splines_of(const std::vector<JointAngles>& points, const JointAngles& max_acceleration) {
    std::vector<Eigen::VectorXd> rows(points.begin(), points.end());
    ParametrizeOptions options;
    options.objective = Objective::minimax;
    options.limits.assign(max_acceleration.data(), max_acceleration.data() + kArmAxes);
    Splines splines{parametrize(rows, options).t, {}};
    for (int i = 0; i < kArmAxes; ++i) {
        std::vector<double> y;
        for (const JointAngles& q : points) {
            y.push_back(q[i]);
        }
        splines.axes[static_cast<std::size_t>(i)] = natural_spline(splines.t, y);
    }
    return splines;
}

JointAngles at(const Splines& splines, double s) {
    JointAngles q;
    for (int i = 0; i < kArmAxes; ++i) {
        q[i] = splines.axes[static_cast<std::size_t>(i)].value(s);
    }
    return q;
}

double law(double u) {
    return u * u * u * (10 + u * (6 * u - 15));
}

// The u of a value of the law, which rises from 0 to 1.
double inverse_law(double s) {
    double low = 0, high = 1;
    while (high - low > 1e-15) {
        const double middle = 0.5 * (low + high);
        (law(middle) < s ? low : high) = middle;
    }
    return low;
}

double shortest_time(const Arm& arm, const Splines& splines, const JointAngles& max_acceleration) {
    double time = 0;
    for (int k = 0; k <= kLooks; ++k) {
        const double u = static_cast<double>(k) / kLooks, s = law(u);
        const double ds = 30 * u * u * (1 - u) * (1 - u), dds = 60 * u * (1 - u) * (1 - 2 * u);
        for (int i = 0; i < kArmAxes; ++i) {
            const auto axis = static_cast<std::size_t>(i);
            const double slope = splines.axes[axis].slope(s);
            const double acceleration = splines.axes[axis].second(s) * ds * ds + slope * dds;
            time = std::max({time, std::abs(slope * ds) / arm.axes[axis].max_speed,
                             std::sqrt(std::abs(acceleration) / max_acceleration[i])});
        }
    }
    return kSlack * time;
}

}  // namespace

JointMove joint_move(const Arm& arm, const std::vector<JointAngles>& points, const JointAngles& max_acceleration) {
    const Splines splines = splines_of(points, max_acceleration);
    const double time = shortest_time(arm, splines, max_acceleration);
    JointMove move;
    const auto add = [&](double u, const JointAngles& q) {
        move.time_s.push_back(u * time);
        move.q.push_back(q);
    };
    bool inside = true;
    for (int k = 0; k <= kLooks; ++k) {
        const double u = static_cast<double>(k) / kLooks;
        inside = inside && limit_margin(arm, at(splines, law(u))) >= 0;
        if (k % kEvery != 0) {
            continue;
        }
        for (std::size_t next = move.at_point.size(); next < points.size(); ++next) {
            const double there = next == 0 ? 0 : next + 1 == points.size() ? 1 : inverse_law(splines.t[next]);
            if (there > u) {
                break;
            }
            move.at_point.push_back(move.q.size());
            add(there, points[next]);
        }
        if (move.time_s.back() < u * time) {
            add(u, at(splines, law(u)));
        }
    }
    if (inside || points.size() == 2) {
        return move;
    }
    JointMove halting{{0}, {points.front()}, {0}};
    for (std::size_t k = 1; k < points.size(); ++k) {
        const JointMove part = joint_move(arm, {points[k - 1], points[k]}, max_acceleration);
        const double from = halting.time_s.back();
        for (std::size_t i = 1; i < part.q.size(); ++i) {
            halting.time_s.push_back(from + part.time_s[i]);
            halting.q.push_back(part.q[i]);
        }
        halting.at_point.push_back(halting.q.size() - 1);
    }
    return halting;
}

}  // namespace seampath::planning
