#include "stages/extract/grooves.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "stages/angle.hpp"
#include "stages/extract/groove_way.hpp"
#include "stages/extract/registration.hpp"
#include "stages/text.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLeastGroove = 20;               // of a groove, in point distances
const double kLevel = std::cos(15 * kDegree);     // of the two tops against each other
const double kParallel = std::cos(15 * kDegree);  // of the two top edges
const double kSquare = std::sin(8 * kDegree);
constexpr double kWidest = 60;     // mm, between the top edges
constexpr double kMostStep = 0.5;  // of the tops, in widths

/// A convex crease read as the top edge of a bevel.
struct GrooveEdge {
    std::size_t crease;
    Vector3d p, t, top, bevel;
};

std::vector<GrooveEdge> edges_of(const std::vector<Crease>& creases) {
    std::vector<GrooveEdge> edges;
    for (std::size_t i = 0; i < creases.size(); ++i) {
        const Crease& c = creases[i];
        if (!c.concave) {
            edges.push_back({i, c.p, c.t, c.n1, c.n2});
            edges.push_back({i, c.p, c.t, c.n2, c.n1});
        }
    }
    return edges;
}

// Whether b is the other side of a groove of which a is one; its width.
std::optional<double> faces(const GrooveEdge& a, const GrooveEdge& b, double reach) {
    if (a.crease == b.crease || a.top.dot(b.top) < kLevel || std::abs(a.t.dot(b.t)) < kParallel) {
        return std::nullopt;
    }
    const Vector3d d = b.p - a.p;
    const double along = d.dot(a.t), step = d.dot(a.top);
    const Vector3d across = d - along * a.t - step * a.top;
    const double width = across.norm();
    if (std::abs(along) > reach || width < 0.5 * reach || width > kWidest || std::abs(step) > kMostStep * width) {
        return std::nullopt;
    }
    const Vector3d x = across / width;
    const bool facing = a.bevel.dot(x) > 0.3 && b.bevel.dot(x) < -0.3;
    const bool bevelled = std::max(a.bevel.dot(a.top), b.bevel.dot(b.top)) > kSquare;
    const bool open = std::min(a.bevel.dot(a.top), b.bevel.dot(b.top)) > -kSquare;
    return facing && bevelled && open ? std::optional(width) : std::nullopt;
}

// a on the right of travel.
GrooveSeed seed_of(const GrooveEdge& a, const GrooveEdge& b, double down) {
    GrooveSeed seed;
    const Vector3d up = (a.top + b.top).normalized();
    Vector3d left = b.p - a.p;
    left -= left.dot(a.t) * a.t + left.dot(up) * up;
    left.normalize();
    seed.frame.t = left.cross(up).normalized();
    seed.frame.up = (up - up.dot(seed.frame.t) * seed.frame.t).normalized();
    seed.frame.p = 0.5 * (a.p + b.p);
    const auto in_section = [&](const Vector3d& v) { return Vector2d(v.dot(seed.frame.left()), v.dot(seed.frame.up)); };
    int k = 0;
    for (const GrooveEdge* e : {&a, &b}) {
        const auto side = static_cast<std::size_t>(k);
        const Vector2d n = in_section(e->bevel).normalized(), top = in_section(e->top).normalized();
        const Vector2d downwards = k == 0 ? Vector2d(n[1], -n[0]) : Vector2d(-n[1], n[0]);
        seed.shape.corner[side] = in_section(e->p - seed.frame.p);
        seed.shape.end[side] = seed.shape.corner[side] + down * downwards;
        seed.shape.out[side] = k == 0 ? Vector2d(-top[1], top[0]) : Vector2d(top[1], -top[0]);
        ++k;
    }
    return seed;
}

double length_of(const GrooveWay& way) {
    double length = 0;
    for (std::size_t i = 1; i < way.places.size(); ++i) {
        const GroovePlace &a = way.places[i - 1], &b = way.places[i];
        length += (b.frame.at(b.numbers.root()) - a.frame.at(a.numbers.root())).norm();
    }
    return length;
}

// Whether a place lies inside the groove or on its edges.
bool within(const GrooveWay& way, const Vector3d& p, double reach) {
    for (const GroovePlace& place : way.places) {
        const Vector3d v = p - place.frame.p;
        if (std::abs(v.dot(place.frame.t)) > 3 * reach) {
            continue;
        }
        const GrooveShape& shape = place.fit.shape;
        const Vector2d x(v.dot(place.frame.left()), v.dot(place.frame.up));
        const double low = std::min(shape.end[0][1], shape.end[1][1]),
                     high = std::max(shape.corner[0][1], shape.corner[1][1]);
        if (x[0] > shape.corner[0][0] - reach && x[0] < shape.corner[1][0] + reach && x[1] > low - 3 * reach &&
            x[1] < high + reach) {
            return true;
        }
    }
    return false;
}

double median(const GrooveWay& way, int number) {
    std::vector<double> values;
    for (const GroovePlace& place : way.places) {
        values.push_back(place.numbers.value[number]);
    }
    return quantile(values, 0.5);
}

// Whether an edge is bevelled, at an angle that is the same all along.
bool is_bevelled(const GrooveWay& way, int number) {
    const double angle = median(way, number);
    std::vector<double> off;
    for (const GroovePlace& place : way.places) {
        off.push_back(std::abs(place.numbers.value[number] - angle));
    }
    return angle - 1.4826 * quantile(off, 0.5) > kSquareSide;
}

// Whether the faces that were followed are a groove's: one edge at least is bevelled, none is undercut, and their
// sections follow each other along a line. Strays between two plates may look like faces, but hardly do that.
bool is_groove(const GrooveWay& way, double step) {
    constexpr int kBevel1 = 4, kBevel2 = 5, kDepth = 7;
    std::vector<double> steps, sigmas;
    for (std::size_t i = 1; i < way.places.size(); ++i) {
        const GroovePlace &a = way.places[i - 1], &b = way.places[i];
        steps.push_back((b.frame.at(b.numbers.root()) - a.frame.at(a.numbers.root())).norm());
        sigmas.push_back(b.numbers.sigma(0));
    }
    return std::min(median(way, kBevel1), median(way, kBevel2)) > -kSquareSide &&
           (is_bevelled(way, kBevel1) || is_bevelled(way, kBevel2)) && quantile(steps, 0.5) < 3 * step &&
           quantile(sigmas, 0.5) < median(way, kDepth);
}

// The known way that runs along the same groove, which one seed may follow further than another; `ways.end()` if none.
auto same_groove(std::vector<GrooveWay>& ways, const GrooveWay& way, double reach) {
    return std::find_if(ways.begin(), ways.end(), [&](const GrooveWay& known) {
        const auto inside = std::count_if(way.places.begin(), way.places.end(), [&](const GroovePlace& place) {
            return within(known, place.frame.at(place.numbers.root()), reach);
        });
        return 2 * static_cast<std::size_t>(inside) > way.places.size();
    });
}

// What registration.hpp wants to know of the faces: their points off them, by view.
void add_differences(ViewDifferences& sum, const Around& around, const GrooveWay& way) {
    for (const auto part : {&GrooveFit::bevel, &GrooveFit::top}) {
        std::vector<TrackPoint> points;
        for (const GroovePlace& place : way.places) {
            const GrooveFit& fit = place.fit;
            const double half = 0.5 * around.following.step, gate = 4 * around.field.at(place.frame.p).noise;
            GrooveBox box{fit.shape.end[0], fit.shape.end[0]};
            for (std::size_t k = 0; k < 2; ++k) {
                for (const Vector2d& x : {fit.shape.end[k], Vector2d(fit.shape.corner[k] + 10 * fit.shape.out[k])}) {
                    box.low = box.low.cwiseMin(x);
                    box.high = box.high.cwiseMax(x);
                }
            }
            box.low.array() -= gate;
            box.high.array() += gate;
            TrackPoint& point = points.emplace_back();
            for (const GroovePoint& q :
                 groove_points(around.grid, around.following.view_starts, place.frame, -half, half, box)) {
                for (std::size_t k = 0; k < 2; ++k) {
                    const GrooveFace& face = (fit.*part)[k];
                    const double u = face.along(q.section()), off = face.off(q.section());
                    const double corner = face.along(fit.shape.corner[k]);
                    const bool on = part == &GrooveFit::bevel ? u < corner - gate : u > corner + gate;
                    if (on && std::abs(off) < gate) {
                        point.slab[k].push_back(
                            {Eigen::Vector3f::Zero(), static_cast<float>(u), static_cast<float>(off), q.view});
                    }
                }
            }
        }
        detail::add_differences(sum, points);
    }
}

std::string reason(const GrooveWay& way, const Seam& seam) {
    const auto median = [&](auto&& number) {
        std::vector<double> values;
        for (const GrooveStation& s : seam.groove) {
            values.push_back(number(s));
        }
        return quantile(values, 0.5);
    };
    std::string text = way.root.square ? "a bevel of " : "two bevels that make ";
    text += fixed(median([](const GrooveStation& s) { return s.included_angle_rad.value; }) / kDegree, 1) + " deg" +
            (way.root.square ? " faces a square edge" : " face each other") + " between level tops, " +
            fixed(median([](const GrooveStation& s) { return s.depth_mm.value; }), 2) + " mm deep, ";
    text += way.root.closed ? "and meet at the root"
                            : "and end " + fixed(median([](const GrooveStation& s) { return s.gap_mm.value; }), 2) +
                                  " mm apart at the root";
    if (way.root.as_other[0] || way.root.as_other[1]) {
        text += "; the " + std::string(way.root.as_other[0] ? "right" : "left") +
                " bevel is not seen to its end and taken to be as deep as the other";
    }
    return way.root.unseen
               ? text +
                     "; but a single view tells so, or that is wider than roots are prepared: it may be a shadow's end"
               : text;
}

Seam seam_of(const GrooveWay& way, const Vector3d& origin, double registration, double spacing) {
    Seam seam;
    seam.kind = JointKind::v_groove;
    seam.closed = way.closed;
    for (const GroovePlace& place : way.places) {
        const GrooveFrame& frame = place.frame;
        SeamPoint point;
        point.p = origin + frame.at(place.numbers.root());
        Vector3d* normal[2] = {&point.n1, &point.n2};
        for (std::size_t k = 0; k < 2; ++k) {
            *normal[k] =
                (frame.direction(place.numbers.normal[k]) - place.fit.bevel[k].slope_along * frame.t).normalized();
        }
        point.sigma_mm = place.numbers.sigma(registration);
        seam.points.push_back(point);
        seam.groove.push_back(station_of(place.numbers, registration));
    }
    // A groove fifteen point distances deep nobody takes for roughness.
    std::vector<double> depths;
    for (const GrooveStation& s : seam.groove) {
        depths.push_back(s.depth_mm.value);
    }
    seam.confidence = std::min(1.0, quantile(depths, 0.5) / (15 * spacing));
    seam.kind_reason = reason(way, seam);
    return seam;
}

}  // namespace

Grooves find_grooves(const Around& around, double min_length_mm) {
    const Tracker& following = around.following;
    Grooves result;
    result.claimed.assign(around.creases.size(), 0);
    std::vector<GrooveEdge> edges = edges_of(around.creases);
    std::stable_sort(edges.begin(), edges.end(), [&](const GrooveEdge& a, const GrooveEdge& b) {
        return around.creases[a.crease].weight > around.creases[b.crease].weight;
    });
    std::vector<char> tried(around.creases.size(), 0);
    std::vector<GrooveWay> ways;
    const double reach = around.surfels.radius;
    for (const GrooveEdge& a : edges) {
        if (tried[a.crease]) {
            continue;
        }
        std::optional<double> nearest;
        const GrooveEdge* partner = nullptr;
        for (const GrooveEdge& b : edges) {
            const auto width = tried[b.crease] ? std::nullopt : faces(a, b, 0.5 * reach);
            if (width && (!nearest || *width < *nearest)) {
                nearest = width;
                partner = &b;
            }
        }
        if (!partner) {
            continue;
        }
        auto way = follow_groove(following, seed_of(a, *partner, reach));
        if (way) {
            way = measure_groove(following, *way);
        }
        if (!way || !is_groove(*way, following.step)) {
            tried[a.crease] = 1;
            continue;
        }
        for (std::size_t i = 0; i < around.creases.size(); ++i) {
            tried[i] = tried[i] || within(*way, around.creases[i].p, 0.5 * reach);
        }
        tried[a.crease] = 1;
        const double length = length_of(*way);
        const double least = min_length_mm > 0 ? min_length_mm : kLeastGroove * around.field.overall.spacing;
        if (length < least) {
            result.remarks.push_back("a groove of " + fixed(length, 1) + " mm was left out: shorter than " +
                                     fixed(least, 1) + " mm");
            continue;
        }
        for (std::size_t i = 0; i < around.creases.size(); ++i) {
            result.claimed[i] = result.claimed[i] || within(*way, around.creases[i].p, 0.5 * reach);
        }
        const auto known = same_groove(ways, *way, 0.5 * reach);
        if (known == ways.end()) {
            ways.push_back(std::move(*way));
        } else if (length > length_of(*known)) {
            *known = std::move(*way);
        }
    }
    ViewDifferences differences;
    for (const GrooveWay& way : ways) {
        add_differences(differences, around, way);
    }
    result.registration_mm = registration_of(differences);
    const double counts =
        registration_that_counts(result.registration_mm, following.view_starts.size(), around.field.overall.noise);
    for (const GrooveWay& way : ways) {
        result.seams.push_back(seam_of(way, around.scan.origin_mm, counts, around.field.overall.spacing));
    }
    return result;
}

}  // namespace seampath::detail
