#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "stages/calibrate/calibrate.hpp"
#include "stages/calibrate/frame_solver.hpp"
#include "stages/error.hpp"
#include "stages/geometry/quadric.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t kSeamSamples = 48;  // of all seams of one side, for poses
constexpr std::size_t kSeamPairs = 120;   // of measured samples
constexpr std::size_t kPosesRefined = 12;
constexpr std::size_t kPointsASeam = 80;  // neighbours share their error, so more tell little
constexpr double kSameAngle = 0.15;       // rad, of tangents in a pair
constexpr double kStraight = 0.05;        // sine below which a tangent points along the pair
constexpr int kSeamRounds = 30;

struct CurveSample {
    Vector3d p, t;
};

/// Where a point is nearest to a polyline.
struct CurveFoot {
    std::size_t seam = 0;
    Vector3d p, t;
    double distance = std::numeric_limits<double>::infinity();
    bool end = false;  ///< beyond an open end
};

CurveFoot foot_on(const std::vector<NominalSeam>& seams, const Vector3d& q) {
    CurveFoot best;
    for (std::size_t k = 0; k < seams.size(); ++k) {
        const auto& points = seams[k].points;
        const std::size_t pieces = points.size() - (seams[k].closed ? 0 : 1);
        for (std::size_t i = 0; i < pieces; ++i) {
            const Vector3d &a = points[i], d = points[(i + 1) % points.size()] - a;
            const double s = (q - a).dot(d) / std::max(d.squaredNorm(), 1e-300), at = std::clamp(s, 0.0, 1.0);
            const double distance = (q - a - at * d).norm();
            if (distance < best.distance) {
                const bool beyond = !seams[k].closed && ((i == 0 && s < 0) || (i + 1 == pieces && s > 1));
                best = {k, a + at * d, d.normalized(), distance, beyond};
            }
        }
    }
    return best;
}

double length_of(const NominalSeam& seam) {
    double length = 0;
    for (std::size_t i = 0; i + 1 < seam.points.size(); ++i) {
        length += (seam.points[i + 1] - seam.points[i]).norm();
    }
    return length + (seam.closed ? (seam.points.back() - seam.points.front()).norm() : 0);
}

// Evenly along all seams.
std::vector<CurveSample> samples_of(const std::vector<NominalSeam>& seams, double step) {
    std::vector<CurveSample> samples;
    for (const NominalSeam& seam : seams) {
        double due = step / 2;
        for (std::size_t i = 0; i + (seam.closed ? 0 : 1) < seam.points.size(); ++i) {
            const Vector3d &a = seam.points[i], d = seam.points[(i + 1) % seam.points.size()] - a;
            for (; due < d.norm(); due += step) {
                samples.push_back({a + due * d.normalized(), d.normalized()});
            }
            due -= d.norm();
        }
    }
    return samples;
}

std::vector<CurveSample> samples_of(const std::vector<std::vector<MeasuredSeamPoint>>& measured) {
    std::size_t count = 0;
    for (const auto& seam : measured) {
        count += seam.size();
    }
    std::vector<CurveSample> samples;
    for (const auto& seam : measured) {
        const std::size_t step = 1 + count / kSeamSamples, reach = std::max<std::size_t>(1, step / 2);
        for (std::size_t i = step / 2; i < seam.size() && seam.size() >= 2; i += step) {
            const Vector3d d = seam[std::min(i + reach, seam.size() - 1)].p - seam[i - std::min(i, reach)].p;
            samples.push_back({seam[i].p, d.normalized()});
        }
    }
    return samples;
}

// The turn that takes unit vectors a to b and, as far as that leaves it open, u to v.
Eigen::Matrix3d turn_between(const Vector3d& a, const Vector3d& u, const Vector3d& b, const Vector3d& v) {
    Eigen::Matrix3d from, to;
    const Vector3d fu = across(u, a).normalized(), tv = across(v, b).normalized();
    from << a, fu, a.cross(fu);
    to << b, tv, b.cross(tv);
    return to * from.transpose();
}

struct SeamPose {
    Isometry3d base_from_part;
    double near = 0;  ///< share of the measured samples that lie on a nominal seam
    double rms = 0;   ///< mm, of those
};

SeamPose rated(const std::vector<NominalSeam>& nominal, const std::vector<CurveSample>& measured, const Isometry3d& T,
               double tolerance) {
    SeamPose pose{T, 0, 0};
    const Isometry3d back = T.inverse();
    for (const CurveSample& m : measured) {
        const double d = foot_on(nominal, back * m.p).distance;
        if (d < tolerance) {
            pose.near += 1;
            pose.rms += d * d;
        }
    }
    pose.rms = std::sqrt(pose.rms / std::max(1.0, pose.near));
    pose.near /= static_cast<double>(measured.size());
    return pose;
}

bool better_pose(const SeamPose& a, const SeamPose& b) {
    return a.near != b.near ? a.near > b.near : a.rms < b.rms;
}

// Poses in which a pair of measured samples lies on a pair of nominal ones, the best first.
std::vector<SeamPose> poses_of_pairs(const std::vector<NominalSeam>& nominal, const std::vector<CurveSample>& part,
                                     const std::vector<CurveSample>& measured, double step) {
    std::vector<SeamPose> poses;
    const std::size_t n = measured.size(), stride = 1 + n * n / kSeamPairs;
    for (std::size_t pair = 0; pair < n * n; pair += stride) {
        const CurveSample &m = measured[pair / n], &m2 = measured[pair % n];
        const Vector3d d = m2.p - m.p;
        if (d.norm() < 4 * step || across(m.t, d.normalized()).norm() < kStraight) {
            continue;
        }
        for (const CurveSample& a : part) {
            for (const CurveSample& b : part) {
                const Vector3d e = b.p - a.p;
                if (std::abs(e.norm() - d.norm()) > step) {
                    continue;
                }
                const Vector3d u = e.normalized(), v = d.normalized();
                const double sign = a.t.dot(u) * m.t.dot(v) < 0 ? -1 : 1;
                const double off =
                    std::acos(std::clamp(sign * a.t.dot(u), -1.0, 1.0)) - std::acos(std::clamp(m.t.dot(v), -1.0, 1.0));
                if (std::abs(off) > kSameAngle || across(a.t, u).norm() < kStraight) {
                    continue;
                }
                for (const double side : {sign, -sign}) {  // square to the pair either sign may hold
                    if (side != sign && std::abs(m.t.dot(v)) > kSameAngle) {
                        continue;
                    }
                    Isometry3d T = Isometry3d::Identity();
                    T.linear() = turn_between(u, side * a.t, v, m.t);
                    T.translation() = (m.p + m2.p) / 2 - T.linear() * (a.p + b.p) / 2;
                    if (std::abs((T.linear() * b.t).dot(m2.t)) > 1 - kSameAngle) {
                        poses.push_back(rated(nominal, measured, T, 1.5 * step));
                    }
                }
            }
        }
    }
    return poses;
}

// Of seams on one line no pair has a tangent across: line on line, middle on middle, either way.
std::vector<SeamPose> poses_of_lines(const std::vector<NominalSeam>& nominal, const std::vector<CurveSample>& measured,
                                     double step) {
    Vector3d middle = Vector3d::Zero();
    for (const CurveSample& m : measured) {
        middle += m.p / static_cast<double>(measured.size());
    }
    const Vector3d v = (measured.back().p - measured.front().p).normalized();
    std::vector<SeamPose> poses;
    for (const NominalSeam& seam : nominal) {
        const Vector3d e = seam.points.back() - seam.points.front();
        if (!(e.norm() > 0)) {
            continue;
        }
        for (const double side : {1.0, -1.0}) {
            Isometry3d T = Isometry3d::Identity();
            T.linear() = Eigen::Quaterniond::FromTwoVectors(side * e, v).toRotationMatrix();
            T.translation() = middle - T.linear() * (seam.points.front() + seam.points.back()) / 2;
            poses.push_back(rated(nominal, measured, T, 1.5 * step));
        }
    }
    return poses;
}

// What the points say: they lie on the line through the nearest place of a nominal seam, along it.
std::vector<FrameFeature> features_at(const std::vector<NominalSeam>& nominal,
                                      const std::vector<std::vector<MeasuredSeamPoint>>& measured, const Isometry3d& T,
                                      double tolerance) {
    std::vector<FrameFeature> features(nominal.size());
    const Isometry3d back = T.inverse();
    for (const auto& seam : measured) {
        const std::size_t step = 1 + seam.size() / kPointsASeam;
        for (std::size_t i = step / 2; i < seam.size(); i += step) {
            const CurveFoot foot = foot_on(nominal, back * seam[i].p);
            if (foot.distance < tolerance && !foot.end) {
                const Vector3d e0 = foot.t.unitOrthogonal(), e1 = foot.t.cross(e0);
                for (const Vector3d& e : {e0, e1}) {
                    features[foot.seam].rows.push_back({e, e.dot(foot.p), seam[i].p, seam[i].sigma_mm});
                }
            }
        }
    }
    for (std::size_t k = 0; k < nominal.size(); ++k) {
        features[k].name = nominal[k].name;
    }
    std::erase_if(features, [](const FrameFeature& f) { return f.rows.empty(); });
    return features;
}

// To rest, with a tolerance that shrinks to `least`.
Isometry3d refined(const std::vector<NominalSeam>& nominal, const std::vector<std::vector<MeasuredSeamPoint>>& measured,
                   Isometry3d T, double tolerance, double least, double weak_ratio) {
    for (int round = 0; round < kSeamRounds; ++round, tolerance = std::max(least, 0.8 * tolerance)) {
        const auto features = features_at(nominal, measured, T, tolerance);
        if (features.empty()) {
            return T;
        }
        T = calibrating::solve(features, T, weak_ratio, 1).T;
    }
    return T;
}

double reach_of(const std::vector<NominalSeam>& nominal) {
    Eigen::AlignedBox3d box;
    for (const NominalSeam& seam : nominal) {
        for (const Vector3d& p : seam.points) {
            box.extend(p);
        }
    }
    return box.diagonal().norm();
}

void check_seams(const std::vector<NominalSeam>& nominal, const std::vector<std::vector<MeasuredSeamPoint>>& measured) {
    for (const NominalSeam& seam : nominal) {
        if (seam.points.size() < 2 || !(length_of(seam) > 0)) {
            throw InputError("calibrate: the nominal seam " + seam.name + " has " + std::to_string(seam.points.size()) +
                             " points and no length; at least two places were needed");
        }
    }
    std::size_t count = 0;
    for (const auto& seam : measured) {
        count += seam.size();
    }
    if (nominal.empty() || count < 4) {
        throw InputError("calibrate: " + std::to_string(nominal.size()) + " nominal seams and " +
                         std::to_string(count) + " measured points; a seam and at least 4 points were needed");
    }
}

}  // namespace

FrameResult calibrate_seams(const std::vector<NominalSeam>& nominal,
                            const std::vector<std::vector<MeasuredSeamPoint>>& measured,
                            const std::vector<WorkPoint>& work_points, const FrameOptions& options) {
    check_seams(nominal, measured);
    double length = 0, sigma = 0;
    for (const NominalSeam& seam : nominal) {
        length += length_of(seam);
    }
    for (const auto& seam : measured) {
        for (const MeasuredSeamPoint& point : seam) {
            sigma = std::max(sigma, point.sigma_mm);
        }
    }
    const double step = length / kSeamSamples, least = std::max(step / 4, 6 * sigma);
    const std::vector<CurveSample> seen = samples_of(measured);
    std::vector<SeamPose> poses = poses_of_pairs(nominal, samples_of(nominal, step), seen, step);
    if (poses.empty()) {
        poses = poses_of_lines(nominal, seen, step);
    }
    std::stable_sort(poses.begin(), poses.end(), better_pose);
    const double reach = reach_of(nominal);
    std::vector<SeamPose> distinct;
    const auto far = [&](const SeamPose& a, const SeamPose& b) {
        const Vector6 d = displacement(a.base_from_part, b.base_from_part);
        return d.head<3>().norm() > 3 * step || d.tail<3>().norm() * reach > 3 * step;
    };
    for (const SeamPose& pose : poses) {
        if (distinct.size() < kPosesRefined &&
            std::all_of(distinct.begin(), distinct.end(), [&](const SeamPose& d) { return far(d, pose); })) {
            distinct.push_back(pose);
        }
    }
    for (SeamPose& pose : distinct) {
        pose = rated(nominal, seen,
                     refined(nominal, measured, pose.base_from_part, 3 * step, least, options.weak_ratio), least);
    }
    std::stable_sort(distinct.begin(), distinct.end(), better_pose);
    constexpr double kLeastNear = 0.5;
    if (distinct.empty() || distinct.front().near < kLeastNear) {
        throw InputError(
            "calibrate: no pose was found in which half of the measured seam points lie on nominal seams; "
            "seams of the same part, both in mm, were needed");
    }
    const Isometry3d T = distinct.front().base_from_part;
    FrameResult result = calibrate_frame(features_at(nominal, measured, T, least), work_points, options, T);
    for (std::size_t i = 1; i < distinct.size() && result.weak.empty(); ++i) {
        const SeamPose &best = distinct.front(), &other = distinct[i];
        if (far(best, other) && other.near >= 0.97 * best.near && other.rms < 2 * best.rms + sigma) {
            result.faults.push_back("ambiguous: the seams fit as well in another pose (" + fixed(100 * other.near, 0) +
                                    " % of the points, rms " + fixed(other.rms, 3) + " mm against " +
                                    fixed(best.rms, 3) + " mm); measure one more seam that tells them apart");
            break;
        }
    }
    return result;
}

}  // namespace seampath
