#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Cholesky>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/arm.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/geometry/quadric.hpp"

namespace seampath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Solutions = std::vector<JointAngles>;

// Axes are parallel, or meet, to this (unit vectors; mm).
constexpr double kParallel = 1e-9, kMeet_mm = 1e-5;

// A turn of a vector this short beside what it is turned in is free.
constexpr double kFree = 1e-9;

// Axes that are so nearly in line may be in line but for rounding: the cosine of their angle does not tell.
constexpr double kNearlyFree = 1e-6;

// How far beyond its range a cosine may be by rounding.
constexpr double kBeyond = 1e-12;

// What a solution may be off.
constexpr double kPosition_mm = 1e-7, kRotation = 1e-10;
constexpr int kNewtonSteps = 8;

// Angles of one solution.
constexpr double kSame = 1e-7;

Matrix3d turn(const Vector3d& axis, double angle) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// Subproblem 1: the turn about k that takes p nearest to q.
double turn_to(const Vector3d& k, const Vector3d& p, const Vector3d& q) {
    return std::atan2(k.dot(p.cross(q)), across(p, k).dot(across(q, k)));
}

/// Subproblem 4: the turns about k after which p has the component d along h: none, one, two, or the `free` one where
/// every turn will do.
std::vector<double> turns_along(const Vector3d& h, const Vector3d& k, const Vector3d& p, double d, double free) {
    const double a = h.dot(across(p, k)), b = h.dot(k.cross(p)), c = d - h.dot(k) * k.dot(p), size = std::hypot(a, b);
    const double scale = h.norm() * p.norm() + std::abs(d);
    if (size <= kFree * scale) {
        return std::abs(c) <= kFree * scale ? std::vector<double>{free} : std::vector<double>{};
    }
    const double ratio = c / size;
    if (std::abs(ratio) > 1 + kBeyond) {
        return {};
    }
    const double middle = std::atan2(b, a), half = std::acos(std::clamp(ratio, -1.0, 1.0));
    return half < kFree || half > std::numbers::pi - kFree ? std::vector<double>{middle + half}
                                                           : std::vector<double>{middle + half, middle - half};
}

/// Subproblem 3: the turns about k after which p is at distance d from q.
std::vector<double> turns_at_distance(const Vector3d& k, const Vector3d& p, const Vector3d& q, double d, double free) {
    return turns_along(q, k, p, 0.5 * (p.squaredNorm() + q.squaredNorm() - d * d), free);
}

/// Some unit vector square to k.
Vector3d square_to(const Vector3d& k) {
    return k.unitOrthogonal();
}

/// Where two axes meet, if they do.
std::optional<Vector3d> meeting(const ArmAxis& a, const ArmAxis& b) {
    const Vector3d n = a.direction.cross(b.direction), d = b.point - a.point;
    if (n.norm() < kParallel || std::abs(n.dot(d)) > kMeet_mm * n.norm()) {
        return std::nullopt;
    }
    return a.point + d.cross(b.direction).dot(n) / n.squaredNorm() * a.direction;
}

bool parallel(const ArmAxis& a, const ArmAxis& b) {
    return a.direction.cross(b.direction).norm() < kParallel;
}

bool passes(const ArmAxis& axis, const Vector3d& p) {
    return across(p - axis.point, axis.direction).norm() < kMeet_mm;
}

/// The point of the wrist that the last axes leave where it is.
std::optional<Vector3d> wrist_of(const Arm& arm, ArmKind kind) {
    const auto& x = arm.axes;
    if (kind == ArmKind::three_parallel) {
        return parallel(x[1], x[2]) && parallel(x[1], x[3]) && !parallel(x[0], x[1]) ? meeting(x[4], x[5])
                                                                                     : std::nullopt;
    }
    const auto centre = meeting(x[3], x[4]);
    const bool spherical = centre && passes(x[5], *centre) && !parallel(x[4], x[5]);
    return spherical && parallel(x[1], x[2]) && !parallel(x[0], x[1]) ? centre : std::nullopt;
}

struct Off {
    Eigen::Matrix<double, 6, 1> twist;
    bool small() const { return twist.head<3>().norm() < kPosition_mm && twist.tail<3>().norm() < kRotation; }
};
Off off(const Arm& arm, const Eigen::Isometry3d& target, const JointAngles& q) {
    const Eigen::Isometry3d is = forward(arm, q);
    Off o;
    o.twist << target.translation() - is.translation(),
        rotation_vector(Eigen::Quaterniond(target.linear() * is.linear().transpose()));
    return o;
}

/// What the closed forms share: the axes by short names, and the pose that is asked for.
struct Problem {
    const Arm& arm;
    const Eigen::Isometry3d& asked;
    Vector3d w0;  // wrist point at rest
    Vector3d w;   // where it shall be
    Matrix3d R;   // R_1 ... R_6
    JointAngles reference;

    const Vector3d& h(int axis) const { return arm.axes[static_cast<std::size_t>(axis - 1)].direction; }
    const Vector3d& p(int axis) const { return arm.axes[static_cast<std::size_t>(axis - 1)].point; }

    /// Angles of axis 1: the wrist keeps its component along axis 2.
    std::vector<double> first() const { return turns_along(h(2), -h(1), w - p(1), h(2).dot(w0 - p(1)), reference[0]); }

    /// Angles of axes 2 and 3 that bring a point of link 3 to `target`, axis 1 at rest.
    std::vector<std::array<double, 2>> second_and_third(const Vector3d& point, const Vector3d& target) const {
        std::vector<std::array<double, 2>> all;
        for (const double q3 :
             turns_at_distance(h(3), point - p(3), p(2) - p(3), (target - p(2)).norm(), reference[2])) {
            const Vector3d moved = p(3) + turn(h(3), q3) * (point - p(3));
            const Vector3d from = moved - p(2), to = target - p(2);
            const bool free = across(to, h(2)).norm() <= kFree * (1 + to.norm());
            all.push_back({free ? reference[1] : turn_to(h(2), from, to), q3});
        }
        return all;
    }

    /// Angle of the last axis, whose turn alone is R.
    double sixth(const Matrix3d& R6) const {
        const Vector3d e = square_to(h(6));
        return turn_to(h(6), e, R6 * e);
    }
};

Solutions spherical_wrist(const Problem& a) {
    Solutions all;
    for (const double q1 : a.first()) {
        const Matrix3d R1 = turn(a.h(1), q1);
        const Vector3d v = a.p(1) + R1.transpose() * (a.w - a.p(1));
        for (const auto& [q2, q3] : a.second_and_third(a.w0, v)) {
            const Matrix3d R36 = (R1 * turn(a.h(2), q2) * turn(a.h(3), q3)).transpose() * a.R;
            for (const double q5 : turns_along(a.h(4), a.h(5), a.h(6), a.h(4).dot(R36 * a.h(6)), 0)) {
                const auto with = [&, q2 = q2, q3 = q3](double fourth, double fifth) {
                    const double q6 = a.sixth((turn(a.h(4), fourth) * turn(a.h(5), fifth)).transpose() * R36);
                    return (JointAngles() << q1, q2, q3, fourth, fifth, q6).finished();
                };
                const Vector3d r = turn(a.h(5), q5) * a.h(6);
                if (across(r, a.h(4)).norm() < kNearlyFree) {
                    const double in_line = turn_to(a.h(5), a.h(6), r.dot(a.h(4)) * a.h(4));
                    const JointAngles singular = with(a.reference[3], in_line);
                    if (off(a.arm, a.asked, singular).small()) {
                        all.push_back(singular);
                        continue;
                    }
                }
                all.push_back(with(turn_to(a.h(4), r, R36 * a.h(6)), q5));
            }
        }
    }
    return all;
}

Solutions three_parallel(const Problem& a) {
    Solutions all;
    const double sign3 = a.h(2).dot(a.h(3)), sign4 = a.h(2).dot(a.h(4));
    for (const double q1 : a.first()) {
        const Matrix3d R1 = turn(a.h(1), q1), R26 = R1.transpose() * a.R;
        const Vector3d v = a.p(1) + R1.transpose() * (a.w - a.p(1));
        for (const double q5 : turns_along(a.h(2), a.h(5), a.h(6), a.h(2).dot(R26 * a.h(6)), 0)) {
            const auto add = [&](double fifth, double sixth, bool only_exact) {
                const Matrix3d R234 = R26 * (turn(a.h(5), fifth) * turn(a.h(6), sixth)).transpose();
                const Vector3d e = square_to(a.h(2));
                const double sum = turn_to(a.h(2), e, R234 * e);
                const Vector3d elbow_end = v - turn(a.h(2), sum) * (a.w0 - a.p(4));
                bool added = false;
                for (const auto& [q2, q3] : a.second_and_third(a.p(4), elbow_end)) {
                    const JointAngles q =
                        (JointAngles() << q1, q2, q3, (sum - q2 - sign3 * q3) * sign4, fifth, sixth).finished();
                    if (!only_exact || off(a.arm, a.asked, q).small()) {
                        all.push_back(q);
                        added = true;
                    }
                }
                return added;
            };
            const Vector3d r = turn(a.h(5), q5).transpose() * a.h(2);
            if (across(r, a.h(6)).norm() < kNearlyFree) {
                const double in_line = turn_to(a.h(5), r.dot(a.h(6)) * a.h(6), a.h(2));
                if (add(in_line, a.reference[5], true)) {
                    continue;
                }
            }
            add(q5, turn_to(-a.h(6), r, R26.transpose() * a.h(2)), false);
        }
    }
    return all;
}

/// Newton's method with as little damping as a singular arm needs; nothing when it does not get there.
std::optional<JointAngles> refined(const Arm& arm, const Eigen::Isometry3d& target, JointAngles q) {
    for (int step = 0; step <= kNewtonSteps; ++step) {
        const Off o = off(arm, target, q);
        if (o.small()) {
            return q;
        }
        const Eigen::Matrix<double, 6, 6> J = jacobian(arm, q);
        const Eigen::Matrix<double, 6, 6> JJ = J * J.transpose();
        const Eigen::Matrix<double, 6, 6> damping = 1e-14 * JJ.trace() * Eigen::Matrix<double, 6, 6>::Identity();
        q += J.transpose() * (JJ + damping).ldlt().solve(o.twist);
    }
    return std::nullopt;
}

JointAngles wrapped(JointAngles q) {
    for (int i = 0; i < kArmAxes; ++i) {
        q[i] -= kTurn * std::floor(q[i] / kTurn + 0.5);
    }
    return q;
}

}  // namespace

ArmKind kind_of(const Arm& arm) {
    for (const ArmKind kind : {ArmKind::spherical_wrist, ArmKind::three_parallel}) {
        if (wrist_of(arm, kind)) {
            return kind;
        }
    }
    throw InputError("arm: " + arm.name +
                     " has no wrist whose last three axes meet behind parallel axes 2 and 3, nor parallel axes 2 to 4 "
                     "with axes 5 and 6 meeting; only such arms can be solved; take another arm");
}

std::vector<JointAngles> inverse(const Arm& arm, const Eigen::Isometry3d& base_from_flange,
                                 const JointAngles& reference) {
    const auto w0 = wrist_of(arm, arm.kind);
    ensure(w0.has_value(), "an arm is of its kind");
    const Problem problem{arm,
                          base_from_flange,
                          *w0,
                          base_from_flange * (arm.base_from_flange.inverse() * *w0),
                          base_from_flange.linear() * arm.base_from_flange.linear().transpose(),
                          reference};
    Solutions all;
    for (const JointAngles& q :
         arm.kind == ArmKind::spherical_wrist ? spherical_wrist(problem) : three_parallel(problem)) {
        if (const auto exact = refined(arm, base_from_flange, q)) {
            const JointAngles here = wrapped(*exact);
            const auto same = [&](const JointAngles& other) {
                return (nearest_turns(other, here) - here).cwiseAbs().maxCoeff() < kSame;
            };
            if (std::none_of(all.begin(), all.end(), same)) {
                all.push_back(here);
            }
        }
    }
    return all;
}

}  // namespace seampath
