#include <algorithm>
#include <cmath>
#include <tuple>

#include <Eigen/Dense>

#include "stages/calibrate/calibrate.hpp"
#include "stages/calibrate/chance.hpp"
#include "stages/calibrate/frame_quality.hpp"
#include "stages/calibrate/frame_solver.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using calibrating::Solution;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kRounds = 100;

// Features disagree when chance gives such residuals once in so many calibrations; a feature explains it when without
// it the others agree.
constexpr double kDisagree = 1e-3;
// Of two features that both would explain it, one is out when its chi-squared is that much worse (99.9 % of a
// chi-squared of one).
constexpr double kMuchWorse = 10.8;

auto key_of(const Vector3d& p) {
    return std::make_tuple(p.x(), p.y(), p.z());
}

// Sums hang on the order of what is summed, so that is made the same for every order given.
void put_in_order(std::vector<FrameFeature>& features) {
    std::sort(features.begin(), features.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    for (FrameFeature& feature : features) {
        std::sort(feature.points.begin(), feature.points.end(),
                  [](const auto& a, const auto& b) { return key_of(a.measured) < key_of(b.measured); });
        std::sort(feature.rows.begin(), feature.rows.end(),
                  [](const auto& a, const auto& b) { return key_of(a.point) < key_of(b.point); });
    }
}

void check(const std::vector<FrameFeature>& features) {
    for (const FrameFeature& feature : features) {
        for (const FramePoint& point : feature.points) {
            if (Eigen::LLT<Eigen::Matrix3d>(point.covariance).info() != Eigen::Success) {
                throw InputError("calibrate: the covariance of \"" + feature.name +
                                 "\" is not positive definite; a 1-sigma above 0 in each direction was needed");
            }
        }
        for (const FramePose& pose : feature.poses) {
            if (Eigen::LLT<Eigen::MatrixXd>(pose.covariance).info() != Eigen::Success) {
                throw InputError("calibrate: the covariance of \"" + feature.name +
                                 "\" is not positive definite; more of it must be seen");
            }
        }
        for (const FrameRow& row : feature.rows) {
            if (!(row.sigma_mm > 0)) {
                throw InputError("calibrate: the 1-sigma of \"" + feature.name + "\" is " + shortest(row.sigma_mm) +
                                 " mm; a number above 0 was needed");
            }
        }
    }
}

Isometry3d start_of(const std::vector<FrameFeature>& features) {
    std::vector<Vector3d> nominal, measured;
    for (const FrameFeature& feature : features) {
        for (const FramePoint& point : feature.points) {
            nominal.push_back(point.nominal);
            measured.push_back(point.measured);
        }
        for (const FramePose& pose : feature.poses) {
            for (const Vector3d& place : pose.places) {
                nominal.emplace_back(pose.nominal * place);
                measured.emplace_back(pose.measured * place);
            }
        }
    }
    if (nominal.size() < 3) {
        throw InputError("calibrate: " + std::to_string(nominal.size()) +
                         " points are too few for a frame; 3 that do not lie on a line were needed; measure more");
    }
    return rigid_through(nominal, measured);
}

FeatureResult residual_of(const FrameFeature& feature, const Isometry3d& T) {
    FeatureResult result;
    result.name = feature.name;
    result.check = feature.check;
    double squares = 0, count = 0;
    for (const FramePoint& point : feature.points) {
        squares += (point.measured - T * point.nominal).squaredNorm();
        result.shift_mm += T.linear().transpose() * (point.measured - T * point.nominal);
        result.place += point.nominal;
        count += 1;
    }
    for (const FrameRow& row : feature.rows) {
        const double d = row.normal.dot(T.inverse() * row.point) - row.offset_mm;
        squares += d * d;
        result.shift_mm += d * row.normal;
        result.place += T.inverse() * row.point;
        count += 1;
    }
    for (const FramePose& pose : feature.poses) {
        for (const Vector3d& place : pose.places) {
            const Vector3d off = pose.measured * place - T * (pose.nominal * place);
            squares += off.squaredNorm();
            result.shift_mm += T.linear().transpose() * off;
            result.place += pose.nominal * place;
            count += 1;
        }
    }
    result.shift_mm /= count;
    result.place /= count;
    result.residual_mm = std::sqrt(squares / count);
    return result;
}

// What a frame's uncertainty adds to that of a feature which is not part of it.
double predicted_sigmas(const FrameFeature& feature, const Solution& s) {
    double squares = 0, count = 0;
    for (const FramePoint& point : feature.points) {
        const Vector3d r = point.measured - s.T * point.nominal;
        const Eigen::Matrix3d C = point.covariance + covariance_at(s.covariance, s.T, point.nominal);
        squares += r.dot(C.ldlt().solve(r));
        count += 3;
    }
    for (const FrameRow& row : feature.rows) {
        const Vector3d q = s.T.inverse() * row.point, m = s.T.linear() * row.normal;
        const double d = row.normal.dot(q) - row.offset_mm;
        squares += d * d / (row.sigma_mm * row.sigma_mm + m.dot(covariance_at(s.covariance, s.T, q) * m));
        count += 1;
    }
    for (const FramePose& pose : feature.poses) {
        const Isometry3d fitted = s.T * pose.nominal;
        const Vector6 r = displacement(pose.measured, fitted);
        const Matrix6 J = change_of_reference(s.T.translation(), fitted.translation());
        const Eigen::MatrixXd C = pose.covariance + J * s.covariance * J.transpose();
        squares += r.dot(C.llt().solve(r));
        count += 6;
    }
    return std::sqrt(squares / count);
}

double largest_shift(const Isometry3d& a, const Isometry3d& b, const std::vector<WorkPoint>& work_points) {
    double largest = 0;
    for (const WorkPoint& w : work_points) {
        largest = std::max(largest, (a * w.p - b * w.p).norm());
    }
    return largest;
}

struct LeftOut {
    double chi2 = 0;
    std::size_t feature = 0;
};

// The frame without each feature, and which of them, left out, let the others agree.
void leave_each_out(const std::vector<FrameFeature>& used, const Solution& all,
                    const std::vector<WorkPoint>& work_points, const FrameOptions& options, FrameResult& result) {
    const Eigen::Index unheld = all.weak.cols();
    std::vector<LeftOut> candidates;
    for (std::size_t i = 0; i < used.size(); ++i) {
        std::vector<FrameFeature> others = used;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        FeatureResult row = residual_of(used[i], all.T);
        const auto own = calibrating::sums_of(used[i], all.T, all.reference.about);
        row.residual_sigma = std::sqrt(own.chi2 / own.count);
        if (!others.empty()) {
            const Solution without = calibrating::solve(others, all.T, options.weak_ratio, kRounds);
            row.can_be_left_out = without.weak.cols() == unheld;
            if (row.can_be_left_out) {
                const auto free = static_cast<int>(6 - unheld);
                row.leave_one_out_mm = largest_shift(all.T, without.T, work_points);
                row.without_p_value = calibrating::chi_squared_tail(without.chi2, without.count - free);
                row.shift_mm = residual_of(used[i], without.T).shift_mm;
                if (result.p_value < kDisagree && row.without_p_value >= kDisagree) {
                    candidates.push_back({without.chi2, i});
                }
            }
        }
        result.features.push_back(row);
    }
    double best = std::numeric_limits<double>::infinity();
    for (const LeftOut& c : candidates) {
        best = std::min(best, c.chi2);
    }
    for (const LeftOut& c : candidates) {
        if (c.chi2 <= best + kMuchWorse) {
            result.moved.push_back(used[c.feature].name);
        }
    }
}

}  // namespace

FrameResult calibrate_frame(std::vector<FrameFeature> features, const std::vector<WorkPoint>& work_points,
                            const FrameOptions& options, const std::optional<Isometry3d>& start) {
    check(features);
    put_in_order(features);
    std::vector<FrameFeature> used, checks;
    std::partition_copy(features.begin(), features.end(), std::back_inserter(checks), std::back_inserter(used),
                        [](const FrameFeature& f) { return f.check; });
    if (used.empty()) {
        throw InputError("calibrate: there is no feature; balls, points or planes that were measured were needed");
    }
    const Solution s = calibrating::solve(used, start ? *start : start_of(used), options.weak_ratio, kRounds);
    FrameResult result;
    result.base_from_part = s.T;
    result.covariance = s.covariance;
    result.weak = calibrating::weaknesses(s);
    result.chi_squared = s.chi2;
    result.redundancy = s.count - static_cast<int>(6 - s.weak.cols());
    result.p_value = calibrating::chi_squared_tail(s.chi2, result.redundancy);
    if (result.p_value < kDisagree) {
        result.covariance *= std::max(1.0, s.chi2 / result.redundancy);  // the sigmas given explain too little
    }
    leave_each_out(used, s, work_points, options, result);
    for (const FrameFeature& feature : checks) {
        result.features.push_back(residual_of(feature, s.T));
        result.features.back().residual_sigma = predicted_sigmas(feature, s);
    }
    const double factor = std::sqrt(result.covariance.trace() / s.covariance.trace());
    calibrating::try_at_work_points(used, s, work_points, options, factor, result);
    calibrating::judge(options, result);
    return result;
}

}  // namespace seampath
