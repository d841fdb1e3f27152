#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/calibrate/frame_solver.hpp"
#include "stages/text.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Vector3d;

// Below this share of a direction's length its turn is none.
constexpr double kNoTurn = 0.05;

Vector3d with_sign(const Vector3d& d) {
    Eigen::Index largest = 0;
    d.cwiseAbs().maxCoeff(&largest);
    return d[largest] < 0 ? Vector3d(-d) : d;
}

std::string text_of(const Vector3d& v, int decimals) {
    return "(" + fixed(v.x(), decimals) + ", " + fixed(v.y(), decimals) + ", " + fixed(v.z(), decimals) + ")";
}

// Of a direction (v, length * w) about the reference.
Weakness weakness_of(const Vector6& x, const Solution& s) {
    const Eigen::Matrix3d R = s.T.linear();
    const Vector3d v = R.transpose() * x.head<3>(), w = R.transpose() * x.tail<3>() / s.reference.length;
    Weakness weak;
    weak.turn = x.tail<3>().norm() > kNoTurn;
    if (!weak.turn) {
        weak.direction = with_sign(v.normalized());
        weak.text = "shift along " + text_of(weak.direction, 3);
        return weak;
    }
    const Vector3d about = s.T.inverse() * s.reference.about;
    weak.direction = with_sign(w.normalized());
    weak.centre = about + w.cross(v) / w.squaredNorm();
    weak.pitch_mm = v.dot(w) / w.squaredNorm();
    weak.text = "turn about " + text_of(weak.direction, 3) + " through " + text_of(weak.centre, 1);
    if (std::abs(weak.pitch_mm) > kNoTurn * s.reference.length) {
        weak.text += ", with " + fixed(weak.pitch_mm, 1) + " mm a radian along it";
    }
    return weak;
}

}  // namespace

// Any basis of what is open would do; the one named holds as many pure shifts as there are.
std::vector<Weakness> weaknesses(const Solution& s) {
    std::vector<Weakness> named;
    if (s.weak.cols() == 0) {
        return named;
    }
    const Eigen::MatrixXd turns = s.weak.bottomRows<3>();
    const Eigen::MatrixXd squares = turns.transpose() * turns;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(squares);
    const Eigen::MatrixXd& V = eigen.eigenvectors();
    for (Eigen::Index i = 0; i < s.weak.cols(); ++i) {
        Weakness weak = weakness_of(s.weak * V.col(i), s);
        for (Eigen::Index k = 0; k < V.rows(); ++k) {
            weak.share += V(k, i) * V(k, i) * s.weak_share[static_cast<std::size_t>(k)];
        }
        named.push_back(weak);
    }
    return named;
}

}  // namespace seampath::calibrating
