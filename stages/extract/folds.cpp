#include "stages/extract/folds.hpp"

#include <algorithm>
#include <numbers>

#include "stages/extract/join.hpp"
#include "stages/extract/measure.hpp"
#include "stages/extract/registration.hpp"
#include "stages/extract/rims.hpp"
#include "stages/extract/track.hpp"
#include "stages/extract/whole.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath::detail {
namespace {

constexpr double kLeastFold = 10;  // of a seam, in point distances

// The creases that may be joints, heaviest first. A convex one is turned inside out: seen from within the material it
// is concave, and all that follows holds for it.
std::vector<Crease> seeds_of(const std::vector<Crease>& creases, bool convex) {
    std::vector<Crease> seeds;
    for (Crease crease : creases) {
        if (crease.concave == convex) {
            continue;
        }
        if (convex) {
            crease.n1 = -crease.n1;
            crease.n2 = -crease.n2;
        }
        seeds.push_back(crease);
    }
    std::stable_sort(seeds.begin(), seeds.end(), [](const Crease& a, const Crease& b) { return a.weight > b.weight; });
    return seeds;
}

std::vector<Track> follow_all(const Tracker& tracker, const std::vector<Crease>& seeds,
                              const std::vector<Track>& taken) {
    std::vector<Track> tracks = taken;
    std::vector<char> used(seeds.size(), 0);
    const auto use = [&](const Track& track, std::size_t from) {
        for (std::size_t j = from; j < seeds.size(); ++j) {
            used[j] = used[j] || lies_on(track, {seeds[j].p, seeds[j].n1, seeds[j].n2}, 2 * tracker.step);
        }
    };
    for (const Track& track : taken) {
        use(track, 0);
    }
    for (std::size_t i = 0; i < seeds.size(); ++i) {
        if (used[i]) {
            continue;
        }
        auto track = follow(tracker, seeds[i], tracks);
        if (!track) {
            continue;
        }
        // Seeds along the new track have nothing more to tell.
        use(*track, i + 1);
        tracks.push_back(std::move(*track));
    }
    tracks.erase(tracks.begin(), tracks.begin() + static_cast<std::ptrdiff_t>(taken.size()));
    return tracks;
}

// A pipe on another pipe; or a pipe that the seam goes all round, on a plate, cone or sphere. The explanation of both
// flanks by one surface each is what makes it a saddle and no mere fillet.
bool is_saddle(const SeamSurfaces& surfaces, bool closed) {
    const auto& [first, second, between] = surfaces;
    if (!first || !second || !first->explains || !second->explains) {
        return false;
    }
    const bool one = first->shape == SurfaceShape::cylinder, other = second->shape == SurfaceShape::cylinder;
    return (one && other) || ((one || other) && closed);
}

Seam seam_of(const Fold& fold, const Eigen::Vector3d& origin) {
    Seam seam;
    seam.kind = fold.convex ? JointKind::corner : JointKind::fillet;
    seam.closed = fold.closed;
    if (!fold.convex) {  // those of a corner have their material on the wrong side
        seam.surfaces = fold.surfaces;
        seam.kind = is_saddle(fold.surfaces, fold.closed) ? JointKind::saddle : JointKind::fillet;
    }
    for (auto* surface : {&seam.surfaces.first, &seam.surfaces.second}) {
        if (*surface) {
            (*surface)->point += origin;
            (*surface)->origin += origin;
        }
    }
    const double outwards = fold.convex ? -1 : 1;
    std::vector<double> bends;
    for (const TrackPoint& point : fold.way) {
        const Section& at = point.section;
        seam.points.push_back({origin + at.p, outwards * at.n1, outwards * at.n2, point.sigma, point.modelled});
        bends.push_back(point.bend);
    }
    const double bend = quantile(bends, 0.5);
    // Half a radian between the flanks and nobody doubts that they are two.
    seam.confidence = std::min(1.0, bend / 0.5);
    seam.kind_reason = std::string("two surfaces meet ") + (fold.convex ? "around the material" : "around the air") +
                       " at " + fixed(180 - bend * 180 / std::numbers::pi, 0) + " deg" +
                       (seam.kind == JointKind::saddle ? ", one of them a pipe" : "");
    return seam;
}

void tell_left_out(std::string_view one, std::string_view many, const std::vector<double>& lengths,
                   const std::string& why, std::vector<std::string>& remarks) {
    if (!lengths.empty()) {
        const std::string longest = fixed(*std::max_element(lengths.begin(), lengths.end()), 1) + " mm ";
        remarks.push_back((lengths.size() == 1 ? std::string(one) + " of " + longest + "was"
                                               : std::to_string(lengths.size()) + " " + std::string(many) +
                                                     " of up to " + longest + "were") +
                          " left out: " + why);
    }
}

}  // namespace

std::vector<Fold> measure_all(const Tracker& tracker, const std::vector<Track>& tracks, double min_length_mm,
                              std::vector<std::string>& remarks) {
    std::vector<Fold> joints;
    std::vector<double> narrow, too_short;
    double longest_asked = 0;
    for (const Track& track : tracks) {
        const double spacing = tracker.scale_at(track.points[track.points.size() / 2].section).spacing;
        const double least = min_length_mm > 0 ? min_length_mm : kLeastFold * spacing;
        double found = length_of(track.points);
        if (found >= least) {
            auto way = measure_track(tracker, track);
            if (!way) {
                narrow.push_back(found);
                continue;
            }
            found = length_of(*way);
            if (found >= least) {
                joints.push_back({std::move(*way), track.closed});
                continue;
            }
        }
        too_short.push_back(found);
        longest_asked = std::max(longest_asked, least);
    }
    tell_left_out("a crease", "creases", narrow, "flanks too narrow or too rough for a joint", remarks);
    tell_left_out("a joint", "joints", too_short, "shorter than " + fixed(longest_asked, 1) + " mm", remarks);
    return joints;
}

Folds find_folds(const Around& around, bool concave, bool convex, const ExtractOptions& options,
                 const std::vector<Track>& taken) {
    const Tracker& following = around.following;
    Folds result;
    std::vector<Fold> folds;
    for (const bool inside_out : {false, true}) {
        if (inside_out ? !convex : !concave) {
            continue;
        }
        const auto tracks = join_tracks(following, follow_all(following, seeds_of(around.creases, inside_out), taken));
        std::vector<Fold> joints = measure_all(following, tracks, options.min_length_mm, result.remarks);
        if (inside_out) {
            leave_out_rims(around, options.max_thickness_mm, joints, result.remarks);
        }
        for (Fold& fold : joints) {
            fold.convex = inside_out;
            folds.push_back(std::move(fold));
        }
    }
    // Where the joints lie, by all that their flanks tell.
    Tracker measuring = following;
    measuring.window_of = measuring_window;
    ViewDifferences differences;
    std::vector<MeasuredWay> ways;
    for (Fold& fold : folds) {
        add_differences(differences, fold.way);
        ways.push_back({measuring, &fold.way});
    }
    result.registration_mm = registration_of(differences);
    std::vector<SeamSurfaces> surfaces = settle_on_whole_flanks(
        ways,
        registration_that_counts(result.registration_mm, following.view_starts.size(), around.field.overall.noise));
    for (std::size_t i = 0; i < folds.size(); ++i) {
        folds[i].surfaces = std::move(surfaces[i]);
        result.seams.push_back(seam_of(folds[i], around.scan.origin_mm));
    }
    return result;
}

}  // namespace seampath::detail
