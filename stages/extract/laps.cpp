#include "stages/extract/laps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "stages/extract/folds.hpp"
#include "stages/extract/join.hpp"
#include "stages/extract/jumps.hpp"
#include "stages/extract/registration.hpp"
#include "stages/extract/whole.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/step_height.hpp"
#include "stages/text.hpp"

namespace seampath::detail {
namespace {

constexpr double kMostThickness = 30;  // mm; what is thicker is no plate that anyone laps
constexpr double kEdgeReach = 3;       // mm from the upper plate's edge to where the lower plate is seen at the latest
constexpr double kLeastLapWidth = 3;   // of the upper plate, in its thicknesses
constexpr double kSameThickness = 0.15;

// Tracks of one upper plate: its thickness is that of the first.
struct Plate {
    double thickness = 0;
    std::vector<Track> tracks;
};

bool same_thickness(const Plate& plate, double thickness) {
    return std::abs(plate.thickness - thickness) < kSameThickness * plate.thickness;
}

// Whether the sheet goes on from its border for `width` mm along `inwards`, holes aside.
bool goes_on(const Around& around, const Border& border, const Eigen::Vector3d& inwards, double width) {
    const ScanScale scale = around.field.at(border.p);
    const double step = std::max(3 * scale.spacing, width / 40), radius = 2.5 * scale.spacing;
    int places = 0, seen = 0;
    double last = 0;
    for (double x = step; x < width; x += step, ++places) {
        const Eigen::Vector3d p = border.p + x * inwards;
        int points = 0;
        around.grid.for_points_in_ball(p, radius + 0.02 * x + 3 * scale.noise, [&](const Eigen::Vector3f& q, double) {
            points += std::abs((q.cast<double>() - p).dot(border.n)) < 3 * scale.noise + 0.02 * x;
        });
        seen += points > 2;
        last = points > 2 ? x : last;
    }
    return 5 * seen >= 4 * places && last > 0.95 * width - step;
}

// Straight inwards and slanted to both sides: at the corner of a box only its diagonal is long.
bool is_wide(const Around& around, const Border& border, double width) {
    constexpr double kSlant = 40 * std::numbers::pi / 180;
    const Eigen::Vector3d along = border.n.cross(border.out);
    return std::ranges::all_of(std::array{0.0, kSlant, -kSlant}, [&](double slant) {
        return goes_on(around, border, std::sin(slant) * along - std::cos(slant) * border.out, width);
    });
}

// Whether right below a border the side face of its sheet is seen.
bool shows_side(const Around& around, const Border& border) {
    constexpr double kLeastDensity = 0.1;  // of the sheet's
    const ScanScale scale = around.field.at(border.p);
    const Eigen::Vector3d along = border.n.cross(border.out);
    const double half = 0.5 * around.surfels.radius, low = 5 * scale.noise, high = low + 10 * scale.spacing;
    double points = 0;
    around.grid.for_points_in_ball(border.p, std::hypot(half, high), [&](const Eigen::Vector3f& q, double) {
        const Eigen::Vector3d v = q.cast<double>() - border.p;
        const double depth = -v.dot(border.n);
        points += depth > low && depth < high && std::abs(v.dot(along)) < half &&
                  std::abs(v.dot(border.out)) < 3 * scale.spacing;
    });
    return points > kLeastDensity * border.density * 2 * half * (high - low);
}

// Whether the surface on which a plate lies is a part: it ends somewhere in the scan, and its side is seen.
bool is_part(const Around& around, const std::vector<Border>& borders, const Eigen::Vector3d& foot,
             const Eigen::Vector3d& n) {
    return std::any_of(borders.begin(), borders.end(), [&](const Border& border) {
        const Eigen::Vector3d v = border.p - foot;
        return border.n.dot(n) > 0.98 && std::abs(v.dot(n)) < 4 * around.field.at(border.p).noise + 0.01 * v.norm() &&
               shows_side(around, border);
    });
}

struct Seed {
    Crease foot;
    double thickness = 0;
};

// Of an edge from `least` to `most` mm high.
std::optional<Seed> seed_of(const Around& around, const Border& border, const LapsAsked& asked, double least,
                            double most) {
    const auto below = sheet_beyond(around, border, kEdgeReach, -most, -least);
    if (!below || (!asked.by_any_step && !is_wide(around, border, kLeastLapWidth * -below->height))) {
        return std::nullopt;
    }
    Seed seed;
    seed.thickness = -below->height;
    seed.foot.p = border.p + below->height * border.n;
    seed.foot.n1 = border.n;
    seed.foot.n2 = border.out;
    seed.foot.t = seed.foot.n1.cross(seed.foot.n2);
    return seed;
}

// How thick the upper plate is, by what lies behind its edge all along the track.
double thickness_along(const Around& around, const Track& track, double guess) {
    std::vector<double> heights;
    const std::size_t stride = 1 + track.points.size() / 25;
    for (std::size_t i = 0; i < track.points.size(); i += stride) {
        const Section& at = track.points[i].section;
        if (const auto height = step_height(around.grid, around.field.at(at.p), at.p, at.n1, at.n2)) {
            heights.push_back(*height);
        }
    }
    return heights.empty() ? guess : quantile(heights, 0.5);
}

// Edges of which nothing but the two tops is seen: nobody can tell where their foot is.
void tell_of_unseen_sides(const Around& around, const std::vector<Border>& borders, const LapsAsked& asked,
                          const std::vector<Plate>& plates, std::vector<Seed> unseen, Laps& result) {
    constexpr std::size_t kChance = 10;  // pieces of border
    if (unseen.size() < kChance) {
        return;
    }
    const auto middle = unseen.begin() + static_cast<std::ptrdiff_t>(unseen.size() / 2);
    std::nth_element(unseen.begin(), middle, unseen.end(),
                     [](const Seed& a, const Seed& b) { return a.thickness < b.thickness; });
    const bool measured = std::any_of(plates.begin(), plates.end(),
                                      [&](const Plate& plate) { return same_thickness(plate, middle->thickness); });
    if (!measured && (asked.by_any_step || is_part(around, borders, middle->foot.p, middle->foot.n1))) {
        result.remarks.push_back("a plate " + fixed(middle->thickness, 1) +
                                 " mm thick lies on another one, but hardly anything is seen of its side: no lap was "
                                 "measured there; scan it from that side, too");
    }
}

// Sheets may be as thin as what is machined.
void tell_of_low_steps(std::vector<double> heights, const LapsAsked& asked, Laps& result) {
    constexpr std::size_t kLine = 20;  // pieces of border
    if (heights.size() >= kLine) {
        result.remarks.push_back("a step " + fixed(quantile(heights, 0.5), 2) +
                                 " mm high was taken for machined, not for a lap: " + "extract.max_step_mm is " +
                                 fixed(asked.max_step_mm, 2) + " mm; set it lower if that is a sheet");
    }
}

// The upper plates; edges that lie on a table become tracks of the result, and remarks.
std::vector<Plate> follow_all(const Around& around, const std::vector<Border>& borders, const LapsAsked& asked,
                              Laps& result) {
    std::vector<Plate> plates;
    std::vector<Track> taken, &tables = result.tracks;
    std::vector<Seed> unseen;
    std::vector<double> low;
    for (const Border& border : borders) {
        const double noise = around.field.at(border.p).noise;
        const auto seed =
            seed_of(around, border, asked, asked.by_any_step ? 3 * noise : asked.max_step_mm, kMostThickness);
        const auto known = [&](const std::vector<Track>& tracks) {
            return std::any_of(tracks.begin(), tracks.end(), [&](const Track& track) {
                return lies_on(track, {seed->foot.p, seed->foot.n1, seed->foot.n2}, 4 * around.following.step);
            });
        };
        const double least_seen = 5 * noise;
        if (!seed && !asked.by_any_step && least_seen < asked.max_step_mm) {
            const auto machined = seed_of(around, border, asked, least_seen, asked.max_step_mm);
            if (machined) {
                low.push_back(machined->thickness);
            }
        }
        if (!seed || known(taken) || known(tables)) {
            continue;
        }
        Tracker tracker = around.following;
        tracker.wall = seed->thickness;
        auto track = follow(tracker, seed->foot, taken);
        if (!track || track->points.size() < 6) {
            unseen.push_back(*seed);
            continue;
        }
        if (!asked.by_any_step && !is_part(around, borders, seed->foot.p, seed->foot.n1)) {
            result.remarks.push_back(
                "the edge of a plate " + fixed(seed->thickness, 1) +
                " mm thick was left out: the surface below shows no side of its own, as a table does; "
                "set extract.joint to lap if it is a part");
            tables.push_back(std::move(*track));
            continue;
        }
        taken.push_back(*track);
        const double thickness = thickness_along(around, *track, seed->thickness);
        auto plate =
            std::find_if(plates.begin(), plates.end(), [&](const Plate& p) { return same_thickness(p, thickness); });
        if (plate == plates.end()) {
            plates.push_back({thickness, {}});
            plate = plates.end() - 1;
        }
        plate->tracks.push_back(std::move(*track));
    }
    tell_of_unseen_sides(around, borders, asked, plates, std::move(unseen), result);
    tell_of_low_steps(std::move(low), asked, result);
    return plates;
}

/// The wall's points about a place, as far as its window reached.
struct WallPoints {
    double middle = 0;  // mm from the foot
    double count = 0;
};
WallPoints wall_about(const std::vector<TrackPoint>& way, std::size_t i, double step) {
    const auto about = static_cast<std::size_t>(std::lround(way[i].along / step));
    WallPoints wall;
    double sum = 0;
    for (std::size_t j = i > about ? i - about : 0; j < std::min(way.size(), i + about + 1); ++j) {
        for (const SlabPoint& sample : way[j].slab[1]) {
            sum += sample.u;
            wall.count += 1;
        }
    }
    wall.middle = wall.count > 0 ? sum / wall.count : 0;
    return wall;
}

// An edge is cut at one angle: that of all places is surer than each window's own, which a low wall tells badly and
// which is carried down to the foot. A window knows where the middle of its points is; the wall is turned about it.
void share_angle(const Tracker& tracker, std::vector<TrackPoint>& way) {
    constexpr double kMostTwist = 8 * std::numbers::pi / 180;  // 1-sigma of the angles of what is cut at one angle
    constexpr double kBent = 2.25;  // variance of a quadratic at its middle, over that of a mean
    std::vector<double> bends, off;
    for (const TrackPoint& place : way) {
        if (!place.modelled) {
            bends.push_back(place.bend);
        }
    }
    const double bend = quantile(bends, 0.5);
    for (const double b : bends) {
        off.push_back(std::abs(b - bend));
    }
    const double twist = 1.4826 * quantile(off, 0.5);
    if (twist > kMostTwist) {
        return;
    }
    for (std::size_t i = 0; i < way.size(); ++i) {
        TrackPoint& place = way[i];
        const WallPoints wall = wall_about(way, i, tracker.step);
        if (place.modelled || wall.count == 0) {
            continue;
        }
        const Eigen::Vector3d out = place.t.cross(place.section.n1);
        place.section.p += wall.middle * (std::cos(bend) - std::cos(place.bend)) * out;
        place.section.n2 = std::sin(bend) * out + std::cos(bend) * place.section.n1;
        place.bend = bend;
        const double windows = std::max(1.0, static_cast<double>(way.size()) * tracker.step / (2 * place.along));
        const double of_mean = kBent * tracker.scale_at(place.section).correlation * std::pow(place.flank_scale[1], 2) /
                               wall.count,
                     of_angle = std::pow(twist * wall.middle, 2) / windows;
        place.flank_sigma[1] = std::min(place.flank_sigma[1], std::sqrt(of_mean + of_angle));
        place.sigma = std::hypot(place.flank_sigma[0], place.flank_sigma[1]) / std::max(1e-6, std::sin(bend));
    }
}

struct Lap {
    Fold measured;
    double thickness = 0;
};

Seam seam_of(const Lap& lap, const Eigen::Vector3d& origin, const LapsAsked& asked) {
    Seam seam;
    seam.kind = JointKind::lap;
    seam.closed = lap.measured.closed;
    std::vector<double> bends;
    for (const TrackPoint& point : lap.measured.way) {
        const Section& at = point.section;
        seam.points.push_back({origin + at.p, at.n1, at.n2, point.sigma, point.modelled});
        bends.push_back(point.bend);
    }
    const double bend = quantile(bends, 0.5);
    // Twice as high as a machined step may be, and nobody takes it for one.
    const double higher = asked.max_step_mm > 0 ? lap.thickness / asked.max_step_mm - 1 : 1;
    seam.confidence = std::min(1.0, bend / 0.5) * std::clamp(0.5 + 0.5 * higher, 0.0, 1.0);
    seam.kind_reason = "an edge " + fixed(lap.thickness, 1) + " mm high ends a plate" +
                       (asked.by_any_step ? "" : " at least three times as wide") +
                       " and meets the parallel one below at " + fixed(180 - bend * 180 / std::numbers::pi, 0) + " deg";
    return seam;
}

}  // namespace

Laps find_laps(const Around& around, const std::vector<Border>& borders, const LapsAsked& asked) {
    Laps result;
    std::vector<Lap> laps;
    for (Plate& plate : follow_all(around, borders, asked, result)) {
        Tracker tracker = around.following;
        tracker.wall = plate.thickness;
        std::vector<Track> tracks = join_tracks(tracker, std::move(plate.tracks));
        result.tracks.insert(result.tracks.end(), tracks.begin(), tracks.end());
        for (Fold& measured : measure_all(tracker, tracks, asked.min_length_mm, result.remarks)) {
            laps.push_back({std::move(measured), plate.thickness});
        }
    }
    ViewDifferences differences;
    for (const Lap& lap : laps) {
        add_differences(differences, lap.measured.way);
    }
    result.registration_mm = registration_of(differences);
    std::vector<MeasuredWay> ways;
    for (Lap& lap : laps) {
        Tracker measuring = around.following;
        measuring.window_of = measuring_window;
        measuring.wall = lap.thickness;
        share_angle(measuring, lap.measured.way);
        lap.measured.way = without_jumps(std::move(lap.measured.way), lap.measured.closed);
        ways.push_back({measuring, &lap.measured.way});
    }
    settle_on_whole_flanks(ways, registration_that_counts(result.registration_mm, around.following.view_starts.size(),
                                                          around.field.overall.noise));
    for (const Lap& lap : laps) {
        result.seams.push_back(seam_of(lap, around.scan.origin_mm, asked));
    }
    return result;
}

}  // namespace seampath::detail
