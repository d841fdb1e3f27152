#include "stages/plan/tilt.hpp"

#include <algorithm>
#include <cmath>

#include "stages/angle.hpp"

namespace seampath::planning {
namespace {

using Eigen::Vector3d;

// Of the same direction, the angle nearest to one before.
double near(double angle, double before) {
    return angle - kTurn * std::round((angle - before) / kTurn);
}

// The largest function below `value` that changes by no more than the rate; `sign` -1: the least one above it.
std::vector<double> envelope(const std::vector<double>& value, const std::vector<double>& station, double rate,
                             double sign) {
    std::vector<double> result = value;
    const auto limit = [&](std::size_t k, std::size_t from) {
        const double bound = sign * result[from] + rate * std::abs(station[k] - station[from]);
        result[k] = sign * std::min(sign * result[k], bound);
    };
    for (std::size_t k = 1; k < result.size(); ++k) {
        limit(k, k - 1);
    }
    for (std::size_t k = result.size() - 1; k-- > 0;) {
        limit(k, k + 1);
    }
    return result;
}

// What makes an angle keep the rate. Round a closed seam it has gone on by its last less its first.
std::vector<double> change_of(const std::vector<double>& angle, const std::vector<double>& station, double rate,
                              bool closed) {
    std::vector<double> a, s;
    const std::size_t size = angle.size(), rounds = closed ? 3 : 1;
    for (std::size_t round = 0; round < rounds; ++round) {
        for (std::size_t k = round > 0 ? 1 : 0; k < size; ++k) {
            a.push_back(angle[k] + static_cast<double>(round) * (angle.back() - angle.front()));
            s.push_back(station[k] + static_cast<double>(round) * station.back());
        }
    }
    const std::vector<double> below = envelope(a, s, rate, 1), above = envelope(a, s, rate, -1);
    const std::size_t first = closed ? size - 1 : 0;
    std::vector<double> change;
    for (std::size_t k = first; k < first + size; ++k) {
        change.push_back(0.5 * (below[k] + above[k]) - a[k]);
    }
    return change;
}

}  // namespace

std::vector<Vector3d> least_turning(const std::vector<Place>& places, const Vector3d& start) {
    std::vector<Vector3d> r{(start - start.dot(places.front().x) * places.front().x).normalized()};
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
        const Place &from = places[k], &to = places[k + 1];
        const Vector3d v1 = to.p - from.p;
        const double c1 = v1.squaredNorm();
        const Vector3d r_left = r.back() - 2 / c1 * v1.dot(r.back()) * v1;
        const Vector3d t_left = from.x - 2 / c1 * v1.dot(from.x) * v1;
        const Vector3d v2 = to.x - t_left;
        r.push_back((r_left - 2 / v2.squaredNorm() * v2.dot(r_left) * v2).normalized());
    }
    return r;
}

LeanChange smoothed(const std::vector<Place>& places, const std::vector<double>& stations, double rate, bool closed) {
    const std::vector<Vector3d> r = least_turning(places, places.front().wire);
    std::vector<double> work, travel;
    for (std::size_t k = 0; k < places.size(); ++k) {
        const auto& [p, x, wire] = places[k];
        const double angle = std::atan2(wire.dot(x.cross(r[k])), wire.dot(r[k]));
        work.push_back(work.empty() ? angle : near(angle, work.back()));
        travel.push_back(std::asin(std::clamp(wire.dot(x), -1.0, 1.0)));
    }
    return {change_of(work, stations, rate, closed), change_of(travel, stations, rate, closed)};
}

std::vector<double> least_turning_roll(const std::vector<Eigen::Quaterniond>& q) {
    std::vector<double> roll{0};
    Eigen::Quaterniond tool = q.front();
    for (std::size_t k = 1; k < q.size(); ++k) {
        const Vector3d from = tool * Vector3d::UnitZ(), to = q[k] * Vector3d::UnitZ();
        tool = Eigen::Quaterniond::FromTwoVectors(from, to) * tool;
        const Vector3d x = q[k].conjugate() * (tool * Vector3d::UnitX());
        roll.push_back(near(std::atan2(x.y(), x.x()), roll.back()));
    }
    return roll;
}

}  // namespace seampath::planning
