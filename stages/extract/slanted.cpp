#include "stages/extract/slanted.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "stages/geometry/lot.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/surface_fit.hpp"
#include "stages/text.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr double kSparse = 2, kTooSparse = 5;   // point distance, in those of the scan
constexpr std::size_t kLeastFacePoints = 30;    // of a face
constexpr std::size_t kEnoughForWindows = 500;  // a face of more is found as others are, or is none
constexpr std::size_t kMostFacePoints = 6000;   // of a face or beside it: more only take time
constexpr int kFaceTrials = 400;         // a quarter of the points on the face: failure chance (1 - 1/64)^400 = 0.2 %
constexpr std::size_t kMostGrowth = 20;  // of a face's points, by those near well-seen surfaces
constexpr double kOnePlane = 0.8;        // of the points of a sparse surface, on the face's plane
constexpr double kLeastHeight = 10;      // of a face over the seam, in its point distances
constexpr double kBeside = 4;            // point distances within which a face must reach the seam
constexpr double kOneSide = 0.9;         // of a face's points, on the air side of the other
constexpr double kLeastSlanted = 10;     // of a seam, in point distances of the scan

struct Face {
    SurfaceFit plane;
    Points points;
    double spacing;  // mm
};

// Distance of the surfel's points from each other, by how many there are in its neighbourhood.
double spacing_at(const Surfels& surfels, const PointGrid& grid, std::size_t i) {
    double count = 0;
    for (const std::uint32_t j : surfels.neighbours[i]) {
        count += static_cast<double>(grid.points(j).size());
    }
    return std::sqrt(std::numbers::pi * surfels.radius * surfels.radius / std::max(1.0, count));
}

// Surfels on sparse surfaces, in groups that hang together.
std::vector<std::vector<std::uint32_t>> sparse_groups(const Around& around) {
    const auto& at = around.surfels.at;
    const double usual = around.field.overall.spacing;
    std::vector<char> open(at.size(), 0);
    for (std::size_t i = 0; i < at.size(); ++i) {
        const double spacing = spacing_at(around.surfels, around.grid, i);
        open[i] = spacing > kSparse * usual && spacing < 2 * kTooSparse * usual;  // fewer at a face's rim
    }
    std::vector<std::vector<std::uint32_t>> groups;
    for (std::uint32_t i = 0; i < at.size(); ++i) {
        if (!open[i]) {
            continue;
        }
        std::vector<std::uint32_t> group{i};
        open[i] = 0;
        for (std::size_t k = 0; k < group.size(); ++k) {
            for (const std::uint32_t j : around.surfels.neighbours[group[k]]) {
                if (open[j]) {
                    open[j] = 0;
                    group.push_back(j);
                }
            }
        }
        if (group.size() >= kLeastFacePoints / 2) {
            groups.push_back(std::move(group));
        }
    }
    return groups;
}

bool before(const Vector3d& a, const Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// At most kMostFacePoints of them, by lot.
Points points_of(const PointGrid& grid, const std::vector<std::uint32_t>& cells) {
    Points points;
    std::size_t all = 0;
    for (const std::uint32_t cell : cells) {
        all += grid.points(cell).size();
    }
    const double share = std::min(1.0, static_cast<double>(kMostFacePoints) / static_cast<double>(all));
    for (const std::uint32_t cell : cells) {
        for (const Eigen::Vector3f& p : grid.points(cell)) {
            if (lot_of(p) <= share * 4294967295.0) {
                points.push_back(p.cast<double>());
            }
        }
    }
    // Whatever the order of the scan's points.
    std::sort(points.begin(), points.end(), before);
    return points;
}

// Points of the plane that holds most of them within `tolerance`; they leave `points`.
Points take_plane(Points& points, double tolerance) {
    Vector3d best_n = Vector3d::Zero();
    double best_d = 0;
    std::size_t most = 0;
    for (int trial = 0; trial < kFaceTrials && points.size() >= kLeastFacePoints; ++trial) {
        const auto pick = [&](int k) { return points[lot_of(Vector3d(trial, k, 1).cast<float>()) % points.size()]; };
        const Vector3d a = pick(0), n = (pick(1) - a).cross(pick(2) - a);
        if (n.norm() == 0) {
            continue;
        }
        const Vector3d unit = n.normalized();
        const auto count = static_cast<std::size_t>(std::count_if(
            points.begin(), points.end(), [&](const Vector3d& p) { return std::abs(unit.dot(p - a)) < tolerance; }));
        if (count > most) {
            most = count;
            best_n = unit;
            best_d = unit.dot(a);
        }
    }
    Points taken, rest;
    for (const Vector3d& p : points) {
        (most > 0 && std::abs(best_n.dot(p) - best_d) < tolerance ? taken : rest).push_back(p);
    }
    points = std::move(rest);
    return taken;
}

// Each point counts by itself: they lie further apart than the noise that neighbours share reaches.
std::optional<Face> face_of(Points points, const Vector3d& outward, double least_scale) {
    std::vector<std::uint32_t> block(points.size());
    for (std::size_t i = 0; i < block.size(); ++i) {
        block[i] = static_cast<std::uint32_t>(i);
    }
    if (points.size() < kLeastFacePoints) {
        return std::nullopt;
    }
    auto plane = fit_plane(points, block, outward, least_scale);
    if (!plane) {
        return std::nullopt;
    }
    std::vector<double> nearest;
    const std::size_t stride = 1 + points.size() / 1000;
    for (std::size_t i = 0; i < points.size(); i += stride) {
        double d = std::numeric_limits<double>::infinity();
        for (const Vector3d& q : points) {
            const double d2 = (points[i] - q).squaredNorm();
            d = d2 > 0 ? std::min(d, d2) : d;
        }
        nearest.push_back(2 * std::sqrt(d));  // of random points; Clark & Evans 1954
    }
    return Face{std::move(*plane), std::move(points), quantile(nearest, 0.5)};
}

// The face with all points of its plane that hang together with its own: near well-seen surfaces the neighbourhoods of
// surfels don't look sparse.
std::optional<Face> grown(const PointGrid& grid, const Face& face, double least_scale) {
    const double tolerance = 4 * std::max(least_scale, face.plane.scale()), reach = 1.5 * face.spacing;
    const Vector3d half = Vector3d::Constant(reach);
    std::set<std::size_t> taken;
    Points points = face.points;
    const std::size_t most = std::min(kMostFacePoints, kMostGrowth * points.size());
    for (std::size_t k = 0; k < points.size() && points.size() < most; ++k) {
        const Vector3d from = points[k];
        grid.for_cells_in_box(from - half, from + half, [&](std::size_t cell) {
            for (std::size_t i = 0; i < grid.points(cell).size(); ++i) {
                const Vector3d q = grid.points(cell)[i].cast<double>();
                if ((q - from).norm() < reach && std::abs(face.plane.distance(q)) < tolerance &&
                    taken.insert(grid.first_point(cell) + i).second) {
                    points.push_back(q);
                }
            }
        });
    }
    if (points.size() >= most) {
        return std::nullopt;  // strays before a well-seen plane, no face of their own
    }
    points.erase(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(face.points.size()));
    std::sort(points.begin(), points.end(), before);
    auto whole = face_of(std::move(points), std::get<Plane>(face.plane.shape()).normal, least_scale);
    if (whole) {
        whole->spacing = face.spacing;  // points of other surfaces that lie on the plane are nearer to each other
    }
    return whole;
}

std::vector<Face> sparse_faces(const Around& around) {
    const ScanScale& scale = around.field.overall;
    std::vector<Face> faces;
    for (const auto& group : sparse_groups(around)) {
        Points rest = points_of(around.grid, group);
        const auto all = static_cast<double>(rest.size());
        Points plane = take_plane(rest, 2 * scale.noise);
        if (static_cast<double>(plane.size()) < kOnePlane * all) {
            continue;  // the wall of a hole, strays
        }
        const auto face = face_of(std::move(plane), Vector3d::UnitX(), 0.1 * scale.noise);
        if (face && face->spacing < kTooSparse * scale.spacing && face->plane.scale() < 1.2 * scale.noise) {
            auto whole = grown(around.grid, *face, 0.1 * scale.noise);
            if (whole && whole->points.size() < kEnoughForWindows) {
                faces.push_back(std::move(*whole));
            }
        }
    }
    return faces;
}

// Well-seen planes beside a sparse face.
std::vector<Face> faces_beside(const Around& around, const Face& sparse) {
    constexpr std::size_t kMost = 4;
    const double noise = around.field.at(sparse.plane.origin()).noise;
    const Vector3d reach = Vector3d::Constant(kBeside * sparse.spacing);
    std::vector<std::uint32_t> near;
    for (const Vector3d& p : sparse.points) {
        around.grid.for_cells_in_box(p - reach, p + reach,
                                     [&](std::size_t cell) { near.push_back(static_cast<std::uint32_t>(cell)); });
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    Points points = points_of(around.grid, near);
    std::erase_if(points, [&](const Vector3d& p) {
        return std::abs(sparse.plane.distance(p)) < 4 * std::max(0.1 * noise, sparse.plane.scale());
    });
    std::vector<Face> faces;
    while (faces.size() < kMost) {
        auto face = face_of(take_plane(points, 3 * noise), Vector3d::UnitX(), 0.1 * noise);
        if (!face) {
            break;
        }
        faces.push_back(std::move(*face));
    }
    return faces;
}

// The face's normal, out of the material as that of the surfels on it is.
Vector3d outward_normal_of(const Around& around, const Face& face) {
    const Vector3d n = std::get<Plane>(face.plane.shape()).normal;
    double sum = 0;
    for (const Vector3d& p : face.points) {
        around.grid.for_cells_in_box(p, p, [&](std::size_t cell) { sum += n.dot(around.surfels.at[cell].n); });
    }
    return sum < 0 ? Vector3d(-n) : n;
}

// Where along the line, from p along t, a face has points beside it.
std::pair<double, double> stretch_beside(const Face& face, const Vector3d& p, const Vector3d& t) {
    std::vector<double> along;
    for (const Vector3d& q : face.points) {
        const double s = (q - p).dot(t);
        if ((q - p - s * t).norm() < kBeside * face.spacing) {
            along.push_back(s);
        }
    }
    return {quantile(along, 0.03), quantile(along, 0.97)};
}

// Of the points, on that side of the face to which n points.
double share_above(const Face& face, const Vector3d& n, const Points& points) {
    const auto above = std::count_if(points.begin(), points.end(),
                                     [&](const Vector3d& p) { return n.dot(p - face.plane.origin()) > 0; });
    return static_cast<double>(above) / static_cast<double>(points.size());
}

bool known_already(const std::vector<Seam>& known, const Vector3d& p, double reach) {
    return std::any_of(known.begin(), known.end(), [&](const Seam& seam) {
        return std::any_of(seam.points.begin(), seam.points.end(),
                           [&](const SeamPoint& q) { return (q.p - p).norm() < reach; });
    });
}

std::optional<Seam> fillet_of(const Around& around, const Face& sparse, const Face& beside, double min_length) {
    constexpr double kLeastTurn = 0.35;  // rad
    Vector3d n1 = std::get<Plane>(sparse.plane.shape()).normal;
    const Vector3d n2 = outward_normal_of(around, beside);
    const double on_n1 = share_above(sparse, n1, beside.points);
    if (n1.cross(n2).norm() < std::sin(kLeastTurn) || share_above(beside, n2, sparse.points) < kOneSide ||
        std::max(on_n1, 1 - on_n1) < kOneSide) {
        return std::nullopt;
    }
    n1 *= on_n1 < 0.5 ? -1 : 1;
    const Vector3d t = n1.cross(n2).normalized();
    Eigen::Matrix3d A;
    A << n1.transpose(), n2.transpose(), t.transpose();
    const Vector3d p = A.partialPivLu().solve(
        Vector3d(n1.dot(sparse.plane.origin()), n2.dot(beside.plane.origin()), t.dot(sparse.plane.origin())));
    const auto [a1, b1] = stretch_beside(sparse, p, t);
    const auto [a2, b2] = stretch_beside(beside, p, t);
    std::vector<double> height;
    for (const Vector3d& q : sparse.points) {
        height.push_back(n2.dot(q - p));
    }
    if (quantile(height, 0.9) < kLeastHeight * sparse.spacing) {
        return std::nullopt;
    }
    const double from = std::max(a1, a2), to = std::min(b1, b2), length = to - from;
    if (length < (min_length > 0 ? min_length : kLeastSlanted * around.field.overall.spacing)) {
        return std::nullopt;
    }
    Seam seam;
    const double bend = std::acos(std::clamp(n1.dot(n2), -1.0, 1.0));
    const auto count = std::max(6, static_cast<int>(std::lround(length / around.following.step)) + 1);
    for (int k = 0; k < count; ++k) {
        const Vector3d q = p + (from + length * k / (count - 1)) * t;
        const double sigma = std::hypot(sparse.plane.sigma(q), beside.plane.sigma(q)) / std::sin(bend);
        seam.points.push_back({around.scan.origin_mm + q, n1, n2, sigma, false});
    }
    seam.confidence = 0.5;
    seam.kind_reason = "two planes meet around the air at " + fixed(180 - bend * 180 / std::numbers::pi, 0) +
                       " deg; one is seen at a slant, by " + std::to_string(sparse.points.size()) + " points";
    return seam;
}

}  // namespace

std::vector<Seam> find_slanted_fillets(const Around& around, const std::vector<Seam>& known, double min_length_mm) {
    std::vector<Seam> seams;
    for (const Face& sparse : sparse_faces(around)) {
        for (const Face& beside : faces_beside(around, sparse)) {
            auto seam = fillet_of(around, sparse, beside, min_length_mm);
            if (seam && !known_already(known, seam->points[seam->points.size() / 2].p, 2 * sparse.spacing)) {
                seams.push_back(std::move(*seam));
            }
        }
    }
    return seams;
}

}  // namespace seampath::detail
