#include "pipeline/report_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "pipeline/report_thin.hpp"
#include "stages/geometry/bspline.hpp"

namespace seampath {
namespace {

/// Directions that are tried for the camera, and how many points of the seams judge them.
constexpr int kDirections = 400;
constexpr std::size_t kJudges = 300;

/// More samples a seam, or torch poses a part, than this add nothing to the picture.
constexpr std::size_t kMaxSamples = 4000, kMaxTorch = 240;

/// A point of a seam that says from where it is well seen: the flank normals and the tangent.
struct Judge {
    Eigen::Vector3d p, n1, n2, tangent;
};

std::vector<Judge> judges_of(const std::vector<const Seam*>& seams) {
    std::size_t total = 0;
    for (const Seam* seam : seams) {
        total += seam->points.size();
    }
    const std::size_t step = total / kJudges + 1;
    std::vector<Judge> judges;
    for (const Seam* seam : seams) {
        for (std::size_t i = 0; i < seam->points.size(); i += step) {
            const SeamPoint& point = seam->points[i];
            judges.push_back({point.p, point.n1, point.n2, point.n1.cross(point.n2).normalized()});
        }
    }
    return judges;
}

/// How well the seams are seen from a direction: each point counts by the smaller of the sines at which its flanks are
/// looked at (beyond 40 degrees more is no better), and a little for not lying straight across the view, which gives
/// depth.
double score(const std::vector<Judge>& judges, const Eigen::Vector3d& toward) {
    constexpr double kEnough = 0.64, kDepthWeight = 0.2;
    double sum = 0;
    for (const Judge& judge : judges) {
        const double open = std::min({judge.n1.dot(toward), judge.n2.dot(toward), kEnough});
        if (open > 0) {
            sum += open * (1 + kDepthWeight * std::abs(judge.tangent.dot(toward)));
        }
    }
    return sum;
}

/// The mean flank normal seen upright where it does not point at the camera; otherwise the seam lies across the
/// picture.
Eigen::Vector3d upright(const std::vector<Judge>& judges, const Eigen::Vector3d& toward) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(), middle = Eigen::Vector3d::Zero();
    for (const Judge& judge : judges) {
        normal += judge.n1 + judge.n2;
        middle += judge.p / static_cast<double>(judges.size());
    }
    const Eigen::Vector3d rise = normal.normalized() - toward * toward.dot(normal.normalized());
    if (rise.norm() > 0.35) {
        return rise.normalized();
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Judge& judge : judges) {
        const Eigen::Vector3d d = judge.p - middle - toward * toward.dot(judge.p - middle);
        spread += d * d.transpose();
    }
    const Eigen::Vector3d across = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
    const Eigen::Vector3d up = toward.cross(across).normalized();
    return up.z() < 0 ? Eigen::Vector3d(-up) : up;
}

ViewCamera camera_for(const std::vector<const Seam*>& seams, const Scan& scan, const Eigen::Vector3d& centre) {
    const std::vector<Judge> judges = judges_of(seams);
    if (judges.empty()) {
        const Eigen::Vector3d from =
            scan.sensor_mm ? Eigen::Vector3d(*scan.sensor_mm - centre) : Eigen::Vector3d(0, 0, 0);
        const Eigen::Vector3d toward = (from.norm() > 1 ? from : Eigen::Vector3d(1, -1.6, 1.2)).normalized();
        return {toward, toward.unitOrthogonal()};
    }
    ViewCamera camera;
    double best = -1;
    for (int k = 0; k < kDirections; ++k) {
        // Fibonacci's sphere: even, and the same on every machine.
        const double z = 1 - (2 * k + 1.0) / kDirections, turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
        const double r = std::sqrt(1 - z * z);
        const Eigen::Vector3d toward(r * std::cos(turn), r * std::sin(turn), z);
        const double value = score(judges, toward);
        if (value > best) {
            best = value;
            camera.toward = toward;
        }
    }
    camera.up = upright(judges, camera.toward);
    return camera;
}

/// Middle and radius of what is to be in the picture: the seams, or where there is none the bulk of the scan (stray
/// points far away do not count).
void frame(const PartResult& part, ViewScene& scene) {
    std::array<std::vector<double>, 3> axis;
    const auto add = [&](const Eigen::Vector3d& p) {
        for (int k = 0; k < 3; ++k) {
            axis[static_cast<std::size_t>(k)].push_back(p[k]);
        }
    };
    for (const Seam& seam : part.extraction.seams) {
        for (const SeamPoint& point : seam.points) {
            add(point.p);
        }
    }
    const double cut = axis[0].empty() ? 0.03 : 0;
    for (std::size_t i = 0; axis[0].empty() && i < part.scan.points.size(); ++i) {
        add(part.scan.position(i));
    }
    if (axis[0].empty()) {
        return;
    }
    Eigen::Vector3d low, high;
    for (int k = 0; k < 3; ++k) {
        auto& values = axis[static_cast<std::size_t>(k)];
        const auto at = [&](double share) {
            const auto place =
                values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
            std::nth_element(values.begin(), place, values.end());
            return *place;
        };
        low[k] = at(cut);
        high[k] = at(1 - cut);
    }
    scene.centre = (low + high) / 2;
    scene.radius_mm = std::max(1.0, (high - low).norm() / 2);
}

ViewSeam view_seam(const PartResult& part, std::size_t i, const Eigen::Vector3d& centre) {
    const Seam& seam = part.extraction.seams[i];
    const Deviation& deviation = part.deviations[i];
    ViewSeam view;
    const std::size_t step = deviation.samples.size() / kMaxSamples + 1;
    for (std::size_t k = 0; k < deviation.samples.size(); ++k) {
        if (k % step == 0 || k + 1 == deviation.samples.size()) {
            const DeviationSample& s = deviation.samples[k];
            const bool modelled = flanks_at(part.models[i], s.station_mm).modelled;
            view.samples.push_back({s.p - centre, s.station_mm, s.distance_mm, s.sigma_mm, s.covered, modelled});
        }
    }
    if (part.models[i].closed && !view.samples.empty()) {
        view.samples.push_back(view.samples.front());
        view.samples.back().station_mm = part.models[i].length_mm;
    }
    for (const std::size_t node : part.nodes[i].index) {
        view.nodes.push_back(seam.points[node].p - centre);
    }
    view.tolerance_mm = deviation.tolerance_mm;
    view.camera = camera_for({&seam}, part.scan, centre);
    return view;
}

}  // namespace

ViewScene view_scene(const PartResult& part) {
    ViewScene scene;
    frame(part, scene);
    std::vector<const Seam*> seams;
    for (const Seam& seam : part.extraction.seams) {
        seams.push_back(&seam);
    }
    scene.camera = camera_for(seams, part.scan, scene.centre);
    scene.clouds = thin_scan(part.scan, part.extraction.seams, scene.centre);
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        scene.seams.push_back(view_seam(part, i, scene.centre));
        scene.scale_mm = std::max(scene.scale_mm, part.deviations[i].tolerance_mm);
    }
    const std::size_t step = part.plan.waypoints.size() / kMaxTorch + 1;
    for (std::size_t i = 0; i < part.plan.waypoints.size(); i += step) {
        const Waypoint& waypoint = part.plan.waypoints[i];
        if (waypoint.kind == WaypointKind::weld || waypoint.kind == WaypointKind::weld_start ||
            waypoint.kind == WaypointKind::weld_end) {
            scene.torch.push_back({waypoint.p - scene.centre, waypoint.q * Eigen::Vector3d::UnitZ()});
        }
    }
    return scene;
}

}  // namespace seampath
