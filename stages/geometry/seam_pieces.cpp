#include "stages/geometry/seam_pieces.hpp"

#include <algorithm>
#include <utility>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/curve_part.hpp"

namespace seampath {
namespace {

// From each place to the next, both included.
template <class T>
std::vector<std::pair<T, T>> stretches_between(const std::vector<T>& corners, bool closed, T end) {
    std::vector<T> places = corners;
    if (!closed) {
        places.insert(places.begin(), T{0});
    }
    places.push_back(end);
    std::vector<std::pair<T, T>> stretches;
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
        stretches.emplace_back(places[k], places[k + 1]);
    }
    return stretches;
}

void take_normals(SeamPoint& point, const SeamPoint& neighbour) {
    point.n1 = neighbour.n1;
    point.n2 = neighbour.n2;
}

}  // namespace

std::vector<SeamPiece> pieces_of(const Seam& seam) {
    const std::size_t n = seam.points.size();
    ensure(!seam.closed || seam.corners.empty() || seam.corners.front() == 0, "a closed seam begins at a corner");
    std::vector<SeamPiece> pieces;
    for (const auto& [from, to] : stretches_between(seam.corners, seam.closed, seam.closed ? n : n - 1)) {
        ensure(to > from + 2, "a seam has points between its corners");
        SeamPiece piece;
        piece.seam.kind = seam.kind;
        piece.seam.confidence = seam.confidence;
        piece.seam.kind_reason = seam.kind_reason;
        for (std::size_t i = from; i <= to; ++i) {
            piece.index.push_back(i % n);
            piece.seam.points.push_back(seam.points[i % n]);
        }
        auto& points = piece.seam.points;
        take_normals(points.front(), points[1]);
        take_normals(points.back(), points[points.size() - 2]);
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

std::vector<ModelPiece> pieces_of(const SeamModel& model) {
    const ArcLength arc(model.curve);
    ensure(!model.closed || model.corners_mm.empty() || model.corners_mm.front() == 0,
           "a closed model begins at a corner");
    std::vector<ModelPiece> pieces;
    for (const auto& [from, to] : stretches_between(model.corners_mm, model.closed, arc.length())) {
        ModelPiece piece{from, {}};
        SeamModel& part = piece.model;
        part.kind = model.kind;
        part.model = model.model;
        part.reason = model.reason;
        const double end = to < arc.length() ? arc.parameter(to) : last_parameter(model.curve);
        part.curve = part_of(model.curve, arc.parameter(from), end);
        part.length_mm = ArcLength(part.curve).length();
        const double same = 1e-6 * (to - from);
        for (FlankSample flank : model.flanks) {
            if (flank.station_mm > from + same && flank.station_mm < to - same) {
                flank.station_mm -= from;
                part.flanks.push_back(flank);
            }
        }
        ensure(!part.flanks.empty(), "a model has flanks between its corners");
        part.flanks.insert(part.flanks.begin(), part.flanks.front());
        part.flanks.front().station_mm = 0;
        part.flanks.push_back(part.flanks.back());
        part.flanks.back().station_mm = part.length_mm;
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

}  // namespace seampath
