#include "stages/extract/rims.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/extract/face_width.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath::detail {
namespace {

constexpr double kLeastFaceWidth = 1.0 / 3;  // of the wider face
constexpr double kSurelyRim = 1.0 / 4;       // of the wider face, whatever the plate's other rims are like
constexpr double kStrip = 1.5;               // times its width a rim is long at least, to tell a thickness
constexpr double kAlike = 1.5;               // times a plate's thickness is as wide as its rims are seen
constexpr double kLeastRim = 0.5;            // of the narrower face's width

// A place in the middle of a face, between its edges.
struct Middle {
    Eigen::Vector3d p, n;
};

// What lies on both sides of an edge.
struct Sides {
    std::vector<Middle> middle[2];
    double width[2] = {0, 0};  // mm, median
    double length = 0;         // mm, of the edge
    int narrow() const { return width[0] <= width[1] ? 0 : 1; }
};

Sides sides_of(const Around& around, const Fold& edge) {
    const double most = 400 * around.grid.cell();
    Sides sides;
    sides.length = length_of(edge.way);
    for (int k = 0; k < 2; ++k) {
        std::vector<double> widths;
        for (std::size_t i = 0; i < edge.way.size(); i += std::max<std::size_t>(1, edge.way.size() / 40)) {
            const Section& at = edge.way[i].section;
            const Eigen::Vector3d t = at.n1.cross(at.n2).normalized(), n = k == 0 ? at.n1 : at.n2;
            const Eigen::Vector3d d = k == 0 ? t.cross(n) : n.cross(t);
            const double width = face_width(around.surfels, around.grid, at.p, d, n, most);
            widths.push_back(width);
            sides.middle[k].push_back({at.p + 0.5 * width * d, n});
        }
        sides.width[k] = quantile(widths, 0.5);
    }
    return sides;
}

// Whether most of a face's middle lies on rims.
bool on_rims(const std::vector<Middle>& face, const std::vector<Middle>& rims, double reach) {
    const auto known = std::count_if(face.begin(), face.end(), [&](const Middle& m) {
        return std::any_of(rims.begin(), rims.end(),
                           [&](const Middle& rim) { return (rim.p - m.p).norm() < reach && rim.n.dot(m.n) > 0.9; });
    });
    return 2 * static_cast<std::size_t>(known) > face.size();
}

// Whether two places lie on one flat face.
bool on_one_face(const Middle& a, const Middle& b, double reach) {
    return a.n.dot(b.n) > 0.95 && std::abs(a.n.dot(b.p - a.p)) < reach;
}

// How thick the plate is that an edge's wider face belongs to, by the narrow faces at the other edges of that face:
// half of the way along them they are no wider. 0 where such edges are short beside this one.
double thickness_beside(const std::vector<Sides>& sides, std::size_t edge, double reach) {
    const Sides& own = sides[edge];
    const auto& face = own.middle[1 - own.narrow()];
    std::vector<std::pair<double, double>> rims;  // width, length
    double length = 0;
    for (std::size_t j = 0; j < sides.size(); ++j) {
        const int narrow = sides[j].narrow();
        const double width = sides[j].width[narrow];
        const auto& theirs = sides[j].middle[1 - narrow];
        const bool strip = width < kLeastFaceWidth * sides[j].width[1 - narrow] && sides[j].length > kStrip * width;
        if (j != edge && strip && std::any_of(face.begin(), face.end(), [&](const Middle& m) {
                return on_one_face(m, theirs[theirs.size() / 2], reach);
            })) {
            rims.emplace_back(width, sides[j].length);
            length += sides[j].length;
        }
    }
    if (length < 0.5 * own.length) {
        return 0;
    }
    std::sort(rims.begin(), rims.end());
    double before = 0;
    for (const auto& [width, of_length] : rims) {
        before += of_length;
        if (before >= 0.5 * length) {
            return width;
        }
    }
    return 0;
}

}  // namespace

double length_of(const std::vector<TrackPoint>& way) {
    double length = 0;
    for (std::size_t i = 1; i < way.size(); ++i) {
        length += (way[i].section.p - way[i - 1].section.p).norm();
    }
    return length;
}

void leave_out_rims(const Around& around, double max_thickness, std::vector<Fold>& edges,
                    std::vector<std::string>& remarks) {
    std::vector<Sides> sides;
    std::vector<std::string> why(edges.size());
    std::vector<Middle> rims;
    const double reach = 3 * around.grid.cell();
    for (const Fold& edge : edges) {
        sides.push_back(sides_of(around, edge));
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const Sides& s = sides[i];
        const int k = s.narrow();
        const double length = s.length, thickness = thickness_beside(sides, i, reach);
        const bool unlike_rims = thickness > 0 && s.width[k] > kAlike * thickness;
        const double widest =
            max_thickness > 0 ? max_thickness : (unlike_rims ? kSurelyRim : kLeastFaceWidth) * s.width[1 - k];
        if (s.width[k] < widest) {
            why[i] = "a face of " + fixed(s.width[k], 1) + " mm beside one of " + fixed(s.width[1 - k], 1) +
                     " mm is taken for a plate's rim; extract.max_thickness_mm sets how wide a rim may be";
            // The edge that is shorter than a rim is wide runs across it.
            if (length > s.width[k]) {
                rims.insert(rims.end(), s.middle[k].begin(), s.middle[k].end());
            }
        } else if (length < kLeastRim * s.width[k]) {
            why[i] = "shorter than half of its narrower face, " + fixed(s.width[k], 1) + " mm";
        }
    }
    std::vector<Fold> joints;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (why[i].empty() && (on_rims(sides[i].middle[0], rims, reach) || on_rims(sides[i].middle[1], rims, reach))) {
            why[i] = "one of its faces is a plate's rim, by its other edge";
        }
        if (why[i].empty()) {
            joints.push_back(std::move(edges[i]));
        } else {
            remarks.push_back("a convex edge of " + fixed(length_of(edges[i].way), 1) + " mm was left out: " + why[i]);
        }
    }
    edges = std::move(joints);
}

}  // namespace seampath::detail
