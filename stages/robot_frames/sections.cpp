#include "stages/robot_frames/sections.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/least_squares.hpp"
#include "stages/text.hpp"

namespace seampath::robot_frames {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kLeastPoints = 10;
constexpr double kSurelyLarger = 5;     // sigma
constexpr double kLeastArcSigma = 0.1;  // of the radius; a shorter arc than that is nearly straight

}  // namespace

BallSection section_of(const BallProfile& profile, double ball_radius_mm) {
    const std::string who = "profiler: " + profile.flange.name;
    if (profile.points.size() < kLeastPoints) {
        throw InputError(who + ": " + std::to_string(profile.points.size()) +
                         " points are too few for a section of the ball; at least 10 were needed");
    }
    std::vector<Vector3d> flat;
    for (const Vector2d& p : profile.points) {
        flat.emplace_back(p.x(), p.y(), 0);
    }
    const Associated<Circle> circle = associated_circle(flat, who);
    BallSection section{circle.shape.centre.head<2>(), circle.shape.radius, Matrix3d::Zero()};
    Matrix3d H = Matrix3d::Zero();
    double squares = 0;
    for (const Vector2d& p : profile.points) {
        const Vector2d v = p - section.centre;
        const Vector3d J(-v.x() / v.norm(), -v.y() / v.norm(), -1);
        H += J * J.transpose();
        squares += std::pow(v.norm() - section.radius, 2);
    }
    section.covariance = squares / static_cast<double>(profile.points.size() - 3) * H.inverse();
    const double sigma = std::sqrt(section.covariance(2, 2));
    if (!(sigma < kLeastArcSigma * section.radius)) {
        throw InputError(who +
                         ": its points make no circle; points of the ball alone, over a good part of its section, "
                         "were needed");
    }
    if (section.radius - kSurelyLarger * sigma > ball_radius_mm) {
        throw InputError(who + ": a section of " + fixed(section.radius, 3) + " mm radius is larger than the ball's " +
                         shortest(ball_radius_mm) +
                         " mm; check the ball's diameter, and leave out what is not the ball");
    }
    return section;
}

}  // namespace seampath::robot_frames
