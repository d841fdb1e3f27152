#include "stages/plan/arm_travel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/angle.hpp"
#include "stages/geometry/piecewise_cubic.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/arm_air.hpp"
#include "stages/plan/arm_shift.hpp"
#include "stages/plan/arm_ways.hpp"
#include "stages/text.hpp"

namespace seampath::planning {
namespace {

// Rolls that are tried, and the most that an axis may turn from one pose of a way to the next, some 5 mm on.
constexpr double kRollStep = 5 * kDegree, kMostStep = 20 * kDegree;

// Whole turns that would bring an axis nearer than this to a limit are not worth a shorter way through the air.
constexpr double kAirMargin = 5 * kDegree;

// Joints are there already.
constexpr double kThere = 1e-9;

/// The largest manipulability over a grid of all axes that count.
double best_manipulability(const Arm& arm) {
    constexpr int kGrid = 5;
    double most = 0;
    const auto angle = [&arm](int axis, int step) {
        const ArmAxis& a = arm.axes[static_cast<std::size_t>(axis)];
        return a.lowest + (a.highest - a.lowest) * (step + 0.5) / kGrid;
    };
    for (int i = 0; i < kGrid; ++i) {
        for (int k = 0; k < kGrid; ++k) {
            for (int l = 0; l < kGrid; ++l) {
                for (int m = 0; m < kGrid; ++m) {
                    const JointAngles q =
                        (JointAngles() << 0, angle(1, i), angle(2, k), angle(3, l), angle(4, m), 0).finished();
                    most = std::max(most, manipulability(arm, q));
                }
            }
        }
    }
    return most;
}

std::array<double, kArmAxes> array_of(const JointAngles& q) {
    std::array<double, kArmAxes> a;
    std::copy(q.data(), q.data() + kArmAxes, a.begin());
    return a;
}

/// One way with what the arm does on it.
struct Way {
    Chain chain;
    Track track;
};

Eigen::Quaterniond rolled(const Eigen::Quaterniond& q, double roll) {
    return (q * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ())).normalized();
}

class Travel {
public:
    Travel(Plan& plan, const ArmCell& cell, const PlanOptions& options) : plan_(plan), cell_(cell), options_(options) {
        result_.arm = cell.arm.name;
        for (std::size_t i = 0; i < kArmAxes; ++i) {
            const ArmAxis& axis = cell.arm.axes[i];
            result_.lowest[i] = axis.lowest;
            result_.highest[i] = axis.highest;
            result_.max_speed[i] = axis.max_speed;
            result_.max_acceleration[i] = options.arm_acceleration_deg_s2.at(i) * kDegree;
            acceleration_[static_cast<Eigen::Index>(i)] = result_.max_acceleration[i];
        }
    }

    void make() {
        if (make_ways()) {
            bring_turns_together();
            turn_waypoints();
            if (make_samples()) {
                judge();
                plan_.waypoints = std::move(turned_);
            } else {
                result_.samples.clear();
            }
        }
        plan_.arm = std::move(result_);
    }

private:
    bool make_ways() {
        const TrackOptions options = track_options(cell_.arm, options_);
        for (const auto& [first, last] : ways_of(plan_.waypoints)) {
            Way way{chain_of(plan_.waypoints, first, last, cell_), {}};
            auto found = track(way.chain, cell_, options);
            if (const auto* stop = std::get_if<Stop>(&found)) {
                refuse(way.chain.at(stop->pose).at, stop->why);
                look_for_shift();
                return false;
            }
            way.track = std::get<Track>(std::move(found));
            ways_.push_back(std::move(way));
        }
        return true;
    }

    void refuse(const Waypoint& at, const std::string& why) {
        result_.verdict = result_.arm + " can't make seam " + std::to_string(at.seam) + ": at " +
                          std::string(name(at.kind)) + ", station " + fixed(at.station_mm, 1) + " mm, " + why;
    }

    void look_for_shift() {
        result_.shift_mm = helpful_shift(plan_.waypoints, cell_, options_);
        if (result_.shift_mm) {
            const Eigen::Vector3d& s = *result_.shift_mm;
            result_.verdict += "; with the part moved by " + fixed(s.norm(), 1) + " mm, (" + fixed(s.x(), 1) + ", " +
                               fixed(s.y(), 1) + ", " + fixed(s.z(), 1) +
                               ") in the base (export.base_from_scan), it can";
        } else {
            result_.verdict +=
                "; no move of the part by up to 2 m (export.base_from_scan) was found that helps; plan.arm and "
                "plan.flange_from_tool say what reaches there";
        }
    }

    /// Each way by whole turns as near to the one before as the limits let it.
    void bring_turns_together() {
        for (std::size_t w = 1; w < ways_.size(); ++w) {
            auto& q = ways_[w].track.q;
            const JointAngles before = ways_[w - 1].track.q.back();
            for (int i = 0; i < kArmAxes; ++i) {
                const double turns = std::round((before[i] - q.front()[i]) / kTurn) * kTurn;
                const ArmAxis& axis = cell_.arm.axes[static_cast<std::size_t>(i)];
                const bool fits = std::all_of(q.begin(), q.end(), [&](const JointAngles& a) {
                    return a[i] + turns >= axis.lowest + kAirMargin && a[i] + turns <= axis.highest - kAirMargin;
                });
                for (JointAngles& a : q) {
                    a[i] += fits ? turns : 0;
                }
            }
        }
    }

    /// Turns the waypoints of each way about the wire; where the roll changes, every pose of the weld becomes one.
    void turn_waypoints() {
        std::vector<Waypoint>& all = turned_;
        std::size_t next = 0;
        const auto take_until = [&](std::size_t end) {
            for (; next < end; ++next) {
                all.push_back(plan_.waypoints[next]);
            }
        };
        for (Way& way : ways_) {
            take_until(static_cast<std::size_t>(way.chain.front().waypoint));
            const bool every = !way.track.constant_roll();
            for (std::size_t k = 0; k < way.chain.size(); ++k) {
                ChainPose& pose = way.chain[k];
                pose.at.q = rolled(pose.at.q, way.track.roll[k]);
                result_.max_roll = std::max(result_.max_roll, std::abs(way.track.roll[k]));
                next = pose.waypoint >= 0 ? static_cast<std::size_t>(pose.waypoint) + 1 : next;
                if (pose.waypoint >= 0 || (every && pose.at.kind == WaypointKind::weld)) {
                    pose.waypoint = static_cast<int>(all.size());
                    all.push_back(pose.at);
                }
            }
        }
        take_until(plan_.waypoints.size());
        for (std::size_t k = 1; k + 1 < all.size(); ++k) {
            if (all[k].kind == WaypointKind::air) {
                all[k].q = all[k - 1].q.slerp(0.5, nearest_sign(all[k + 1].q, all[k - 1].q));
            }
        }
    }

    bool make_samples() {
        double time = 0;
        for (std::size_t w = 0; w < ways_.size(); ++w) {
            const Way& way = ways_[w];
            if (w > 0 && !add_air_move(ways_[w - 1], way, time)) {
                return false;
            }
            const double start = way.chain.front().at.time_s;
            for (std::size_t k = 0; k < way.chain.size(); ++k) {
                const ChainPose& pose = way.chain[k];
                add(pose.at, pose.waypoint, time + pose.at.time_s - start, way.track.q[k], way.track.roll[k]);
            }
            time = result_.samples.back().time_s;
            add_accelerations(way);
        }
        result_.duration_s = time;
        return true;
    }

    void add(const Waypoint& at, int waypoint, double time, const JointAngles& q, double roll) {
        result_.samples.push_back(
            {at.seam, at.kind, waypoint, at.station_mm, time, array_of(q), roll, manipulability(cell_.arm, q)});
    }

    /// From one way's end to the next one's beginning; false where the point in the air can't be reached.
    bool add_air_move(const Way& from, const Way& to, double& time) {
        std::vector<JointAngles> points{from.track.q.back()};
        const int via = from.chain.back().waypoint + 1;
        const bool over_air = via < to.chain.front().waypoint;
        if (over_air) {
            Waypoint& air = turned_[static_cast<std::size_t>(via)];
            const auto q = posture_in_air(air, 0.5 * (from.track.q.back() + to.track.q.front()));
            if (!q) {
                refuse(air, "no posture within the axes' limits reaches the point over which the torch goes there");
                return false;
            }
            points.push_back(*q);
        }
        points.push_back(to.track.q.front());
        const auto same = [](const JointAngles& a, const JointAngles& b) {
            return (a - b).cwiseAbs().maxCoeff() < kThere;
        };
        points.erase(std::unique(points.begin(), points.end(), same), points.end());
        if (points.size() < 2) {
            return true;
        }
        const JointMove move = joint_move(cell_.arm, points, acceleration_);
        Waypoint at = to.chain.front().at;
        at.kind = WaypointKind::air;
        for (std::size_t k = 1; k + 1 < move.q.size(); ++k) {
            const bool in_air = over_air && points.size() == 3 && k == move.at_point[1];
            add(at, in_air ? via : -1, time + move.time_s[k], move.q[k], to.track.roll.front());
        }
        time += move.time_s.back();
        return true;
    }

    std::optional<JointAngles> posture_at(const Waypoint& at, const JointAngles& middle) const {
        const Eigen::Isometry3d pose = cell_.base_from_scan * (Eigen::Translation3d(at.p) * at.q);
        std::optional<JointAngles> best;
        double least = 1e300;
        for (const JointAngles& q : inverse(cell_.arm, pose * cell_.flange_from_tool.inverse(), middle)) {
            for (const JointAngles& way : within_limits(cell_.arm, q)) {
                const double off = (way - middle).cwiseAbs().maxCoeff();
                if (off < least) {
                    least = off;
                    best = way;
                }
            }
        }
        return best;
    }

    /// The posture nearest to `middle`; the torch is turned about its wire where it takes that, as little as that
    /// takes.
    std::optional<JointAngles> posture_in_air(Waypoint& air, const JointAngles& middle) const {
        const Eigen::Quaterniond q = air.q;
        for (double roll = 0; roll <= options_.arm_roll_deg * kDegree; roll += kRollStep) {
            for (const double way : {roll, -roll}) {
                air.q = rolled(q, way);
                if (auto posture = posture_at(air, middle)) {
                    return posture;
                }
            }
        }
        air.q = q;
        return std::nullopt;
    }

    /// Of natural cubic splines through the axes' angles along the weld, over time: Marin's measure.
    void add_accelerations(const Way& way) {
        std::vector<double> t;
        std::array<std::vector<double>, kArmAxes> y;
        for (std::size_t k = 0; k < way.chain.size(); ++k) {
            const Waypoint& at = way.chain[k].at;
            const bool weld = at.kind == WaypointKind::weld || at.kind == WaypointKind::weld_end;
            const bool begins = at.kind == WaypointKind::weld_start && way.chain[k].waypoint >= 0;
            if ((weld || begins) && (t.empty() || at.time_s > t.back())) {
                t.push_back(at.time_s);
                for (std::size_t i = 0; i < kArmAxes; ++i) {
                    y[i].push_back(way.track.q[k][static_cast<Eigen::Index>(i)]);
                }
            }
        }
        for (std::size_t i = 0; i < kArmAxes && t.size() > 2; ++i) {
            const PiecewiseCubic spline = natural_spline(t, y[i]);
            for (const double c : spline.c) {
                result_.acceleration_share[i] =
                    std::max(result_.acceleration_share[i], 2 * std::abs(c) / result_.max_acceleration[i]);
            }
        }
    }

    void judge() {
        result_.least_margin = kTurn;
        result_.least_manipulability = result_.samples.front().manipulability;
        for (std::size_t k = 0; k < result_.samples.size(); ++k) {
            const ArmSample& s = result_.samples[k];
            result_.least_margin = std::min(result_.least_margin, limit_margin(cell_.arm, JointAngles(s.q.data())));
            result_.least_manipulability = std::min(result_.least_manipulability, s.manipulability);
            const double time = k > 0 ? s.time_s - result_.samples[k - 1].time_s : 0;
            for (std::size_t i = 0; time > 0 && i < kArmAxes; ++i) {
                const double speed = std::abs(s.q[i] - result_.samples[k - 1].q[i]) / time;
                result_.speed_share[i] = std::max(result_.speed_share[i], speed / result_.max_speed[i]);
            }
        }
        const auto largest = [](const std::array<double, kArmAxes>& shares) {
            return std::max_element(shares.begin(), shares.end()) - shares.begin();
        };
        const auto text = [&](const std::array<double, kArmAxes>& shares) {
            const auto i = largest(shares);
            return fixed(100 * shares[static_cast<std::size_t>(i)], 1) + " % of that of axis " + std::to_string(i + 1);
        };
        const auto accelerated = static_cast<std::size_t>(largest(result_.acceleration_share));
        const double acceleration = result_.acceleration_share[accelerated];
        result_.pass = acceleration <= 1;
        result_.verdict =
            result_.arm +
            (result_.pass ? " makes the travel, with the torch turned about its wire by up to "
                          : " reaches all of the travel, with the torch turned about its wire by up to ") +
            fixed(result_.max_roll / kDegree, 1) + " deg: axes stay " + fixed(result_.least_margin / kDegree, 1) +
            " deg or more within their limits, the largest speed is " + text(result_.speed_share) +
            ", the largest acceleration while welding " + text(result_.acceleration_share);
        if (!result_.pass) {
            result_.verdict += ", too much: plan.speed_mm_s of " +
                               fixed(0.999 * options_.speed_mm_s / std::sqrt(acceleration), 3) + " or less is needed";
        }
    }

    Plan& plan_;
    const ArmCell& cell_;
    const PlanOptions& options_;
    ArmTravel result_;
    JointAngles acceleration_;
    std::vector<Way> ways_;
    std::vector<Waypoint> turned_;
};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> ways_of(const std::vector<Waypoint>& waypoints) {
    std::vector<std::pair<std::size_t, std::size_t>> ways;
    std::size_t first = 0;
    const auto is = [&](std::size_t k, WaypointKind kind) { return k < waypoints.size() && waypoints[k].kind == kind; };
    for (std::size_t k = 0; k < waypoints.size(); ++k) {
        // A lead-in begins with a second approach, a lead-out ends before a second retract.
        if (is(k, WaypointKind::approach) && (k == 0 || !is(k - 1, WaypointKind::approach))) {
            first = k;
        } else if (is(k, WaypointKind::retract) && !is(k + 1, WaypointKind::retract)) {
            ways.emplace_back(first, k);
        }
    }
    return ways;
}

TrackOptions track_options(const Arm& arm, const PlanOptions& options) {
    return {options.arm_roll_deg * kDegree, kRollStep, kMostStep, true, false, best_manipulability(arm)};
}

void add_arm(Plan& plan, const ArmCell& cell, const PlanOptions& options) {
    Travel(plan, cell, options).make();
}

}  // namespace seampath::planning
