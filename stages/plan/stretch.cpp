#include "stages/plan/stretch.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/curve_part.hpp"
#include "stages/plan/text.hpp"

namespace seampath::planning {
namespace {

SeamModel turned_round(SeamModel model) {
    model.curve = reversed(model.curve);
    std::reverse(model.flanks.begin(), model.flanks.end());
    for (FlankSample& flank : model.flanks) {
        std::swap(flank.n1, flank.n2);
        flank.station_mm = model.length_mm - flank.station_mm;
    }
    std::reverse(model.corners_mm.begin(), model.corners_mm.end());
    for (double& corner : model.corners_mm) {
        corner = model.length_mm - corner;
    }
    if (model.closed && !model.corners_mm.empty()) {  // the last is the first, where samples stand for either side
        model.corners_mm.pop_back();
        model.corners_mm.insert(model.corners_mm.begin(), 0);
        return model;
    }
    // The sample at a closed seam's start would stand at its end.
    if (model.closed && model.flanks.back().station_mm >= model.length_mm) {
        model.flanks.back().station_mm = 0;
        std::rotate(model.flanks.rbegin(), model.flanks.rbegin() + 1, model.flanks.rend());
    }
    return model;
}

// From station to station of a seam, which a closed one may be gone round between, with straight pieces before and
// behind.
SeamModel between(const SeamModel& model, double from, double to, double before = 0, double behind = 0) {
    const ArcLength arc(model.curve);
    const double period = last_parameter(model.curve) - first_parameter(model.curve);
    const auto parameter = [&](double station) {
        const double rounds = model.closed ? std::floor(station / arc.length()) : 0;
        const double rest = station - rounds * arc.length();
        const bool is_end = !model.closed && rest >= arc.length();
        return (is_end ? last_parameter(model.curve) : arc.parameter(rest)) + rounds * period;
    };
    SeamModel part = model;
    part.closed = false;
    part.curve = part_of(model.curve, parameter(from), parameter(to), before, behind);
    part.length_mm = ArcLength(part.curve).length();
    part.flanks.clear();
    part.corners_mm.clear();
    const auto add = [&](double station, double at) {
        part.flanks.push_back(flanks_at(model, station));
        part.flanks.back().station_mm = at;
    };
    add(from, before);
    const double rounds = model.closed ? std::floor(to / arc.length()) : 0;
    for (double round = 0; round <= rounds; ++round) {
        for (const FlankSample& flank : model.flanks) {
            const double station = flank.station_mm + round * arc.length();
            if (station > from && station < to) {
                part.flanks.push_back(flank);
                part.flanks.back().station_mm = before + station - from;
            }
        }
        for (const double corner : model.corners_mm) {
            const double station = corner + round * arc.length();
            if (station > from && station < to) {
                part.corners_mm.push_back(before + station - from);
            }
        }
    }
    add(to, before + to - from);
    return part;
}

// Where a closed seam's weld begins when nothing else was asked for: not in a corner, but where it is furthest from
// one.
double usual_start(const SeamModel& way) {
    double start = 0, longest = 0;
    for (std::size_t k = 0; k < way.corners_mm.size(); ++k) {
        const double from = way.corners_mm[k];
        const double to = k + 1 < way.corners_mm.size() ? way.corners_mm[k + 1] : way.length_mm;
        if (to - from > longest) {
            longest = to - from;
            start = 0.5 * (from + to);
        }
    }
    return start;
}

[[noreturn]] void refuse(int seam, const std::string& what) {
    throw InputError(seam_text(seam) + what);
}

// Pieces of a length, and their pitch.
struct Row {
    int count;
    double length, pitch, first;
};

Row row_of(const SeamModel& way, int seam, const PlanOptions& o) {
    const bool stitch = o.pattern == WeldPattern::stitch;
    const double length = stitch ? o.stitch_length_mm : o.tack_length_mm, all = way.length_mm;
    const double gap = o.stitch_gap_mm;
    const int most = stitch ? static_cast<int>(std::lround((way.closed ? all : all + gap) / (length + gap))) : o.tacks;
    const int count = std::max(1, most), gaps = way.closed ? count : count - 1;
    if (!(count * length < all)) {
        refuse(seam, " is " + number(all) + " mm long; " + std::to_string(count) +
                         (stitch ? " stitches of plan.stitch_length_mm = " : " tacks of plan.tack_length_mm = ") +
                         number(length) + " mm with gaps between them need more; shorter or fewer ones are needed");
    }
    const double pitch = gaps > 0 ? length + (all - count * length) / gaps : 0;
    return {count, length, pitch, count == 1 && !way.closed ? 0.5 * (all - length) : 0};
}

}  // namespace

SeamModel whole_way(const SeamModel& model, int seam, const PlanOptions& o) {
    const SeamModel way = o.backwards ? turned_round(model) : model;
    const double length = way.length_mm;
    if (way.closed) {
        if (o.start_station_mm >= length || o.overlap_mm >= length) {
            refuse(seam, " is closed and " + number(length) +
                             " mm long; plan.start_station_mm = " + number(o.start_station_mm) +
                             " and plan.overlap_mm = " + number(o.overlap_mm) + " must be less than that");
        }
        const double asked = o.backwards && o.start_station_mm > 0 ? length - o.start_station_mm : o.start_station_mm;
        const double start = asked > 0 ? asked : usual_start(way);
        return start == 0 && o.overlap_mm == 0 ? way : between(way, start, start + length + o.overlap_mm);
    }
    const double from = std::max(0.0, -o.extend_start_mm), to = length - std::max(0.0, -o.extend_end_mm);
    if (!(to > from)) {
        refuse(seam, " is " + number(length) +
                         " mm long; nothing is left of it with plan.extend_start_mm = " + number(o.extend_start_mm) +
                         " and plan.extend_end_mm = " + number(o.extend_end_mm) + "; trim it by less");
    }
    const bool as_it_is = o.extend_start_mm == 0 && o.extend_end_mm == 0;
    return as_it_is ? way : between(way, from, to, std::max(0.0, o.extend_start_mm), std::max(0.0, o.extend_end_mm));
}

std::vector<Stretch> stretches(const SeamModel& way, int seam, const PlanOptions& o) {
    if (o.pattern == WeldPattern::whole) {
        return {{way, 0}};
    }
    const Row row = row_of(way, seam, o);
    std::vector<Stretch> parts;
    for (int k = 0; k < row.count; ++k) {
        const double from = row.first + k * row.pitch;
        parts.push_back({between(way, from, std::min(from + row.length, way.closed ? 1e300 : way.length_mm)), from});
    }
    return parts;
}

}  // namespace seampath::planning
