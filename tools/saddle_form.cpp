#include "tools/saddle_form.hpp"

#include <limits>

#include <Eigen/Cholesky>

#include "stages/geometry/bspline.hpp"
#include "stages/geometry/rigid.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

// Points of the seam that are laid on the saddle, and steps of Gauss and Newton for it.
constexpr int kPoints = 180, kFormSteps = 12;

// Of the mean square lever: keeps turns that a seam does not feel, such as that of a circle in itself, out of a step.
constexpr double kDamping = 1e-9;

double square_error(const Isometry3d& T, const Points& from, const Points& to) {
    double sum = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        sum += (T * from[i] - to[i]).squaredNorm();
    }
    return sum;
}

/// Stations of the saddle, one for each of as many points at equal steps of the seam: where the seam may begin, and
/// which way round it runs, are tried out.
std::vector<double> first_stations(const Points& seam, const SaddleCurve& saddle) {
    const double step = saddle.length() / kPoints;
    Points places;
    for (int k = 0; k < kPoints; ++k) {
        places.push_back(saddle.at(saddle.theta(step * k)).p);
    }
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> best;
    for (const int way : {1, -1}) {
        for (int begin = 0; begin < kPoints; ++begin) {
            Points to;
            std::vector<double> station;
            for (int i = 0; i < kPoints; ++i) {
                const int k = ((begin + way * i) % kPoints + kPoints) % kPoints;
                to.push_back(places[static_cast<std::size_t>(k)]);
                station.push_back(step * k);
            }
            const double error = square_error(rigid_through(seam, to), seam, to);
            if (error < least) {
                least = error;
                best = std::move(station);
            }
        }
    }
    return best;
}

/// The step that brings T's points nearer to the saddle square to it, where each may slide to its nearest place.
Vector6 step_towards(const SaddleCurve& saddle, const Isometry3d& T, const Points& seam, std::vector<double>& station) {
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    for (std::size_t i = 0; i < seam.size(); ++i) {
        const Vector3d p = T * seam[i];
        const SaddlePoint before = saddle.at(saddle.theta(station[i]));
        station[i] += (p - before.p).dot(before.tangent);
        const SaddlePoint at = saddle.at(saddle.theta(station[i]));
        const Eigen::Matrix3d square = Eigen::Matrix3d::Identity() - at.tangent * at.tangent.transpose();
        Eigen::Matrix<double, 3, 6> J;
        J << square, -square * cross_matrix(p);
        H += J.transpose() * J;
        g += J.transpose() * square * (at.p - p);
    }
    H.diagonal().array() += kDamping * H.trace();
    return H.ldlt().solve(g);
}

Isometry3d saddle_from_seam(const CubicBSpline& seam, const SaddleCurve& saddle) {
    const ArcLength arc(seam);
    Points points, places;
    for (int i = 0; i < kPoints; ++i) {
        points.push_back(position(seam, arc.parameter(arc.length() * i / kPoints)));
    }
    std::vector<double> station = first_stations(points, saddle);
    for (const double s : station) {
        places.push_back(saddle.at(saddle.theta(s)).p);
    }
    Isometry3d T = rigid_through(points, places);
    for (int step = 0; step < kFormSteps; ++step) {
        T = displaced(T, step_towards(saddle, T, points, station), Vector3d::Zero());
    }
    return T;
}

}  // namespace

Points form_differences(const CubicBSpline& seam, const SaddleCurve& saddle, const std::vector<double>& thetas) {
    const Isometry3d T = saddle_from_seam(seam, saddle), back = T.inverse();
    Points differences;
    for (const double theta : thetas) {
        const SaddlePoint at = saddle.at(theta);
        const Vector3d off = T * position(seam, nearest_parameter(seam, back * at.p)) - at.p;
        differences.push_back(off - off.dot(at.tangent) * at.tangent);
    }
    return differences;
}

}  // namespace seampath
