#include "stages/calibrate/frame_quality.hpp"

#include <cmath>
#include <random>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kTrialRounds = 20;
constexpr double kDisagree = 1e-3;
constexpr double kCheckSigmas = 3.3;  // a check point is off when chance puts it there once in a thousand

// The features as the fitted frame would have them, with new errors.
std::vector<FrameFeature> measured_anew(const std::vector<FrameFeature>& features, const Isometry3d& T, double factor,
                                        std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    std::vector<FrameFeature> again = features;
    for (FrameFeature& feature : again) {
        for (FramePoint& point : feature.points) {
            const Vector3d e(normal(random), normal(random), normal(random));
            point.measured =
                T * point.nominal + factor * Vector3d(Eigen::LLT<Eigen::Matrix3d>(point.covariance).matrixL() * e);
        }
        for (FrameRow& row : feature.rows) {
            const double off = row.normal.dot(T.inverse() * row.point) - row.offset_mm;
            row.point += (factor * row.sigma_mm * normal(random) - off) * (T.linear() * row.normal);
        }
        for (FramePose& pose : feature.poses) {
            Vector6 e;
            for (double& x : e) {
                x = normal(random);
            }
            const Eigen::MatrixXd root = Eigen::LLT<Eigen::MatrixXd>(pose.covariance).matrixL();
            const Isometry3d fitted = T * pose.nominal;
            pose.measured = displaced(fitted, factor * root * e, fitted.translation());
        }
    }
    return again;
}

std::string list(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
    }
    return text;
}

void judge_weak(const FrameOptions& options, FrameResult& result) {
    if (result.weak.empty()) {
        return;
    }
    std::string text;
    for (const Weakness& weak : result.weak) {
        text += (text.empty() ? "" : "; ") + weak.text;
    }
    if (options.weak == WeakDirection::refuse) {
        result.faults.push_back("the features do not hold: " + text);
    } else {
        result.notes.push_back("kept as at the start, because the features do not hold it: " + text);
    }
}

void judge_agreement(FrameResult& result) {
    if (result.redundancy == 0) {
        result.notes.emplace_back("nothing was measured twice: residuals say nothing; a check point would");
    } else if (result.p_value < kDisagree) {
        const double ratio = std::sqrt(result.chi_squared / result.redundancy);
        std::string fault =
            "the features disagree: residuals are " + fixed(ratio, 1) + " times what their sigmas allow";
        if (result.moved.empty()) {
            fault += "; no single one explains it";
        } else {
            fault += "; " + list(result.moved) + (result.moved.size() == 1 ? " has moved" : " has moved (one of them)");
        }
        result.faults.push_back(fault);
    }
    for (const FeatureResult& feature : result.features) {
        if (feature.check && feature.residual_sigma > kCheckSigmas) {
            result.faults.push_back("check point " + feature.name + " is off by " + fixed(feature.residual_mm, 3) +
                                    " mm, " + fixed(feature.residual_sigma, 1) + " sigma");
        }
    }
}

}  // namespace

std::vector<WorkPointResult> spread_at(const std::vector<WorkPoint>& work_points, const Isometry3d& T,
                                       const std::vector<Isometry3d>& trials) {
    std::vector<WorkPointResult> results;
    for (const WorkPoint& w : work_points) {
        WorkPointResult r{w.name, w.p, T * w.p, Eigen::Matrix3d::Zero(), 0};
        std::vector<double> distance;
        for (const Isometry3d& trial : trials) {
            const Vector3d d = trial * w.p - r.in_base;
            r.covariance += d * d.transpose() / static_cast<double>(trials.size());
            distance.push_back(d.norm());
        }
        r.expanded_mm = quantile(distance, 0.95);
        results.push_back(r);
    }
    return results;
}

void try_at_work_points(const std::vector<FrameFeature>& features, const Solution& solution,
                        const std::vector<WorkPoint>& work_points, const FrameOptions& options, double factor,
                        FrameResult& result) {
    if (options.trials < 1000) {
        throw InputError("calibrate: " + std::to_string(options.trials) +
                         " Monte-Carlo trials are too few for a 95 % region; at least 1000 were needed");
    }
    if (work_points.empty()) {
        return;
    }
    std::vector<Isometry3d> trials(static_cast<std::size_t>(options.trials));
    parallel_for(trials.size(), 64, [&](std::size_t i) {
        std::seed_seq seeds{options.seed, static_cast<std::uint64_t>(i)};
        std::mt19937_64 random(seeds);
        const auto again = measured_anew(features, solution.T, factor, random);
        trials[i] = solve(again, solution.T, options.weak_ratio, kTrialRounds).T;
    });
    result.work_points = spread_at(work_points, solution.T, trials);
}

void judge(const FrameOptions& options, FrameResult& result) {
    judge_weak(options, result);
    judge_agreement(result);
    for (const WorkPointResult& w : result.work_points) {
        if (!(w.expanded_mm <= options.limit_mm)) {
            result.faults.push_back("work point " + w.name + ": expanded uncertainty " + fixed(w.expanded_mm, 4) +
                                    " mm is above the limit of " + shortest(options.limit_mm) + " mm");
        }
    }
}

}  // namespace seampath::calibrating
