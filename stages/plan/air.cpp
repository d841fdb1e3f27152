#include "stages/plan/air.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/angle.hpp"
#include "stages/geometry/pose.hpp"

namespace seampath::planning {
namespace {

using Seams = std::vector<std::vector<Waypoint>>;

double distance_to_seams(const Seams& seams, const Eigen::Vector3d& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& seam : seams) {
        for (std::size_t k = 0; k + 1 < seam.size(); ++k) {
            nearest = std::min(nearest, distance_to_segment(p, seam[k].p, seam[k + 1].p));
        }
    }
    return nearest;
}

// Whether the straight move keeps `clearance_mm`, looked at in steps of a tenth of it.
bool clear(const Seams& seams, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double clearance_mm) {
    const int steps = static_cast<int>(std::ceil(10 * (b - a).norm() / clearance_mm)) + 1;
    for (int i = 0; i <= steps; ++i) {
        if (distance_to_seams(seams, a + (b - a) * i / steps) < clearance_mm * (1 - 1e-6)) {
            return false;
        }
    }
    return true;
}

Eigen::Vector3d away_from_joint(const Waypoint& w) {
    return w.q * -Eigen::Vector3d::UnitZ();
}

// Between the directions in which both torches back off; where these oppose each other, square to them and away from
// the seams' middle.
Eigen::Vector3d lift_direction(const Waypoint& retract, const Waypoint& approach, const Seams& seams) {
    const Eigen::Vector3d back = away_from_joint(retract);
    const Eigen::Vector3d sum = back + away_from_joint(approach);
    if (sum.norm() > 0.1) {
        return sum.normalized();
    }
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double count = 0;
    for (const auto& seam : seams) {
        for (const Waypoint& w : seam) {
            middle += w.p;
            ++count;
        }
    }
    const Eigen::Vector3d outwards = 0.5 * (retract.p + approach.p) - middle / count;
    const Eigen::Vector3d square = outwards - outwards.dot(back) * back;
    return square.norm() > 1e-6 ? square.normalized() : retract.q * Eigen::Vector3d::UnitX();
}

// Turns of the direction in which the torch backs off, and how many directions round it are tried at each.
constexpr double kBackStep = 15 * kDegree, kBackMost = 60 * kDegree;
constexpr int kBackDirections = 12;

}  // namespace

std::optional<Waypoint> backed_off(const Waypoint& w, WaypointKind kind, double back_mm, double speed_mm_s,
                                   const Clearance* clearance) {
    Waypoint away = w;
    away.kind = kind;
    away.speed_mm_s = speed_mm_s;
    const auto free_in = [&](const Eigen::Vector3d& back) {
        away.p = w.p + back_mm * back;
        return clearance == nullptr || clearance->way_is_free(w, away);
    };
    const Eigen::Vector3d back = away_from_joint(w);
    if (free_in(back)) {
        return away;
    }
    for (double turn = kBackStep; turn <= kBackMost; turn += kBackStep) {
        for (int k = 0; k < kBackDirections; ++k) {
            const Eigen::AngleAxisd round(kTurn * k / kBackDirections, back);
            if (free_in(Eigen::AngleAxisd(turn, round * (w.q * Eigen::Vector3d::UnitX())) * back)) {
                return away;
            }
        }
    }
    return std::nullopt;
}

std::optional<Waypoint> air_point(const Waypoint& retract, const Waypoint& approach, const Seams& seams,
                                  double clearance_mm, const Clearance* clearance) {
    const auto free = [&](const Waypoint& from, const Waypoint& to, double keep) {
        return clear(seams, from.p, to.p, keep) && (clearance == nullptr || clearance->way_is_free(from, to));
    };
    const double keep =
        std::min({clearance_mm, distance_to_seams(seams, retract.p), distance_to_seams(seams, approach.p)});
    if (keep <= 0 || free(retract, approach, keep)) {
        return std::nullopt;
    }
    const Eigen::Vector3d up = lift_direction(retract, approach, seams);
    const Eigen::Vector3d middle = 0.5 * (retract.p + approach.p);
    Waypoint air = approach;
    air.kind = WaypointKind::air;
    air.q = retract.q.slerp(0.5, approach.q);
    // Five doublings reach 32 clearances; where that is not enough no single point is, and the highest is the best.
    double height = clearance_mm;
    for (int doubling = 0; doubling <= 5; ++doubling, height *= 2) {
        air.p = middle + height * up;
        if (free(retract, air, keep) && free(air, approach, keep)) {
            break;
        }
    }
    return air;
}

}  // namespace seampath::planning
