#include "pipeline/compare_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "stages/geometry/bspline.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr int kPlacesOfPair = 400;
constexpr double kSamePlaceShare = 0.1;  // of the shorter seam's length: farther apart two curves are not one seam

/// Whether q is the foot of p on the curve rather than an end that p lies beyond.
bool is_foot(const Eigen::Vector3d& off, const Eigen::Vector3d& along, double length_mm) {
    return std::abs(off.dot(along)) <= 1e-6 * length_mm;
}

/// Even stations along A that run beside B.
std::vector<PairPlace> places_of(const SeamModel& a, const SeamModel& b) {
    const ArcLength arc_a(a.curve), arc_b(b.curve);
    std::vector<PairPlace> places;
    for (int i = 0; i < kPlacesOfPair; ++i) {
        PairPlace place;
        place.station_mm = arc_a.length() * (i + 0.5) / kPlacesOfPair;
        const double u = arc_a.parameter(place.station_mm);
        place.p = position(a.curve, u);
        const double foot = nearest_parameter(b.curve, place.p);
        place.off = position(b.curve, foot) - place.p;
        if (!is_foot(place.off, tangent(b.curve, foot), arc_b.length())) {
            continue;
        }
        place.station_b_mm = arc_b.station(foot);
        const FlankSample flanks = flanks_at(a, place.station_mm), others = flanks_at(b, place.station_b_mm);
        const Eigen::Vector3d t = tangent(a.curve, u), air = flanks.n1 + flanks.n2;
        const Eigen::Vector3d up = (air - air.dot(t) * t).normalized();
        place.up_mm = place.off.dot(up);
        place.across_mm = place.off.dot(t.cross(up));
        place.sigma_mm = std::hypot(flanks.sigma_mm, others.sigma_mm);
        places.push_back(place);
    }
    return places;
}

}  // namespace

std::vector<SeamPair> pair_seams(const ComparedRun& a, const ComparedRun& b) {
    struct Candidate {
        double apart;
        SeamPair pair;
    };
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < a.models.size(); ++i) {
        for (std::size_t k = 0; k < b.models.size(); ++k) {
            SeamPair pair{i, k, std::min(a.deviations[i].tolerance_mm, b.deviations[k].tolerance_mm),
                          places_of(a.models[i], b.models[k])};
            const double shorter = std::min(a.models[i].length_mm, b.models[k].length_mm);
            const double shared =
                static_cast<double>(pair.places.size()) / kPlacesOfPair * a.models[i].length_mm / shorter;
            std::vector<double> distance;
            for (const PairPlace& place : pair.places) {
                distance.push_back(place.off.norm());
            }
            const double apart = quantile(distance, 0.5);
            if (shared >= 0.5 && apart <= kSamePlaceShare * shorter) {
                candidates.push_back({apart, std::move(pair)});
            }
        }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& x, const Candidate& y) { return x.apart < y.apart; });
    std::vector<SeamPair> pairs;
    for (Candidate& candidate : candidates) {
        const bool taken = std::any_of(pairs.begin(), pairs.end(), [&](const SeamPair& pair) {
            return pair.a == candidate.pair.a || pair.b == candidate.pair.b;
        });
        if (!taken) {
            pairs.push_back(std::move(candidate.pair));
        }
    }
    std::sort(pairs.begin(), pairs.end(), [](const SeamPair& x, const SeamPair& y) { return x.a < y.a; });
    return pairs;
}

}  // namespace seampath
