#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include <Eigen/Dense>

#include "stages/calibrate/calibrate.hpp"
#include "stages/error.hpp"
#include "stages/geometry/densest.hpp"
#include "stages/geometry/grid.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPatchTukey = 4.685;
constexpr double kPatchMadToSigma = 1.4826;
constexpr double kLeastPatchScale = 1e-4;  // mm
constexpr double kMostPatchTurn = 10 * std::numbers::pi / 180;
constexpr std::size_t kFewestInPatch = 30;  // points of a patch
constexpr int kCellsAcross = 5;             // a patch's parts, each of which may have an error of its own
constexpr std::size_t kFewestPatchCells = 8;

/// Part of the scan about a place of a datum plane: across the plane u and v, in units of the patch's radius, and the
/// height w in mm.
struct PatchPoint {
    double u, v, w;
};

struct Patch {
    Vector3d place, normal;  ///< where and how it is expected, in the frame of the grid
    std::vector<PatchPoint> points;
};

Patch gather(const PointGrid& grid, const Isometry3d& pose, const DatumPlane& plane, const Vector3d& nominal,
             double radius, double search) {
    const Vector3d on_plane = nominal - (plane.normal.dot(nominal) - plane.offset_mm) * plane.normal;
    Patch patch{pose * on_plane, pose.linear() * plane.normal, {}};
    const Vector3d e0 = patch.normal.unitOrthogonal(), e1 = patch.normal.cross(e0);
    grid.for_points_in_ball(patch.place, std::hypot(radius, search), [&](const Eigen::Vector3f& q, double) {
        const Vector3d d = q.cast<double>() - patch.place;
        const PatchPoint p{e0.dot(d) / radius, e1.dot(d) / radius, patch.normal.dot(d)};
        if (std::hypot(p.u, p.v) < 1 && std::abs(p.w) < search) {
            patch.points.push_back(p);
        }
    });
    // Sums hang on the order of the points; this one is the same for every order they came in.
    std::sort(patch.points.begin(), patch.points.end(), [](const PatchPoint& a, const PatchPoint& b) {
        return std::tie(a.u, a.v, a.w) < std::tie(b.u, b.v, b.w);
    });
    return patch;
}

// Keeps the layer `thickness` mm high that holds most points.
void keep_densest_layer(std::vector<PatchPoint>& points, double thickness) {
    std::vector<double> heights;
    for (const PatchPoint& p : points) {
        heights.push_back(p.w);
    }
    const double low = densest(std::move(heights), thickness).low;
    std::erase_if(points, [&](const PatchPoint& p) { return p.w < low || p.w > low + thickness; });
}

Vector3d row_of(const PatchPoint& p) {
    return {1, p.u, p.v};
}

/// The plane w = c0 + c1 u + c2 v through a patch.
struct PatchPlane {
    Vector3d c{0, 0, 0};
    double white = 0, clustered = 0;  ///< mm^2, variance of c0 where errors are independent, and share cells
    double scale = 0;                 ///< mm, robust 1-sigma of the points
    int points = 0;

    double residual(const PatchPoint& p) const { return p.w - row_of(p).dot(c); }
};

// Tukey's biweight at a residual, by its share of the scale where weights end.
double biweight(double x) {
    return std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
}

// By re-weighted least squares; false when the points do not hold it.
bool settle(PatchPlane& plane, const std::vector<PatchPoint>& points) {
    constexpr int kMostRounds = 30;
    std::vector<double> weight(points.size(), 1);
    for (int round = 0; round < kMostRounds; ++round) {
        Matrix3d H = Matrix3d::Zero();
        Vector3d g = Vector3d::Zero();
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vector3d row = row_of(points[i]);
            H += weight[i] * row * row.transpose();
            g += weight[i] * row * plane.residual(points[i]);
        }
        const Vector3d step = H.ldlt().solve(g);
        if (!step.allFinite()) {
            return false;
        }
        plane.c += step;
        std::vector<double> off;
        for (const PatchPoint& p : points) {
            off.push_back(std::abs(plane.residual(p)));
        }
        plane.scale = std::max(kLeastPatchScale, kPatchMadToSigma * quantile(off, 0.5));
        for (std::size_t i = 0; i < points.size(); ++i) {
            weight[i] = biweight(plane.residual(points[i]) / (kPatchTukey * plane.scale));
        }
        if (round > 0 && step.norm() < 1e-6 * plane.scale) {
            break;
        }
    }
    return true;
}

// The variances of c0. The clustered one is that of Liang and Zeger (Biometrika 73, 1986), by cells. False where the
// points cover too little of the patch.
bool take_variances(PatchPlane& plane, const std::vector<PatchPoint>& points) {
    const auto part = [](double x) { return static_cast<int>(std::floor((x + 1) / 2 * kCellsAcross)); };
    std::map<std::pair<int, int>, Vector3d> cells;
    Matrix3d slopes = Matrix3d::Zero();  // of the weighted residuals, by the coefficients
    Matrix3d squares = Matrix3d::Zero(), scatter = Matrix3d::Zero();
    for (const PatchPoint& p : points) {
        const double residual = plane.residual(p), x = residual / (kPatchTukey * plane.scale);
        if (std::abs(x) < 1) {
            const Vector3d row = row_of(p), pull = biweight(x) * residual * row;
            cells.try_emplace({part(p.u), part(p.v)}, Vector3d::Zero()).first->second += pull;
            slopes += (1 - x * x) * (1 - 5 * x * x) * row * row.transpose();
            squares += pull * pull.transpose();
            plane.points += 1;
        }
    }
    if (cells.size() < kFewestPatchCells || !(slopes.determinant() > 0)) {
        return false;
    }
    for (const auto& [cell, sum] : cells) {
        scatter += sum * sum.transpose();
    }
    const double count = static_cast<double>(cells.size()), freed = count / (count - 3);
    const Matrix3d inverse = slopes.inverse();
    plane.white = (inverse * squares * inverse.transpose())(0, 0);
    plane.clustered = (freed * inverse * scatter * inverse.transpose())(0, 0);
    return true;
}

std::optional<PatchPlane> plane_through(const std::vector<PatchPoint>& points) {
    PatchPlane plane;
    const bool held = points.size() >= kFewestInPatch && settle(plane, points) && take_variances(plane, points);
    return held ? std::optional(plane) : std::nullopt;
}

[[noreturn]] void refuse(const DatumPlane& plane, const Vector3d& nominal) {
    throw InputError("calibrate: datum plane " + plane.name + ": about (" + shortest(nominal.x()) + ", " +
                     shortest(nominal.y()) + ", " + shortest(nominal.z()) +
                     ") the scan shows too little of it, or another surface; check \"near\", \"patch_mm\" and "
                     "\"search_mm\", or name a place that the sensor saw");
}

// Probes every place, from a pose that is off by less than `search` mm and turned by less than `tilt`.
std::vector<PlaneProbe> probe(const PointGrid& grid, const Isometry3d& pose, std::vector<DatumPlane>& planes,
                              double radius, double search, double tilt) {
    constexpr double kLeastThickness = 0.1;  // of the radius
    std::vector<PlaneProbe> probes;
    std::vector<double> white;
    double independent = 0, shared = 0;
    for (DatumPlane& plane : planes) {
        for (TouchedPoint& touched : plane.touched) {
            Patch patch = gather(grid, pose, plane, touched.nominal, radius, search);
            keep_densest_layer(patch.points, std::max(kLeastThickness, 2 * tilt) * radius);
            const auto fit = plane_through(patch.points);
            if (!fit || fit->c.tail<2>().norm() / radius > std::tan(kMostPatchTurn)) {
                refuse(plane, touched.nominal);
            }
            touched.measured = patch.place + fit->c[0] * patch.normal;
            probes.push_back({plane.name, fit->points, fit->scale, 0});
            white.push_back(fit->white);
            independent += fit->white;
            shared += fit->clustered;
        }
    }
    // What neighbours share is the scanner's, and told better by all patches than by the cells of one.
    const double correlation = std::max(1.0, shared / independent);
    std::size_t i = 0;
    for (DatumPlane& plane : planes) {
        for (TouchedPoint& touched : plane.touched) {
            touched.sigma_mm = probes[i].sigma_mm = std::max(kLeastPatchScale, std::sqrt(correlation * white[i]));
            ++i;
        }
    }
    return probes;
}

}  // namespace

std::vector<PlaneProbe> probe_planes(const Scan& scan, std::vector<DatumPlane>& planes, const ProbeOptions& options) {
    constexpr int kMostRounds = 4;
    constexpr double kSettled = 1e-4;                 // mm
    constexpr double kNearTilt = 0.09, kTilt = 0.01;  // by which `near`, and a pose found, may be turned
    constexpr double kOff = 1;                        // mm, by which a pose found may be off
    const PointGrid grid(scan.points, options.patch_mm);
    Isometry3d pose = options.near;
    pose.translation() -= scan.origin_mm;
    std::vector<PlaneProbe> probes;
    for (int round = 0; round < kMostRounds; ++round) {
        probes = round == 0 ? probe(grid, pose, planes, options.patch_mm, options.search_mm, kNearTilt)
                            : probe(grid, pose, planes, options.patch_mm, std::min(options.search_mm, kOff), kTilt);
        const Isometry3d next = calibrate_planes(planes, {}, {}).base_from_part;
        double moved = 0;
        for (const DatumPlane& plane : planes) {
            for (const TouchedPoint& touched : plane.touched) {
                moved = std::max(moved, (next * touched.nominal - pose * touched.nominal).norm());
            }
        }
        pose = next;
        if (moved < kSettled) {
            break;
        }
    }
    for (DatumPlane& plane : planes) {
        for (TouchedPoint& touched : plane.touched) {
            touched.measured += scan.origin_mm;
        }
    }
    return probes;
}

}  // namespace seampath
