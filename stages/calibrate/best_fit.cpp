#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Dense>

#include "stages/calibrate/calibrate.hpp"
#include "stages/calibrate/fit_quality.hpp"
#include "stages/calibrate/frame_quality.hpp"
#include "stages/calibrate/pose_search.hpp"
#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/scale.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using calibrating::FoundPose;
using calibrating::NominalSurface;
using calibrating::ScannedSurface;
using calibrating::SidedCloud;
using calibrating::SidedPoint;
using calibrating::Surfel;
using calibrating::TargetSurface;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kWeakShare = 2e-3;          // of the mean information; the rest is errors of normals
constexpr double kMostSurfels = 30000;       // fine ones of the nominal surface: some seconds
constexpr double kCoarseSurfels = 900;       // of the nominal surface: as many as pair features are known to need
constexpr std::size_t kSomePoints = 20000;   // that poses are compared on
constexpr double kSideCosine = 0.5;          // of a normal to that of the surface
constexpr double kSightCosine = 0.05;        // of the line of sight to it
constexpr double kSharpFactor = 3;           // of the median roughness: more is an edge
constexpr double kLeastOfGolden = 0.5;       // of a golden scan, that must be seen
constexpr double kMuchMore = 1.2;            // that a pose shows than the best of those that are held
constexpr double kMostPast = 0.05;           // of what is seen; at borders alone the scan may see past the right pose
constexpr std::size_t kFewestPoints = 1000;  // of either cloud

void check_size(const Scan& scan) {
    if (scan.points.size() < kFewestPoints) {
        throw InputError("calibrate: " + scan.name + " has " + std::to_string(scan.points.size()) +
                         " points; at least " + std::to_string(kFewestPoints) +
                         " were needed for a surface; scan more densely");
    }
}

double area_of(const std::vector<Surfel>& surfels, double spacing) {
    return static_cast<double>(surfels.size()) * spacing * spacing;
}

struct Surfaces {
    NominalSurface nominal;
    ScannedSurface scan;
};

double positive_noise(const ScanScale& scale) {
    return std::max(scale.noise, 1e-4 * scale.spacing);  // made data may have none
}

// Resolution follows from the two clouds: a surfel wants some points of either, and few enough to be quick.
Surfaces surfaces_of(const Scan& scan, const Scan& nominal, const BestFitOptions& options) {
    const SidedCloud part = calibrating::sided(nominal, options.nominal_sensor_mm),
                     seen = calibrating::sided(scan, options.scan_sensor_mm);
    const ScanScale part_scale = estimate_scale(part.points).overall, scan_scale = estimate_scale(seen.points).overall;
    const double noise = positive_noise(scan_scale);
    const double area = static_cast<double>(part.points.size()) * part_scale.spacing * part_scale.spacing;
    const double spacing = std::max({2.5 * part_scale.spacing, 2 * scan_scale.spacing, std::sqrt(area / kMostSurfels)});
    std::vector<Surfel> fine =
        calibrating::smooth_ones(calibrating::surfels_of(part, spacing, 1.5 * spacing), kSharpFactor, 0.3 * noise);
    calibrating::find_sights(fine, part, part_scale.spacing);
    const double coarse = std::max(2 * spacing, std::sqrt(area_of(fine, spacing) / kCoarseSurfels));
    const double reach = std::max({4 * scan_scale.spacing, 1.5 * spacing, 8 * noise});
    if (fine.size() < 20) {
        throw InputError("calibrate: " + nominal.name +
                         " shows no smooth surface; faces larger than some distances of its points were needed");
    }
    Surfaces s{{TargetSurface(fine, spacing), TargetSurface(calibrating::thinned(fine, coarse), coarse)}, {}};
    s.scan.coarse = calibrating::thinned(
        calibrating::smooth_ones(calibrating::surfels_of(seen, coarse / 2, reach), kSharpFactor, noise), coarse);
    s.scan.seeing = {seen.normals ? kSideCosine : kSightCosine, seen.sensor};
    if (seen.sensor) {
        s.scan.depth.emplace(seen, scan_scale.spacing);
    }
    s.scan.noise_mm = noise;
    const std::size_t step = 1 + seen.points.size() / kSomePoints;
    for (std::size_t i = 0; i < seen.points.size(); ++i) {
        s.scan.points.push_back({seen.position(i), seen.sides[i].cast<double>()});
        if (calibrating::stride_hash(i) % step == 0) {
            s.scan.some.push_back(s.scan.points.back());
        }
    }
    return s;
}

// Whether what another pose shows is as much as what the best does, but for chance.
bool rivals(const FoundPose& best, const FoundPose& other) {
    const double a = static_cast<double>(best.seen), b = static_cast<double>(other.seen);
    return b >= a - 3 * std::sqrt(a + b) && other.information >= 0.5 * best.information;
}

std::string turn_text(const Isometry3d& from, const Isometry3d& to) {
    const Isometry3d step = from.inverse() * to;  // in the part frame
    const Eigen::AngleAxisd turn(step.linear());
    const auto text = [](const Vector3d& v, int decimals) {
        return "(" + fixed(v.x(), decimals) + ", " + fixed(v.y(), decimals) + ", " + fixed(v.z(), decimals) + ")";
    };
    return fixed(turn.angle() * 180 / std::acos(-1.0), 1) + " deg about " + text(turn.axis(), 2) + " and shifted by " +
           text(step.translation(), 1) + " mm";
}

// The scan shows what lies behind places of the part that nothing hides.
bool contradicted(const FoundPose& pose) {
    return static_cast<double>(pose.past) > kMostPast * static_cast<double>(pose.seen);
}

// Poses that are not about where the part is said to be.
void leave_near(const Isometry3d& near, const std::vector<Surfel>& surfels, std::vector<FoundPose>& poses) {
    constexpr double kNearTurn = std::numbers::pi / 4;  // half of the least turn that lays a box on itself
    Eigen::AlignedBox3d box;
    for (const Surfel& s : surfels) {
        box.extend(s.p);
    }
    std::erase_if(poses, [&](const FoundPose& pose) {
        const Isometry3d& T = pose.fit.base_from_part;
        return Eigen::AngleAxisd(near.linear().transpose() * T.linear()).angle() > kNearTurn ||
               (T * box.center() - near * box.center()).norm() > box.diagonal().norm() / 2;
    });
}

// The pose that stands, and why it may not.
FoundPose choose(const std::vector<FoundPose>& poses, std::size_t surfels, double least_share, FrameResult& result) {
    const double least = least_share * static_cast<double>(surfels);
    std::vector<FoundPose> enough;
    std::copy_if(poses.begin(), poses.end(), std::back_inserter(enough),
                 [&](const FoundPose& pose) { return static_cast<double>(pose.seen) >= least && !contradicted(pose); });
    if (enough.empty()) {
        std::size_t most = 0;
        for (const FoundPose& pose : poses) {
            most = contradicted(pose) ? most : std::max(most, pose.seen);
        }
        result.faults.push_back("no pose was found in which the scan shows " + fixed(100 * least_share, 0) +
                                " % of the nominal surface and nothing behind it; the best shows " +
                                fixed(100.0 * static_cast<double>(most) / static_cast<double>(surfels), 1) +
                                " %; scan more of the part, or lower least_share");
        return poses.empty() ? FoundPose{} : poses.front();
    }
    FoundPose best = enough.front();
    const auto fuller = std::find_if(enough.begin(), enough.end(), [&](const FoundPose& pose) {
        return best.held() && !pose.held() &&
               static_cast<double>(pose.seen) > kMuchMore * static_cast<double>(best.seen);
    });
    if (fuller != enough.end()) {
        return *fuller;  // what is held may be so by chance
    }
    const auto rival = [&](const FoundPose& pose) { return pose.held() && rivals(best, pose); };
    const auto others = std::count_if(enough.begin() + 1, enough.end(), rival);
    if (best.held() && others > 0) {
        const FoundPose& other = *std::find_if(enough.begin() + 1, enough.end(), rival);
        result.faults.push_back("ambiguous: the part fits as well in " + std::to_string(others) +
                                (others == 1 ? " other pose" : " other poses") + ", e.g. turned by " +
                                turn_text(best.fit.base_from_part, other.fit.base_from_part) + " (it shows " +
                                std::to_string(other.seen) + " places of " + std::to_string(best.seen) +
                                "); its shape, or what the scan shows of it, is symmetric: scan a feature that tells "
                                "the poses apart, or say about where the part stands (near)");
    }
    return best;
}

}  // namespace

BestFit calibrate_surface(const Scan& scan, const Scan& nominal, const std::vector<WorkPoint>& work_points,
                          const BestFitOptions& options) {
    check_size(scan);
    check_size(nominal);
    const Surfaces s = surfaces_of(scan, nominal, options);
    const std::size_t surfels = s.nominal.fine.surfels().size();
    // A scan has borders of its own, and laid on another by half of it or less it may lie anywhere.
    const bool golden = nominal.normals.empty();
    const double least_share = golden ? std::max(kLeastOfGolden, options.least_share) : options.least_share;
    if (golden && !options.near) {
        throw InputError("calibrate: " + nominal.name +
                         " is a golden scan: it shows one side of the part, which may look like another; near (about "
                         "base_from_part: x, y, z in mm, quaternion w, x, y, z) was needed in the nominal file");
    }
    if (golden && !s.scan.depth) {
        throw InputError("calibrate: " + scan.name +
                         " has normals and no sensor; on a golden scan a pose is proven by what the sensor does not "
                         "see past: sensor_mm was needed in the nominal file (about where the sensor stood in the "
                         "frame of the scan)");
    }
    BestFit fit;
    fit.scan_noise_mm = s.scan.noise_mm;
    std::vector<FoundPose> poses = calibrating::search_poses(s.nominal, s.scan, kWeakShare);
    if (options.near) {
        leave_near(*options.near, s.nominal.fine.surfels(), poses);
    }
    FoundPose best = choose(poses, surfels, least_share, fit.frame);
    if (best.seen == 0) {
        return fit;
    }
    best.fit = calibrating::fit_to_surface(s.nominal.fine, s.scan.points, best.fit.base_from_part, best.fit.gate_mm,
                                           s.scan.noise_mm, s.scan.seeing, kWeakShare);
    fit.scale_mm = best.fit.scale_mm;
    fit.share_seen = static_cast<double>(best.seen) / static_cast<double>(surfels);
    fit.points_taken = best.fit.contacts.size();
    fit.correlation =
        calibrating::judge_surface(s.nominal.fine, s.scan.points, best.fit, work_points, options.frame, fit.frame);
    if (!best.held() && fit.frame.weak.empty() && best.seen > 0) {
        fit.frame.faults.emplace_back(
            "the places of the nominal surface that the scan shows do not hold all directions");
    }
    return fit;
}

}  // namespace seampath
