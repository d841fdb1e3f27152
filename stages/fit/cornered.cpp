#include "stages/fit/cornered.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/curve_part.hpp"
#include "stages/geometry/lines.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

// Pieces that end nearer to each other meet already, mm.
constexpr double kSamePlace = 1e-9;

// Sine of the angle below which two tangents come nearest to each other anywhere.
constexpr double kLeastSine = 0.1;

// Moves the end of `a` and the beginning of `b` to their corner.
void meet(CubicBSpline& a, CubicBSpline& b) {
    const Vector3d p = a.control.back(), q = b.control.front(), apart = q - p;
    if (apart.norm() < kSamePlace) {
        b.control.front() = p;
        return;
    }
    const Vector3d s = tangent(a, last_parameter(a)), t = tangent(b, first_parameter(b));
    const bool turns = s.cross(t).norm() > kLeastSine;
    a.control.back() = b.control.front() = turns ? nearest_of_lines(p, s, q, t).middle : Vector3d(p + 0.5 * apart);
}

}  // namespace

std::vector<Nodes> nodes_of_pieces(const Seam& seam, const Nodes& nodes, const std::vector<SeamPiece>& pieces) {
    std::vector<Nodes> result;
    for (const SeamPiece& piece : pieces) {
        Nodes& own = result.emplace_back();
        if (nodes.line) {
            own.line.emplace();
        }
        for (std::size_t i = 0; i < piece.index.size(); ++i) {
            const auto at = std::lower_bound(nodes.index.begin(), nodes.index.end(), piece.index[i]);
            if (at == nodes.index.end() || *at != piece.index[i]) {
                ensure(i > 0 && i + 1 < piece.index.size(), "corners and ends are nodes");
                continue;
            }
            own.index.push_back(i);
            if (nodes.line) {
                const auto k = static_cast<std::size_t>(at - nodes.index.begin());
                const bool round = seam.closed && i > 0 && piece.index[i] == 0;
                own.line->station_mm.push_back(round ? nodes.line->length_mm : nodes.line->station_mm[k]);
                own.line->p.push_back(nodes.line->p[k]);
            }
        }
        if (own.line) {
            const double from = own.line->station_mm.front();
            for (double& station : own.line->station_mm) {
                station -= from;
            }
            own.line->length_mm = own.line->station_mm.back();
        }
    }
    return result;
}

SeamModel join_pieces(const Seam& seam, std::vector<SeamModel> pieces) {
    for (std::size_t k = 0; k + (seam.closed ? 0 : 1) < pieces.size(); ++k) {
        meet(pieces[k].curve, pieces[(k + 1) % pieces.size()].curve);
    }
    SeamModel model;
    model.kind = seam.kind;
    model.closed = seam.closed;
    model.model = pieces.front().model;
    std::vector<CubicBSpline> curves;
    double squares = 0, points = 0;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        SeamModel& piece = pieces[k];
        const double length = ArcLength(piece.curve).length(), scale = length / piece.length_mm;
        if (k > 0 || seam.closed) {
            model.corners_mm.push_back(model.length_mm);
        }
        for (FlankSample& flank : piece.flanks) {
            flank.station_mm = model.length_mm + scale * flank.station_mm;
        }
        piece.flanks.front().station_mm = model.length_mm;
        piece.flanks.back().station_mm = model.length_mm + length;
        for (BandSample& sample : piece.band) {
            sample.station_mm = model.length_mm + scale * sample.station_mm;
        }
        std::move(piece.flanks.begin(), piece.flanks.end(), std::back_inserter(model.flanks));
        std::move(piece.band.begin(), piece.band.end(), std::back_inserter(model.band));
        const auto count = static_cast<double>(piece.flanks.size());
        squares += count * piece.residual_rms_mm * piece.residual_rms_mm;
        points += count;
        model.residual_max_mm = std::max(model.residual_max_mm, piece.residual_max_mm);
        model.degrees_of_freedom += piece.degrees_of_freedom;
        model.length_mm += length;
        curves.push_back(std::move(piece.curve));
    }
    model.residual_rms_mm = std::sqrt(squares / points);
    model.curve = joined(curves, seam.closed);
    // To rounding the same, and what else counts by.
    const double length = ArcLength(model.curve).length();
    ensure(std::abs(length - model.length_mm) <= 1e-9 * length, "the whole is as long as its pieces");
    model.length_mm = length;
    model.flanks.back().station_mm = length;
    return model;
}

}  // namespace seampath
