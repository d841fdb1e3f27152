#include "stages/extract/butts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "stages/extract/ends.hpp"
#include "stages/extract/equal_steps.hpp"
#include "stages/extract/gap_way.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath::detail {
namespace {

constexpr double kRound = 40 * std::numbers::pi / 180;  // between the tops of two gaps that meet round a corner
constexpr double kLeastButt = 40;                       // of a seam, in point distances
constexpr double kLeastOverRows = 1.2;                  // width of a gap, in distances of rows beside it
constexpr double kUnseen = 0.2;  // noises by which an edge's place is doubtful beyond what its witnesses scatter

std::vector<GapStation> at_equal_steps(const GapWay& way, double step) {
    return equal_steps(
        way.at, way.closed, step, [](const GapStation& s) -> const Eigen::Vector3d& { return s.fit.place.p; },
        [](const GapStation& a, const GapStation& b, double x) {
            GapStation station = x < 0.5 ? a : b;
            station.fit.place = between(a.fit.place, b.fit.place, x);
            return station;
        });
}

// Place i with the direction and bend that the way has over `reach` mm before and behind: those of a single place are
// too unsure for a long window.
GapPlace guess_at(const std::vector<GapStation>& places, bool closed, std::size_t i, double reach, double step) {
    const auto n = static_cast<std::ptrdiff_t>(places.size());
    auto half = static_cast<std::ptrdiff_t>(std::lround(reach / step));
    const auto at = static_cast<std::ptrdiff_t>(i);
    half = std::clamp<std::ptrdiff_t>(half, 1, (n - 1) / 2);  // at least three places
    const std::ptrdiff_t middle = closed ? at : std::clamp(at, half, n - 1 - half);
    const auto place = [&](std::ptrdiff_t k) -> const GapPlace& {
        return places[static_cast<std::size_t>((k + n) % n)].fit.place;
    };
    const GapPlace& here = place(middle);
    const Eigen::Vector3d a = place(middle - half).p - here.p, b = place(middle + half).p - here.p;
    GapPlace guess = places[i].fit.place;
    guess.bend = here.n.cross(here.t).dot(a + b) / (0.5 * (a.squaredNorm() + b.squaredNorm()));
    const Eigen::Vector3d along =
        (b - a).normalized() + guess.bend * step * static_cast<double>(at - middle) * here.n.cross(here.t);
    guess.t = (along - along.dot(guess.n) * guess.n).normalized();
    return guess;
}

// The place nearest to i that is `least` places away from both ends, or as far as it can be.
std::size_t from_the_ends(std::size_t i, double least, std::size_t count) {
    const auto away = std::min(static_cast<std::size_t>(std::lround(least)), (count - 1) / 2);
    return std::clamp(i, away, count - 1 - away);
}

// Along the course that was fitted within `half` mm to each side: a line is the less sure the farther from its middle.
void slide(GapFit& fit, double s, double half) {
    const Eigen::Vector3d left = fit.place.n.cross(fit.place.t);
    fit.place.p += s * fit.place.t + 0.5 * fit.place.bend * s * s * left;
    fit.place.t = (fit.place.t + fit.place.bend * s * left).normalized();
    fit.sigma *= std::sqrt(1 + 3 * s * s / (half * half));
}

// Place i as a window around the place `from` tells it.
std::optional<GapFit> measure_from(const Around& around, const std::vector<GapStation>& places, bool closed,
                                   std::size_t i, std::size_t from, double step) {
    const ScanScale scale = around.field.at(places[from].fit.place.p);
    const GapPlace guess = guess_at(places, closed, from, measuring_window(scale).along, step);
    const SectionWindow window = within_bend(measuring_window(scale), guess.bend, scale);
    auto fit = settle_gap(viewed_points(around), scale, guess, window, 2);
    if (!fit || !is_gap(*fit, scale)) {
        return std::nullopt;
    }
    const Eigen::Vector3d& p = places[i].fit.place.p;
    if (from != i) {
        slide(*fit, (p - fit->place.p).dot(fit->place.t), window.along);
    }
    return (fit->place.p - p).norm() < 0.5 * guess.gap + scale.spacing ? fit : std::nullopt;
}

// Places that could not be measured, between those that could: a better guess than what led there.
void fill_between(std::vector<GapStation>& places, const std::vector<std::optional<GapFit>>& measured) {
    std::optional<std::size_t> before;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (!measured[i]) {
            continue;
        }
        places[i].fit = *measured[i];
        for (std::size_t k = before ? *before + 1 : i; k < i; ++k) {
            const double x = static_cast<double>(k - *before) / static_cast<double>(i - *before);
            places[k].fit.place = between(places[*before].fit.place, places[i].fit.place, x);
        }
        before = i;
    }
}

std::vector<GapStation> measure_places(const Around& around, std::vector<GapStation> places, bool closed, double step) {
    std::vector<std::optional<GapFit>> measured(places.size());
    for (int round = 0; round < 2; ++round) {
        parallel_for(places.size(), 4, [&](std::size_t i) {
            const double along = measuring_window(around.field.at(places[i].fit.place.p)).along;
            // Near an open end as seen from a little way inside: a window on the end itself would see one half only.
            const std::size_t inside = closed ? i : from_the_ends(i, 0.7 * along / step, places.size());
            for (const std::size_t from : {inside, i}) {
                if (!measured[i]) {
                    measured[i] = measure_from(around, places, closed, i, from, step);
                }
            }
        });
        fill_between(places, measured);
    }
    std::vector<GapStation> kept;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (measured[i]) {
            kept.push_back({*measured[i], false});
        } else if (places[i].modelled && (closed || !kept.empty())) {
            kept.push_back(places[i]);
        }
    }
    // What is bridged needs support on both sides.
    while (!closed && !kept.empty() && kept.back().modelled) {
        kept.pop_back();
    }
    return kept;
}

// How far the shorter top reaches at the gap, beyond a place, along `ahead`.
double reach_ahead(const Around& around, const GapPlace& place, const Eigen::Vector3d& ahead, double look) {
    const ScanScale scale = around.field.at(place.p);
    const Eigen::Vector3d left = place.n.cross(place.t);
    double reach = look;
    for (const double side : {-1.0, 1.0}) {
        std::vector<double> s;
        double density = 0;
        around.grid.for_points_in_ball(place.p, look + 6 * scale.spacing, [&](const Eigen::Vector3f& q, double) {
            const Eigen::Vector3d v = q.cast<double>() - place.p;
            const double d = side * v.dot(left) - 0.5 * place.gap, x = v.dot(ahead);
            const double z = v.dot(place.n) - 0.5 * side * place.mismatch;
            if (d > 0.5 * scale.spacing && d < 8 * scale.spacing && std::abs(z) < 4 * noise_of(scale) && x < look) {
                if (x > 0) {
                    s.push_back(x);
                } else {
                    density += x > -look ? 1 / look : 0;
                }
            }
        });
        reach = std::min(reach, end_of(s, density));
    }
    return reach;
}

// Shortens or lengthens the back of the way to where the first top ends.
void place_end(const Around& around, std::vector<GapStation>& way, double step, double direction) {
    constexpr std::size_t kInside = 6;
    if (way.size() < 3 * kInside) {
        return;
    }
    const GapPlace inner = way[way.size() - 1 - kInside].fit.place;
    const double look = 4 * static_cast<double>(kInside) * step, spacing = around.field.at(inner.p).spacing;
    const Eigen::Vector3d ahead = direction * inner.t;
    const double reach = reach_ahead(around, inner, ahead, look) - spacing;
    const auto at = [&](const GapStation& s) { return (s.fit.place.p - inner.p).dot(ahead); };
    if (reach + 4 * spacing >= look) {
        return;
    }
    while (way.size() > 4 && at(way.back()) > reach - 0.5 * step) {
        way.pop_back();
    }
    GapStation end = way.back();
    const double rest = reach - at(end);
    GapPlace& place = end.fit.place;
    place.p += rest * direction * place.t;
    end.fit.sigma *= 1 + rest / (10 * step);
    way.push_back(end);
}

// 1-sigma of a view's shift, by how far the views' points lie off the tops along the whole seam.
double registration_of(const std::vector<GapStation>& way) {
    std::map<std::uint32_t, GapFit::ViewOff> all;
    for (const GapStation& station : way) {
        for (const auto& [view, off] : station.fit.views) {
            all[view].sum += off.sum;
            all[view].count += off.count;
        }
    }
    double n = 0, sum = 0, squares = 0, most = 0;
    for (const auto& [view, off] : all) {
        most = std::max(most, off.count);
    }
    for (const auto& [view, off] : all) {
        if (off.count > 0.05 * most) {
            const double mean = off.sum / off.count;
            n += 1, sum += mean, squares += mean * mean;
        }
    }
    return n < 2 ? 0 : std::sqrt(std::max(0.0, squares - sum * sum / n) / (n - 1)) * (1 + 0.6 / (n - 1));
}

Seam seam_of(const Around& around, const std::vector<GapStation>& way, bool closed) {
    const double registration = registration_of(way);
    Seam seam;
    seam.kind = JointKind::butt;
    seam.closed = closed;
    std::vector<double> gap, mismatch, spacing;
    double walls = 0, bridged = 0;
    for (const GapStation& station : way) {
        const GapFit& fit = station.fit;
        const ScanScale scale = around.field.at(fit.place.p);
        const double unseen = kUnseen * noise_of(scale);
        const double sigma =
            std::sqrt(fit.sigma * fit.sigma + registration * registration * fit.shift + unseen * unseen);
        seam.points.push_back({around.scan.origin_mm + fit.place.p, fit.n1, fit.n2, sigma, station.modelled});
        GrooveStation groove;
        if (!station.modelled) {
            groove.gap_mm = {fit.gap.value, std::hypot(fit.gap.sigma, 2 * unseen)};
            groove.mismatch_mm = {fit.mismatch.value, fit.mismatch.sigma};
            gap.push_back(fit.gap.value);
            mismatch.push_back(fit.mismatch.value);
            spacing.push_back(scale.spacing);
        }
        seam.groove.push_back(groove);
        walls += fit.walled[0] + fit.walled[1];
        bridged += station.modelled;
    }
    const double typical = quantile(gap, 0.5), step = quantile(mismatch, 0.5), pitch = quantile(spacing, 0.5);
    // A gap of three point distances leaves no doubt; at one and a bit it could be a row that the scanner left out.
    seam.confidence =
        std::clamp(0.4 + 0.6 * (typical / pitch - 1) / 2, 0.0, 1.0) * (1 - bridged / static_cast<double>(way.size()));
    seam.kind_reason = "two parallel tops end " + fixed(typical, 2) + " mm apart, the " +
                       (step < 0 ? "right" : "left") + " one " + fixed(std::abs(step), 2) + " mm higher; " +
                       (walls > 0 ? "their edges' walls are seen" : "nothing is seen of their edges' walls");
    return seam;
}

double length_of(const std::vector<GapStation>& way) {
    double length = 0;
    for (std::size_t i = 1; i < way.size(); ++i) {
        length += (way[i].fit.place.p - way[i - 1].fit.place.p).norm();
    }
    return length;
}

// Whether the scan's own rows are as far apart beside the gap as what it was followed along.
bool is_between_rows(const Around& around, const std::vector<GapStation>& way) {
    std::vector<double> excess;
    const std::size_t stride = 1 + way.size() / 25;
    for (std::size_t i = 0; i < way.size(); i += stride) {
        const GapPlace& place = way[i].fit.place;
        if (!way[i].modelled) {
            excess.push_back(way[i].fit.gap.value / row_distance(around, place));
        }
    }
    return quantile(excess, 0.5) < kLeastOverRows;
}

// The gap between two plates shows on their end faces, too: short, and round the corner from the end of the joint.
bool goes_round(const Seam& shorter, const Seam& longer, double reach) {
    const auto meets = [&](const SeamPoint& a, const SeamPoint& b) {
        return (a.p - b.p).norm() < reach && a.n1.dot(b.n1) < std::cos(kRound);
    };
    return !longer.closed &&
           (meets(shorter.points.front(), longer.points.front()) ||
            meets(shorter.points.front(), longer.points.back()) ||
            meets(shorter.points.back(), longer.points.front()) || meets(shorter.points.back(), longer.points.back()));
}

}  // namespace

Butts find_butts(const Around& around, const std::vector<Border>& borders, double min_length_mm) {
    const double step = around.following.step;
    Butts result;
    for (const GapWay& followed : follow_gaps(around, borders)) {
        std::vector<GapStation> way = measure_places(around, at_equal_steps(followed, step), followed.closed, step);
        if (!followed.closed) {
            place_end(around, way, step, 1);
            std::reverse(way.begin(), way.end());
            place_end(around, way, step, -1);
            std::reverse(way.begin(), way.end());
        }
        const double least = min_length_mm > 0 ? min_length_mm : kLeastButt * around.field.overall.spacing;
        const double length = length_of(way);
        const auto bridged = static_cast<std::size_t>(
            std::count_if(way.begin(), way.end(), [](const GapStation& station) { return station.modelled; }));
        if (3 * bridged > way.size()) {
            continue;  // strays that line up here and there
        }
        if (way.size() < 6 || length < least) {
            result.remarks.push_back("a gap " + fixed(length, 1) + " mm long was left out: shorter than " +
                                     fixed(least, 1) + " mm");
            continue;
        }
        if (is_between_rows(around, way)) {
            result.remarks.push_back("a gap " + fixed(length, 1) +
                                     " mm long was left out: it is no wider than those between the scan's own rows");
            continue;
        }
        result.seams.push_back(seam_of(around, way, followed.closed));
    }
    std::stable_sort(result.seams.begin(), result.seams.end(),
                     [](const Seam& a, const Seam& b) { return a.points.size() > b.points.size(); });
    for (std::size_t i = 0; i < result.seams.size(); ++i) {
        std::erase_if(result.seams, [&](const Seam& seam) {
            const bool round = &seam > &result.seams[i] && goes_round(seam, result.seams[i], 2 * kMostGap);
            if (round) {
                result.remarks.push_back(
                    "a gap on the end faces of two plates was left out: it goes on round the corner");
            }
            return round;
        });
    }
    return result;
}

}  // namespace seampath::detail
