#include "stages/robot_frames/poses.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <Eigen/Dense>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath::robot_frames {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Share of the information; of turns that scatter by 0.2 degrees about the others' axis. A robot that is to turn about
// one axis scatters less.
constexpr double kNoTurn = 1e-5;
constexpr double kOutlier = 0.01;        // that chance names a pose in a calibration where none is off
constexpr std::size_t kMostLeftOut = 4;  // one of so many

std::string vector_text(const Vector3d& v) {
    return "(" + fixed(v.x(), 3) + ", " + fixed(v.y(), 3) + ", " + fixed(v.z(), 3) + ")";
}

// With the covariance C, distance that 95 % of normal errors keep.
double distance_of_95(const Matrix3d& C, const RobotFrameOptions& options) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen{MatrixXd(C)};
    const Vector3d sigma = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
    std::mt19937_64 random(options.seed);
    std::normal_distribution<double> normal;
    std::vector<double> distance;
    for (int i = 0; i < options.trials; ++i) {
        const double x = normal(random), y = normal(random), z = normal(random);
        distance.push_back(Vector3d(x * sigma.x(), y * sigma.y(), z * sigma.z()).norm());
    }
    return quantile(distance, 0.95);
}

void add_faults(const RobotFrameOptions& options, RobotFrame& result) {
    std::string left_out;
    std::size_t count = 0;
    for (const PoseResult& pose : result.poses) {
        if (pose.left_out) {
            left_out += (left_out.empty() ? "" : ", ") + pose.name;
            ++count;
        }
    }
    if (count > 0) {
        result.notes.push_back("does not fit the others, and was left out: " + left_out);
    }
    if (count * kMostLeftOut >= result.poses.size()) {
        result.faults.push_back(std::to_string(count) + " of " + std::to_string(result.poses.size()) +
                                " poses do not fit the others; look for what moved, and measure again");
    }
    if (!(result.expanded_mm <= options.limit_mm)) {
        result.faults.push_back("expanded uncertainty " + fixed(result.expanded_mm, 4) + " mm is above the limit of " +
                                shortest(options.limit_mm) + " mm; it is least sure along " +
                                vector_text(result.weakest) + ": add poses that turn more, about other axes");
    }
}

}  // namespace

// A point fixed in the turning frame is held by sum (R_i - mean R)'(R_i - mean R) = n (I - M'M), M the mean of all R_i.
void require_turns(const std::vector<Isometry3d>& poses, const std::string& who, const std::string& fixed_to) {
    Matrix3d mean = Matrix3d::Zero();
    for (const Isometry3d& pose : poses) {
        mean += pose.linear() / static_cast<double>(poses.size());
    }
    const MatrixXd held = Matrix3d::Identity() - mean.transpose() * mean;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(held);
    if (eigen.eigenvalues()[1] < kNoTurn) {
        throw InputError(who +
                         ": the poses do not turn; turns about two axes, by 30 degrees and more, were needed; "
                         "measure in other orientations");
    }
    if (eigen.eigenvalues()[0] < kNoTurn) {
        throw InputError(who + ": all poses turn about one axis, " + vector_text(eigen.eigenvectors().col(0)) + " of " +
                         fixed_to +
                         ", so that the place along it stays open; turns about two axes were needed; add "
                         "poses that turn about another");
    }
}

RobustFit fit_without_outliers(std::size_t poses, std::size_t least,
                               const std::function<BlockFit(const std::vector<std::size_t>&)>& fit) {
    RobustFit result;
    result.kept.resize(poses);
    std::iota(result.kept.begin(), result.kept.end(), std::size_t{0});
    result.p_value.assign(poses, 1);
    while (true) {
        result.fit = fit(result.kept);
        std::size_t worst = 0;
        for (std::size_t k = 0; k < result.kept.size(); ++k) {
            result.p_value[result.kept[k]] = without_block(result.fit, k).p_value;
            worst = result.p_value[result.kept[k]] < result.p_value[result.kept[worst]] ? k : worst;
        }
        const bool out = result.p_value[result.kept[worst]] < kOutlier / static_cast<double>(poses);
        const bool may = (poses - result.kept.size() + 1) * kMostLeftOut <= poses && result.kept.size() > least;
        if (!out || !may) {
            return result;
        }
        result.kept.erase(result.kept.begin() + static_cast<std::ptrdiff_t>(worst));
    }
}

void add_residuals(const std::vector<std::string>& names, const RobustFit& robust, const std::vector<double>& mm,
                   const std::vector<double>& rad, RobotFrame& result) {
    double squares_mm = 0, squares_rad = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const bool kept = std::binary_search(robust.kept.begin(), robust.kept.end(), i);
        result.poses.push_back({names[i], mm[i], rad[i], 0, robust.p_value[i], !kept});
        if (kept) {
            squares_mm += mm[i] * mm[i];
            squares_rad += rad[i] * rad[i];
            result.largest_mm = std::max(result.largest_mm, mm[i]);
        }
    }
    result.residual_mm = std::sqrt(squares_mm / static_cast<double>(robust.kept.size()));
    result.residual_rad = std::sqrt(squares_rad / static_cast<double>(robust.kept.size()));
}

void judge_fit(const RobustFit& robust, Index of_frame, const RobotFrameOptions& options, RobotFrame& result) {
    if (options.trials < 1000) {
        throw InputError("calibrate: " + std::to_string(options.trials) +
                         " Monte-Carlo trials are too few for a 95 % region; at least 1000 were needed");
    }
    const BlockFit& fit = robust.fit;
    result.redundancy = static_cast<int>(fit.redundancy);
    result.sigma_ratio = std::sqrt(fit.variance_factor());
    const MatrixXd all = fit.variance_factor() * fit.covariance();
    result.covariance.topLeftCorner(of_frame, of_frame) = all.topLeftCorner(of_frame, of_frame);
    for (std::size_t k = 0; k < robust.kept.size(); ++k) {
        Vector6 step = Vector6::Zero();
        step.head(of_frame) = without_block(fit, k).step.head(of_frame);
        const Isometry3d moved = displaced(result.frame, step, result.frame.translation());
        result.poses[robust.kept[k]].without_mm = (moved * result.work_point - result.frame * result.work_point).norm();
    }
    const Matrix3d C = covariance_at(result.covariance, result.frame, result.work_point);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen{MatrixXd(C)};
    result.weakest = eigen.eigenvectors().col(2);
    result.weakest_mm = std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
    result.expanded_mm = distance_of_95(C, options);
    if (!fit.converged) {
        result.faults.push_back("the least squares did not converge; check the poses and their units");
    }
    add_faults(options, result);
}

}  // namespace seampath::robot_frames
