#include "stages/extract/extract.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "stages/error.hpp"
#include "stages/extract/creases.hpp"
#include "stages/extract/join.hpp"
#include "stages/extract/measure.hpp"
#include "stages/extract/registration.hpp"
#include "stages/extract/surfels.hpp"
#include "stages/extract/track.hpp"
#include "stages/extract/whole.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/views.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using namespace detail;

constexpr std::size_t kLeastPoints = 200;
constexpr double kLeastLength = 10;  // of a seam, in point distances

// As fine as the points allow, so that narrow faces are seen; coarser where a large scan would make too many cells.
double cell_size(const ScanScale& scale, std::size_t points) {
    constexpr double kCells = 60000;
    return std::max(std::clamp(std::sqrt(static_cast<double>(points) / kCells), 2.5, 4.0) * scale.spacing,
                    2 * scale.noise);
}

// Concave creases, heaviest first. Where nothing told the air from the material of a piece, its joints do: a scan made
// to find a seam shows more of concave joints than of convex edges.
std::vector<Crease> seeds_of(std::vector<Crease> creases) {
    std::map<std::uint32_t, double> balance;
    for (const Crease& c : creases) {
        balance[c.piece] += c.concave ? c.weight : -c.weight;
    }
    for (Crease& c : creases) {
        if (!c.decided && balance[c.piece] < 0) {
            c.concave = !c.concave;
            c.n1 = -c.n1;
            c.n2 = -c.n2;
        }
    }
    std::erase_if(creases, [](const Crease& c) { return !c.concave; });
    std::stable_sort(creases.begin(), creases.end(),
                     [](const Crease& a, const Crease& b) { return a.weight > b.weight; });
    return creases;
}

std::vector<Track> follow_all(const Tracker& tracker, const std::vector<Crease>& seeds) {
    std::vector<Track> tracks;
    std::vector<char> used(seeds.size(), 0);
    for (std::size_t i = 0; i < seeds.size(); ++i) {
        if (used[i]) {
            continue;
        }
        auto track = follow(tracker, seeds[i], tracks);
        if (!track) {
            continue;
        }
        // Seeds along the new track have nothing more to tell.
        for (std::size_t j = i + 1; j < seeds.size(); ++j) {
            used[j] = used[j] || lies_on(*track, {seeds[j].p, seeds[j].n1, seeds[j].n2}, 2 * tracker.step);
        }
        tracks.push_back(std::move(*track));
    }
    return tracks;
}

template <class Points, class Position>
double length_of(const Points& points, Position&& position) {
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
        length += (position(points[i]) - position(points[i - 1])).norm();
    }
    return length;
}

// A track that turned out to be a joint.
struct Measured {
    std::vector<TrackPoint> way;
    bool closed = false;
};

// The joints among the tracks; of the others a remark says why they are none.
std::vector<Measured> measure_all(const Tracker& tracker, const std::vector<Track>& tracks, double min_length,
                                  std::vector<std::string>& remarks) {
    const auto length = [](const std::vector<TrackPoint>& way) {
        return length_of(way, [](const TrackPoint& p) { return p.section.p; });
    };
    std::vector<Measured> joints;
    for (const Track& track : tracks) {
        const double spacing = tracker.scale_at(track.points[track.points.size() / 2].section).spacing;
        const double least = min_length > 0 ? min_length : kLeastLength * spacing;
        double found = length(track.points);
        if (found >= least) {
            auto way = measure_track(tracker, track);
            if (!way) {
                remarks.push_back("a crease of " + fixed(found, 1) +
                                  " mm was left out: its flanks are too narrow or too rough for a joint");
                continue;
            }
            found = length(*way);
            if (found >= least) {
                joints.push_back({std::move(*way), track.closed});
                continue;
            }
        }
        remarks.push_back("a joint of " + fixed(found, 1) + " mm was left out: shorter than " + fixed(least, 1) +
                          " mm");
    }
    return joints;
}

Seam seam_of(const Measured& joint, const Eigen::Vector3d& origin) {
    Seam seam;
    seam.closed = joint.closed;
    double bend = 0;
    for (const TrackPoint& point : joint.way) {
        seam.points.push_back(
            {origin + point.section.p, point.section.n1, point.section.n2, point.sigma, point.modelled});
        bend += point.bend;
    }
    // Half a radian between the flanks and nobody doubts that they are two.
    seam.confidence = std::min(1.0, bend / static_cast<double>(joint.way.size()) / 0.5);
    return seam;
}

// Where the joints lie, by all that their flanks tell, longest first.
void settle_all(Extraction& result, const Tracker& following, std::vector<Measured> joints,
                const Eigen::Vector3d& origin) {
    Tracker tracker = following;
    tracker.window_of = measuring_window;
    ViewDifferences differences;
    for (const Measured& joint : joints) {
        add_differences(differences, joint.way);
    }
    result.registration_mm = registration_of(differences);
    // Few views tell their scatter but roughly: 68 % of Student's t with f degrees of freedom lie within 1 + 0.6 / f,
    // and two flanks see each view in two directions.
    const double freedom = 2.0 * std::max(1, result.views - 1),
                 registration = result.registration_mm * (1 + 0.6 / freedom);
    for (Measured& joint : joints) {
        settle_on_whole_flanks(tracker, registration, joint.way);
        result.seams.push_back(seam_of(joint, origin));
    }
    std::stable_sort(result.seams.begin(), result.seams.end(),
                     [](const Seam& a, const Seam& b) { return a.points.size() > b.points.size(); });
}

}  // namespace

Fields describe(ExtractOptions& o) {
    return {
        {"joint", choice(o.joint, kJointChoiceNames), "joint kind to look for"},
        {"min_length_mm", &o.min_length_mm, "shortest seam that is reported; 0 takes it from the scan", at_least(0)},
        {"station_mm", &o.station_mm, "distance of the extracted points; 0 takes it from the scan", at_least(0)}};
}

Extraction extract(const Scan& scan, const ExtractOptions& options) {
    if (options.joint != JointChoice::automatic && options.joint != JointChoice::fillet) {
        throw InputError("extract: joint kind '" +
                         std::string(kJointChoiceNames[static_cast<std::size_t>(options.joint)]) +
                         "' is not followed yet; fillet is; set extract.joint to auto or fillet");
    }
    if (scan.points.size() < kLeastPoints) {
        throw InputError("extract: the scan has " + std::to_string(scan.points.size()) + " points; at least " +
                         std::to_string(kLeastPoints) +
                         " are needed to fit two surfaces; scan the part with a finer pitch");
    }
    Extraction result;
    const ScaleField field = estimate_scale(scan.points);
    const ScanScale& scale = field.overall;
    result.spacing_mm = scale.spacing;
    result.noise_mm = scale.noise;
    if (scale.spacing <= 0) {
        throw InputError("extract: all points lie in one place; a part with surfaces was needed; check the file");
    }
    const PointGrid grid(scan.points, cell_size(scale, scan.points.size()), without_strays(scan.points));
    Surfels surfels = make_surfels(grid, 4.5 * grid.cell());
    orient(surfels, grid, scan);
    result.orientation_reason = surfels.orientation_reason;
    const std::vector<Crease> seeds = seeds_of(find_creases(surfels, field));

    // An organised cloud is one view.
    const std::vector<std::size_t> views = scan.pixel.empty() ? view_starts(scan.points) : std::vector<std::size_t>{0};
    result.views = static_cast<int>(views.size());
    const Tracker tracker{grid, field, views, following_window,
                          options.station_mm > 0 ? options.station_mm : grid.cell()};
    const std::vector<Track> tracks = join_tracks(tracker, follow_all(tracker, seeds));
    settle_all(result, tracker, measure_all(tracker, tracks, options.min_length_mm, result.remarks), scan.origin_mm);
    return result;
}

}  // namespace seampath
