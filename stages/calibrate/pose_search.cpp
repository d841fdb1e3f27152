#include "stages/calibrate/pose_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>

#include "stages/calibrate/pair_features.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/quadric.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kStarts = 100;          // poses of pairs that are looked at
constexpr std::size_t kHeld = 12, kOpen = 4;  // of those, refined on the points themselves
constexpr double kCoarseCosine = 0.8;         // between normals of surfels
constexpr std::size_t kPlanes = 4;            // of part and scene that are laid on each other

// What should be seen, and of which the scan shows what is behind it.
std::size_t seen_past(const TargetSurface& surface, const ScannedSurface& scan, const Isometry3d& T, double gate,
                      const std::vector<std::uint8_t>& seen) {
    const Sights about = surface.sights(scan.seeing, T);
    std::size_t past = 0;
    for (std::size_t i = 0; i < seen.size() && scan.depth; ++i) {
        const Surfel& s = surface.surfels()[i];
        past += seen[i] == 0 && (s.sights & about).any() && scan.depth->sees_past(T * s.p, gate);
    }
    return past;
}

// By the surfels that have a point within `gate`; turns count by the surfels' own lever.
std::vector<std::uint8_t> weigh(const TargetSurface& surface, std::span<const SidedPoint> points, double gate,
                                const Seeing& seeing, double weak_ratio, FoundPose& pose) {
    std::vector<std::uint8_t> seen(surface.surfels().size(), 0);
    for (const Contact& c : surface.contacts(points, pose.fit.base_from_part, gate, seeing)) {
        seen[c.surfel] = 1;
    }
    Vector3d middle = Vector3d::Zero();
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (seen[i]) {
            middle += surface.surfels()[i].p;
            ++pose.seen;
        }
    }
    if (pose.seen < 6) {
        return seen;
    }
    const double n = static_cast<double>(pose.seen);
    middle /= n;
    double squares = 0;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6, 6);
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (seen[i]) {
            const Surfel& s = surface.surfels()[i];
            Vector6 J;
            J << s.n, (s.p - middle).cross(s.n);
            H += J * J.transpose();
            squares += (s.p - middle).squaredNorm() / n;
        }
    }
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(6);
    scale.tail(3).setConstant(1 / std::sqrt(squares));
    const Eigen::MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    const Eigen::VectorXd& shares = eigen.eigenvalues();
    if (shares[0] > weak_ratio * shares.mean()) {
        pose.information = std::exp(shares.array().log().mean());
    }
    return seen;
}

// The width of the poses that most lies on: a pose that fits badly does not count what is near by its own wide one.
double common_gate(const std::vector<FoundPose>& poses) {
    std::size_t most = 0;
    for (const FoundPose& pose : poses) {
        most = std::max(most, pose.fit.contacts.size());
    }
    double gate = std::numeric_limits<double>::infinity();
    for (const FoundPose& pose : poses) {
        if (2 * pose.fit.contacts.size() >= most) {
            gate = std::min(gate, pose.fit.gate_mm);
        }
    }
    return gate;
}

bool better(const FoundPose& a, const FoundPose& b) {
    return a.information != b.information ? a.information > b.information : a.seen > b.seen;
}

/// Surfels in one plane.
struct PlanePatch {
    Vector3d middle;
    Matrix3d axes;  ///< columns: longest, across, normal
    std::size_t count = 0;
};

// Planes with most surfels within `reach` of the surfel that they are seen from.
std::vector<PlanePatch> planes_of(std::span<const Surfel> surfels, double spacing, double reach) {
    std::vector<PlanePatch> planes;
    const std::size_t step = 1 + surfels.size() / 400;
    for (std::size_t i = 0; i < surfels.size(); i += step) {
        const Surfel& s = surfels[i];
        std::vector<Vector3d> members;
        Vector3d middle = Vector3d::Zero();
        for (const Surfel& other : surfels) {
            const Vector3d d = other.p - s.p;
            if (d.squaredNorm() < reach * reach && std::abs(s.n.dot(d)) < spacing / 4 && other.n.dot(s.n) > 0.95) {
                members.push_back(other.p);
                middle += other.p;
            }
        }
        middle /= static_cast<double>(std::max<std::size_t>(1, members.size()));
        Matrix3d scatter = Matrix3d::Zero();
        for (const Vector3d& p : members) {
            scatter += across(p - middle, s.n) * across(p - middle, s.n).transpose();
        }
        PlanePatch plane{middle, Matrix3d::Identity(), members.size()};
        plane.axes.col(2) = s.n;
        plane.axes.col(0) =
            across(Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter).eigenvectors().col(2), s.n).normalized();
        plane.axes.col(1) = s.n.cross(plane.axes.col(0));
        planes.push_back(plane);
    }
    std::stable_sort(planes.begin(), planes.end(), [](const auto& a, const auto& b) { return a.count > b.count; });
    std::vector<PlanePatch> distinct;
    for (const PlanePatch& p : planes) {
        const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const PlanePatch& d) {
            return d.axes.col(2).dot(p.axes.col(2)) > 0.95 &&
                   std::abs(d.axes.col(2).dot(p.middle - d.middle)) < spacing / 2;
        });
        if (!known && distinct.size() < kPlanes) {
            distinct.push_back(p);
        }
    }
    return distinct;
}

// A part that shows one plane alone has no pairs that vote: its planes are laid on those of the scene, middle on middle
// and longest on longest.
std::vector<Isometry3d> plane_poses(std::span<const Surfel> part, std::span<const Surfel> scene, double spacing) {
    Eigen::AlignedBox3d box;
    for (const Surfel& s : part) {
        box.extend(s.p);
    }
    const double reach = box.diagonal().norm() / 2;
    std::vector<Isometry3d> poses;
    for (const PlanePatch& a : planes_of(part, spacing, 2 * reach)) {
        for (const PlanePatch& b : planes_of(scene, spacing, reach)) {
            for (const double turn : {0.0, std::numbers::pi}) {
                Isometry3d T = Isometry3d::Identity();
                T.linear() = b.axes * Eigen::AngleAxisd(turn, Vector3d::UnitZ()) * a.axes.transpose();
                T.translation() = b.middle - T.linear() * a.middle;
                poses.push_back(T);
            }
        }
    }
    return poses;
}

bool same_pose(const Isometry3d& a, const Isometry3d& b, const Eigen::AlignedBox3d& box, double tolerance) {
    for (int corner = 0; corner < 8; ++corner) {
        const Vector3d p = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
        if ((a * p - b * p).norm() > tolerance) {
            return false;
        }
    }
    return true;
}

// The best first; of like ones one.
void keep_distinct(std::vector<FoundPose>& poses, const TargetSurface& surface, double tolerance) {
    Eigen::AlignedBox3d box;
    for (const Surfel& s : surface.surfels()) {
        box.extend(s.p);
    }
    std::stable_sort(poses.begin(), poses.end(), better);
    std::vector<FoundPose> distinct;
    for (FoundPose& pose : poses) {
        const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const FoundPose& d) {
            return same_pose(d.fit.base_from_part, pose.fit.base_from_part, box, tolerance);
        });
        if (!known) {
            distinct.push_back(std::move(pose));
        }
    }
    poses = std::move(distinct);
}

}  // namespace

std::vector<FoundPose> search_poses(const NominalSurface& nominal, const ScannedSurface& scan, double weak_ratio) {
    std::vector<Isometry3d> starts;
    const double spacing = nominal.coarse.spacing();
    for (const PairPose& pose : pair_feature_poses(nominal.coarse.surfels(), scan.coarse, spacing, kStarts)) {
        starts.push_back(pose.base_from_part);
    }
    for (const Isometry3d& pose : plane_poses(nominal.coarse.surfels(), scan.coarse, spacing)) {
        starts.push_back(pose);
    }
    std::vector<SidedPoint> coarse;
    for (const Surfel& s : scan.coarse) {
        coarse.push_back({s.p, s.n});
    }
    const Seeing seeing{kCoarseCosine, scan.seeing.sensor};
    std::vector<FoundPose> poses(starts.size());
    parallel_for(starts.size(), 1, [&](std::size_t i) {
        poses[i].fit = fit_to_surface(nominal.coarse, coarse, starts[i], spacing, std::max(scan.noise_mm, spacing / 40),
                                      seeing, weak_ratio);
        weigh(nominal.coarse, coarse, poses[i].fit.gate_mm, seeing, weak_ratio, poses[i]);
    });
    keep_distinct(poses, nominal.coarse, spacing / 2);
    std::vector<FoundPose> fine;
    std::size_t held = 0, open = 0;
    for (const FoundPose& pose : poses) {
        std::size_t& taken = pose.held() ? held : open;
        if (taken++ < (pose.held() ? kHeld : kOpen)) {
            fine.push_back(pose);
        }
    }
    parallel_for(fine.size(), 1, [&](std::size_t i) {
        const Isometry3d start = fine[i].fit.base_from_part;
        fine[i] = {};
        fine[i].fit = fit_to_surface(nominal.fine, scan.some, start, nominal.fine.spacing(), scan.noise_mm, scan.seeing,
                                     weak_ratio);
    });
    const double gate = common_gate(fine);
    for (FoundPose& pose : fine) {
        const auto seen = weigh(nominal.fine, scan.points, gate, scan.seeing, weak_ratio, pose);
        pose.past = seen_past(nominal.fine, scan, pose.fit.base_from_part, gate, seen);
    }
    keep_distinct(fine, nominal.fine, nominal.fine.spacing());
    return fine;
}

}  // namespace seampath::calibrating
