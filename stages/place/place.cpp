#include "stages/place/place.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/error.hpp"
#include "stages/geometry/seam_pieces.hpp"
#include "stages/place/spline_nodes.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

// Largest distance of the points strictly between i and j (indices may run past the end of a closed seam) from the
// chord.
double chord_error(const std::vector<Eigen::Vector3d>& p, std::size_t i, std::size_t j) {
    const Eigen::Vector3d &a = p[i % p.size()], &b = p[j % p.size()];
    const double length2 = (b - a).squaredNorm();
    double worst = 0;
    for (std::size_t k = i + 1; k < j; ++k) {
        const Eigen::Vector3d v = p[k % p.size()] - a;
        const double x = length2 > 0 ? std::clamp(v.dot(b - a) / length2, 0.0, 1.0) : 0;
        worst = std::max(worst, (v - x * (b - a)).norm());
    }
    return worst;
}

struct Path {
    std::vector<std::size_t> index;  // first and last included; the last may be first + size for a closed seam
    double cost = std::numeric_limits<double>::infinity();
};

// Fewest chords from `first` to `last`, and of those the one with the least sum of squared chord errors: a shortest
// path by dynamic programming over the chords that hold the tolerance. Neighbours always hold it.
Path fewest_chords(const std::vector<Eigen::Vector3d>& p, std::size_t first, std::size_t last, const PlaceOptions& o) {
    const std::size_t n = last - first + 1;
    const double per_chord = static_cast<double>(n) * o.chord_tolerance_mm * o.chord_tolerance_mm * 2 + 1;
    std::vector<double> cost(n, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(n, 0);
    cost[0] = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) {
        double length = 0;
        for (std::size_t j = i + 1; j < n; ++j) {
            length += (p[(first + j) % p.size()] - p[(first + j - 1) % p.size()]).norm();
            if (j > i + 1 && length > o.max_spacing_mm) {
                break;
            }
            const double error = chord_error(p, first + i, first + j);
            if (error > 4 * o.chord_tolerance_mm) {
                break;  // it does not come back within one spacing: the seam has turned away
            }
            const double total = cost[i] + per_chord + error * error;
            if (error <= o.chord_tolerance_mm && total < cost[j]) {
                cost[j] = total;
                before[j] = i;
            }
        }
    }
    Path path;
    path.cost = cost[n - 1];
    for (std::size_t j = n - 1; j > 0; j = before[j]) {
        path.index.push_back(first + j);
    }
    path.index.push_back(first);
    std::reverse(path.index.begin(), path.index.end());
    return path;
}

/// The nodes of the fewest chords.
std::vector<std::size_t> chord_nodes(const std::vector<Eigen::Vector3d>& p, bool closed, const PlaceOptions& options) {
    const std::size_t n = p.size();
    if (!closed) {
        return fewest_chords(p, 0, n - 1, options).index;
    }
    // One node of the best ring lies within the first chord of any ring: try all places there as the start.
    Path best;
    const Path any = fewest_chords(p, 0, n, options);
    for (std::size_t start = 0; start < any.index[1]; ++start) {
        Path ring = fewest_chords(p, start, start + n, options);
        if (ring.cost < best.cost) {
            best = std::move(ring);
        }
    }
    best.index.pop_back();
    for (std::size_t& i : best.index) {
        i %= n;
    }
    std::sort(best.index.begin(), best.index.end());
    return best.index;
}

/// The nodes of a spline.
void add_spline_nodes(const Seam& seam, const PlaceOptions& options, Nodes& nodes) {
    const SmoothLine line = smooth_line(seam);
    if (line.closed && 8 * options.min_spacing_mm > line.length) {
        throw InputError("place: place.min_spacing_mm is " + shortest(options.min_spacing_mm) + "; a closed seam of " +
                         fixed(line.length, 1) + " mm needs room for 8 nodes; lower place.min_spacing_mm");
    }
    const Chosen chosen =
        options.method == PlaceMethod::spline ? nodes_by_error(line, options) : nodes_at_equal_steps(line, options);
    nodes.line = NodeLine{{}, {}, line.length, chosen.worst};
    for (const std::size_t foot : chosen.foot) {
        nodes.index.push_back(line.index[foot]);
        nodes.line->station_mm.push_back(line.s[foot]);
        nodes.line->p.push_back(line.p[foot]);
    }
}

void check_spacing(const PlaceOptions& o) {
    if (o.min_spacing_mm > 0 && o.method == PlaceMethod::chord) {
        throw InputError("place: place.min_spacing_mm is " + shortest(o.min_spacing_mm) +
                         " and place.method is chord, whose chords are as short as their tolerance asks for; set "
                         "place.min_spacing_mm to 0 or place.method to spline or uniform");
    }
    if (o.min_spacing_mm > o.max_spacing_mm) {
        throw InputError("place: place.min_spacing_mm is " + shortest(o.min_spacing_mm) +
                         ", above place.max_spacing_mm, " + shortest(o.max_spacing_mm) +
                         "; a range was needed; lower the one or raise the other");
    }
}

// Those of each piece, and its corners.
Nodes place_round_corners(const Seam& seam, const PlaceOptions& options) {
    Nodes nodes;
    if (options.method != PlaceMethod::chord) {
        nodes.line.emplace();
    }
    for (const SeamPiece& piece : pieces_of(seam)) {
        const Nodes own = place(piece.seam, options);
        nodes.max_chord_error_mm = std::max(nodes.max_chord_error_mm, own.max_chord_error_mm);
        for (std::size_t k = 0; k < own.index.size(); ++k) {
            const std::size_t index = piece.index[own.index[k]];
            if (!nodes.index.empty() && (index == nodes.index.back() || index == 0)) {
                continue;
            }
            nodes.index.push_back(index);
            if (nodes.line) {
                nodes.line->station_mm.push_back(nodes.line->length_mm + own.line->station_mm[k]);
                nodes.line->p.push_back(own.line->p[k]);
            }
        }
        if (nodes.line) {
            nodes.line->length_mm += own.line->length_mm;
            nodes.line->max_error_mm = std::max(nodes.line->max_error_mm, own.line->max_error_mm);
        }
    }
    return nodes;
}

}  // namespace

Fields describe(PlaceOptions& o) {
    return {
        {"method", choice(o.method, kPlaceMethodNames),
         "nodes of straight moves (chord), of a cubic spline, or of one at equal steps (uniform)"},
        {"chord_tolerance_mm", &o.chord_tolerance_mm,
         "largest distance of the seam from the straight line between two nodes, for chord", above(0)},
        {"spline_tolerance_mm", &o.spline_tolerance_mm,
         "largest distance of the smoothed seam from the spline through the nodes, for spline and uniform", above(0)},
        {"min_spacing_mm", &o.min_spacing_mm,
         "least distance between two nodes along the seam, whatever the error, for spline and uniform", at_least(0)},
        {"max_spacing_mm", &o.max_spacing_mm, "largest distance between two nodes along the seam", above(0)}};
}

Nodes place(const Seam& seam, const PlaceOptions& options) {
    check_spacing(options);
    if (!seam.corners.empty()) {
        return place_round_corners(seam, options);
    }
    const std::size_t n = seam.points.size();
    const std::size_t least = options.method == PlaceMethod::chord ? 4 : 6;
    if (n < least) {
        throw InputError("place: the seam has " + std::to_string(n) + " points; at least " + std::to_string(least) +
                         " are needed; lower extract.station_mm");
    }
    std::vector<Eigen::Vector3d> p;
    for (const SeamPoint& point : seam.points) {
        p.push_back(point.p);
    }
    Nodes nodes;
    if (options.method == PlaceMethod::chord) {
        nodes.index = chord_nodes(p, seam.closed, options);
    } else {
        add_spline_nodes(seam, options, nodes);
    }
    const std::size_t count = nodes.index.size();
    for (std::size_t k = 0; k + 1 < count + (seam.closed ? 1 : 0); ++k) {
        const std::size_t to = k + 1 < count ? nodes.index[k + 1] : nodes.index[0] + n;
        nodes.max_chord_error_mm = std::max(nodes.max_chord_error_mm, chord_error(p, nodes.index[k], to));
    }
    return nodes;
}

}  // namespace seampath
