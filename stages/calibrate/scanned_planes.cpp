#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "stages/calibrate/calibrate.hpp"
#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t kPlaneSamples = 100000;  // of all faces
constexpr double kFieldsAcross = 6;            // of a face's longer side
constexpr double kBorder = 0.03;               // of a face's size that is left out beside its edges
constexpr std::size_t kFewestInField = 5;
constexpr double kLeastFilled = 0.4;  // of the median field's points
constexpr std::size_t kFewestFields = 3;

double area_of_face(const PlaneFace& face) {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
        twice += (face.corners[i] - face.corners[0]).cross(face.corners[i + 1] - face.corners[0]).norm();
    }
    return twice / 2;
}

void check_faces(const std::vector<PlaneFace>& planes) {
    if (planes.size() != 3 || !(std::abs(planes[0].normal.dot(planes[1].normal.cross(planes[2].normal))) > 0.1)) {
        throw InputError("calibrate: " + std::to_string(planes.size()) +
                         " planes that meet in no corner; three that stand across each other were needed, in the order "
                         "of their precedence");
    }
    for (const PlaneFace& face : planes) {
        double worst = 0;
        for (const Vector3d& corner : face.corners) {
            worst = std::max(worst, std::abs(face.normal.dot(corner) - face.offset_mm));
        }
        if (face.corners.size() < 3 || !(area_of_face(face) > 0) || worst > 1e-3) {
            throw InputError("calibrate: plane " + face.name + " has " + std::to_string(face.corners.size()) +
                             " corners, up to " + fixed(worst, 3) +
                             " mm off it; at least 3 on the plane and not on one line were needed");
        }
    }
}

// Evenly spread points of all faces, by the same quasirandom sequence for each triangle of the fan.
Scan sampled_faces(const std::vector<PlaneFace>& planes) {
    double area = 0;
    for (const PlaneFace& face : planes) {
        area += area_of_face(face);
    }
    Scan scan;
    scan.name = "the nominal planes";
    for (const PlaneFace& face : planes) {
        for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
            const Vector3d a = face.corners[0], u = face.corners[i] - a, v = face.corners[i + 1] - a;
            const auto count = static_cast<std::size_t>(u.cross(v).norm() / 2 / area * kPlaneSamples);
            for (std::size_t n = 0; n < count; ++n) {
                double s = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(n), 1);
                double t = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(n), 1);
                if (s + t > 1) {
                    s = 1 - s;
                    t = 1 - t;
                }
                scan.points.push_back((a + s * u + t * v).cast<float>());
                scan.normals.push_back(face.normal.cast<float>());
            }
        }
    }
    return scan;
}

double size_of_face(const PlaneFace& face) {
    double size = 0;
    for (const Vector3d& corner : face.corners) {
        size = std::max(size, (corner - face.corners[0]).norm());
    }
    return size;
}

// Within the polygon, off its edges by `border`; its corners may turn either way about the normal.
bool within_face(const PlaneFace& face, const Vector3d& q, double border) {
    int left = 0, right = 0;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
        const Vector3d &a = face.corners[i], &b = face.corners[(i + 1) % face.corners.size()];
        const double off = face.normal.cross((b - a).normalized()).dot(q - a);
        left += off > border;
        right += off < -border;
    }
    const int all = static_cast<int>(face.corners.size());
    return left == all || right == all;
}

struct PlaneField {
    Vector3d sum{0, 0, 0};
    std::size_t count = 0;
};

// The means of the points that lie on a face, field by field: neighbours share their error, fields do not.
FrameFeature feature_of_face(const Scan& scan, const PlaneFace& face, const Isometry3d& T, const BestFit& fit,
                             int level) {
    constexpr double kWidth = 4.685;
    const Isometry3d back = T.inverse();
    const double size = size_of_face(face), field = size / kFieldsAcross;
    std::map<std::array<std::int64_t, 3>, PlaneField> fields;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Vector3d p = scan.position(i), q = back * p;
        if (std::abs(face.normal.dot(q) - face.offset_mm) < kWidth * fit.scale_mm &&
            within_face(face, q, kBorder * size)) {
            const Vector3d at = (q - face.corners[0]) / field;
            const std::array<std::int64_t, 3> key{static_cast<std::int64_t>(std::floor(at.x())),
                                                  static_cast<std::int64_t>(std::floor(at.y())),
                                                  static_cast<std::int64_t>(std::floor(at.z() + 0.5))};
            fields[key].sum += p;
            ++fields[key].count;
        }
    }
    FrameFeature feature{face.name, level, false, {}, {}};
    std::vector<double> counts;
    for (const auto& [key, f] : fields) {
        counts.push_back(static_cast<double>(f.count));
    }
    // What stands on the face crosses its plane: such fields hold few points, spread over the whole gate.
    const double typical = quantile(counts, 0.5);
    for (const auto& [key, f] : fields) {
        if (f.count >= kFewestInField && static_cast<double>(f.count) > kLeastFilled * typical) {
            const double n = static_cast<double>(f.count);
            feature.rows.push_back(
                {face.normal, face.offset_mm, f.sum / n, fit.scale_mm * std::sqrt(fit.correlation / n)});
        }
    }
    if (feature.rows.size() < kFewestFields) {
        throw InputError("calibrate: the scan shows plane " + face.name + " in " + std::to_string(feature.rows.size()) +
                         " fields; at least " + std::to_string(kFewestFields) + " were needed; scan more of it");
    }
    return feature;
}

}  // namespace

FrameResult calibrate_scanned_planes(const Scan& scan, const std::vector<PlaneFace>& planes,
                                     const std::vector<WorkPoint>& work_points, const BestFitOptions& options) {
    check_faces(planes);
    BestFitOptions search = options;
    search.nominal_sensor_mm.reset();
    search.frame.limit_mm = std::numeric_limits<double>::infinity();  // of the start nothing is asked
    const BestFit fit = calibrate_surface(scan, sampled_faces(planes), work_points, search);
    if (!fit.frame.pass()) {
        return fit.frame;
    }
    const Isometry3d T = fit.frame.base_from_part;
    std::vector<FrameFeature> features;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        features.push_back(feature_of_face(scan, planes[i], T, fit, static_cast<int>(i)));
    }
    return calibrate_frame(features, work_points, options.frame, T);
}

}  // namespace seampath
