#include "stages/calibrate/fit_quality.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <Eigen/Dense>

#include "stages/calibrate/chance.hpp"
#include "stages/calibrate/frame_quality.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kOneFace = 0.966;         // cosine of 15 degrees between neighbouring surfels
constexpr double kNeighbour = 1.8;         // of the spacing
constexpr std::size_t kFewestBlocks = 40;  // a covariance of six from fewer is a guess
constexpr double kLeastFace = 0.01;        // of the points, for a face of its own

/// What one group of contacts adds: the sums, and the score by which clusters are told.
struct FaceSums {
    Sums sums;
    Vector6 score = Vector6::Zero();
    double squares = 0, weight = 0;
    Vector3d middle{0, 0, 0}, push{0, 0, 0};  ///< base frame: of the points, and sum of distance times normal
    Vector6 lean = Vector6::Zero();           ///< sum of rows: how the mean distance goes with a step
    std::size_t count = 0;
};

void add_contact(const FrameFit& fit, const Contact& c, const Vector3d& p, FaceSums& face) {
    const double x = c.distance / fit.gate_mm, s = fit.scale_mm;
    const Vector6 J = contact_row(c, p, fit.reference.about);
    face.sums.H += tukey_slope(x) / (s * s) * J * J.transpose();
    face.sums.g -= tukey_weight(x) * c.distance / (s * s) * J;
    face.sums.chi2 += tukey_weight(x) * c.distance * c.distance / (s * s);
    face.squares += tukey_weight(x) * c.distance * c.distance;
    face.weight += tukey_weight(x);
    face.middle += p;
    face.push += tukey_weight(x) * c.distance * c.normal;
    face.lean += tukey_weight(x) * J;
    ++face.count;
}

// Surfels joined to neighbours that lean alike; the number of the face of each.
std::vector<std::size_t> faces_of(const TargetSurface& surface) {
    const auto& surfels = surface.surfels();
    std::vector<std::size_t> parent(surfels.size());
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto root = [&](std::size_t i) {
        while (parent[i] != i) {
            i = parent[i] = parent[parent[i]];
        }
        return i;
    };
    const double reach = kNeighbour * surface.spacing();
    const SurfelGrid grid(surfels, reach);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        for (const std::uint32_t k : grid.near(surfels[i].p)) {
            if ((surfels[k].p - surfels[i].p).squaredNorm() < reach * reach &&
                surfels[k].n.dot(surfels[i].n) > kOneFace) {
                const std::size_t a = root(i), b = root(k);
                parent[std::max(a, b)] = std::min(a, b);
            }
        }
    }
    std::vector<std::size_t> face(surfels.size());
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        face[i] = root(i);
    }
    return face;
}

// Errors within a block of the part may be shared by its points; those of different blocks are not. The largest blocks
// of which there are enough see most of what is shared.
Matrix6 clustered(const TargetSurface& surface, std::span<const SidedPoint> points, const FrameFit& fit) {
    Matrix6 largest = Matrix6::Zero();
    const Isometry3d back = fit.base_from_part.inverse();
    for (double size = 2 * surface.spacing();; size *= 2) {
        std::map<std::array<std::int64_t, 3>, Vector6> blocks;
        for (const Contact& c : fit.contacts) {
            const Vector3d at = back * points[c.point].p / size;
            const std::array<std::int64_t, 3> key{static_cast<std::int64_t>(std::floor(at.x())),
                                                  static_cast<std::int64_t>(std::floor(at.y())),
                                                  static_cast<std::int64_t>(std::floor(at.z()))};
            const double pull = tukey_weight(c.distance / fit.gate_mm) * c.distance / (fit.scale_mm * fit.scale_mm);
            blocks.try_emplace(key, Vector6::Zero()).first->second +=
                pull * contact_row(c, points[c.point].p, fit.reference.about);
        }
        if (blocks.size() < kFewestBlocks && largest.trace() > 0) {
            return largest;
        }
        Matrix6 B = Matrix6::Zero();
        for (const auto& [key, score] : blocks) {
            B += score * score.transpose();
        }
        const double n = static_cast<double>(blocks.size());
        B *= n > 6 ? n / (n - 6) : 1;  // six of them went into the frame
        if (largest.trace() == 0 || B.trace() > largest.trace()) {
            largest = B;
        }
        if (blocks.size() < kFewestBlocks) {
            return largest;
        }
    }
}

FeatureResult face_result(const FrameFit& fit, const FaceSums& face, const Sums& all,
                          const std::vector<WorkPoint>& work_points, double weak_ratio) {
    FeatureResult row;
    const Vector3d at = fit.base_from_part.inverse() * (face.middle / static_cast<double>(face.count));
    row.place = at;
    row.name = "face at (" + fixed(at.x(), 0) + ", " + fixed(at.y(), 0) + ", " + fixed(at.z(), 0) + ")";
    row.residual_mm = std::sqrt(face.squares / face.weight);
    row.residual_sigma = row.residual_mm / fit.scale_mm;
    row.shift_mm = fit.base_from_part.linear().transpose() * face.push / face.weight;
    Sums others = all;
    others.H -= face.sums.H;
    others.g -= face.sums.g;
    const std::vector<Sums> levels{others};
    const LevelStep step = step_by_level(levels, fit.reference.length, weak_ratio);
    row.can_be_left_out = step.weak.cols() == 0;
    if (row.can_be_left_out) {
        const Isometry3d without = displaced(fit.base_from_part, step.step, fit.reference.about);
        for (const WorkPoint& w : work_points) {
            row.leave_one_out_mm = std::max(row.leave_one_out_mm, (without * w.p - fit.base_from_part * w.p).norm());
        }
        row.without_p_value = chi_squared_tail(all.chi2 - face.sums.chi2, all.count - static_cast<int>(face.count));
        const double lean = face.lean.dot(step.step) / face.weight;
        const Vector3d normal = fit.base_from_part.linear().transpose() * face.push;
        row.shift_mm += normal.norm() > 0 ? Vector3d(lean * normal.normalized()) : Vector3d::Zero();
    }
    return row;
}

void try_steps(const Isometry3d& T, const Matrix6& covariance, const std::vector<WorkPoint>& work_points,
               const FrameOptions& options, FrameResult& result) {
    if (options.trials < 1000) {
        throw InputError("calibrate: " + std::to_string(options.trials) +
                         " Monte-Carlo trials are too few for a 95 % region; at least 1000 were needed");
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{Eigen::MatrixXd(covariance)};
    const Eigen::MatrixXd root =
        eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal().toDenseMatrix();
    std::mt19937_64 random(options.seed);
    std::normal_distribution<double> normal;
    std::vector<Isometry3d> trials;
    for (int i = 0; i < options.trials; ++i) {
        Vector6 e;
        for (double& x : e) {
            x = normal(random);
        }
        trials.push_back(displaced(T, root * e, T.translation()));
    }
    result.work_points = spread_at(work_points, T, trials);
}

}  // namespace

double judge_surface(const TargetSurface& surface, std::span<const SidedPoint> points, const FrameFit& fit,
                     const std::vector<WorkPoint>& work_points, const FrameOptions& options, FrameResult& result) {
    const std::vector<std::size_t> face_of = faces_of(surface);
    std::map<std::size_t, FaceSums> faces;
    Sums all;
    for (const Contact& c : fit.contacts) {
        add_contact(fit, c, points[c.point].p, faces[face_of[c.surfel]]);
    }
    for (auto& [id, face] : faces) {
        face.sums.count = static_cast<int>(face.count);
        all += face.sums;
    }
    const std::vector<Sums> levels{all};
    const LevelStep step = step_by_level(levels, fit.reference.length, fit.weak_ratio);
    const Matrix6 J = change_of_reference(fit.reference.about, fit.base_from_part.translation());
    const Matrix6 independent = step.covariance, B = clustered(surface, points, fit);
    const Matrix6 C = independent * B * independent;
    result.base_from_part = fit.base_from_part;
    result.covariance = J * C * J.transpose();
    Solution solution{fit.base_from_part, result.covariance, fit.reference, step.weak, step.weak_share, 0, 0, 0};
    result.weak = weaknesses(solution);
    result.redundancy = all.count - static_cast<int>(6 - step.weak.cols());
    result.chi_squared = all.chi2;
    for (const auto& [id, face] : faces) {
        if (static_cast<double>(face.count) > kLeastFace * static_cast<double>(fit.contacts.size()) &&
            face.weight > 0) {
            result.features.push_back(face_result(fit, face, all, work_points, fit.weak_ratio));
        }
    }
    try_steps(fit.base_from_part, result.covariance, work_points, options, result);
    judge(options, result);
    double correlation = 1;
    for (Eigen::Index i = 0; i < 6; ++i) {
        correlation = independent(i, i) > 0 ? std::max(correlation, C(i, i) / independent(i, i)) : correlation;
    }
    return correlation;
}

}  // namespace seampath::calibrating
