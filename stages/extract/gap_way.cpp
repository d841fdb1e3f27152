#include "stages/extract/gap_way.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace seampath::detail {
namespace {

constexpr double kLeastGap = 1.1;  // point distances; what is narrower is not seen, and may be a step's wall
constexpr double kMostGapTurn = 20 * std::numbers::pi / 180;  // of the direction, per step of following
constexpr double kMostBridge = 25;                            // mm without a gap to be seen, which tacks bridge
constexpr std::size_t kMostGapSteps = 20000;
constexpr std::size_t kFewest = 3;  // places; what is seen at fewer is no gap

class Follower {
public:
    explicit Follower(const Around& around)
        : around_(around), scan_(viewed_points(around)), step_(2 * around.following.step) {}

    double step() const { return step_; }

    std::optional<GapFit> measure(const GapPlace& guess, int rounds) const {
        const ScanScale scale = around_.field.at(guess.p);
        auto fit = settle_gap(scan_, scale, guess, following_window(scale), rounds);
        return fit && is_gap(*fit, scale) ? fit : std::nullopt;
    }

    // Both ways from a seed, until the gap is no longer seen or comes back to where it began.
    GapWay follow(const GapFit& seed) const {
        GapWay way{{{seed}}, false};
        for (const double direction : {1.0, -1.0}) {
            way.closed = way.closed || advance(way.at, direction);
            std::reverse(way.at.begin(), way.at.end());
        }
        return way;
    }

private:
    // Extends the way at its back; true when it has come back to its front.
    bool advance(std::vector<GapStation>& way, double direction) const {
        while (way.size() < kMostGapSteps) {
            const auto next = beyond(way, direction);
            if (!next) {
                return false;
            }
            const GapStation last = way.back();  // a copy: the way grows
            const double jump = (next->place.p - last.fit.place.p).norm();
            const int steps = static_cast<int>(std::lround(jump / step_));
            for (int i = 1; i < steps; ++i) {
                way.push_back({last.fit, true});
                way.back().fit.place = between(last.fit.place, next->place, static_cast<double>(i) / steps);
            }
            way.push_back({*next});
            if (const auto start = met_again(way)) {
                // What lies before the place that it came back to is a piece travelled once, on the way there.
                way.erase(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(*start));
                way.pop_back();
                return true;
            }
        }
        return false;
    }

    // The place of the way at which its back has arrived once more.
    std::optional<std::size_t> met_again(const std::vector<GapStation>& way) const {
        constexpr std::size_t kBehind = 20;  // the latest places are near in any case
        const GapPlace& now = way.back().fit.place;
        for (std::size_t i = 0; i + kBehind < way.size(); ++i) {
            const GapPlace& then = way[i].fit.place;
            if ((now.p - then.p).norm() < step_ && now.t.dot(then.t) > 0.8) {
                return i;
            }
        }
        return std::nullopt;
    }

    // The next measured place; where a tack hides the gap, one behind it.
    std::optional<GapFit> beyond(const std::vector<GapStation>& way, double direction) const {
        const GapPlace& last = way.back().fit.place;
        Eigen::Vector3d turn = Eigen::Vector3d::Zero();  // of the direction, per mm
        if (way.size() > 8) {
            const GapPlace& before = way[way.size() - 8].fit.place;
            turn = (last.t - before.t) / std::max(step_, (last.p - before.p).norm());
        }
        for (double ahead = step_; ahead <= kMostBridge; ahead += step_) {
            GapPlace guess = last;
            guess.p += ahead * direction * last.t + 0.5 * ahead * ahead * turn;
            auto fit = measure(guess, 2);
            const double off = fit ? (fit->place.p - guess.p).norm() : 0;
            if (fit && off < 0.25 * last.gap + 0.3 * step_ + 0.02 * ahead &&
                fit->place.t.dot(last.t) > std::cos(kMostGapTurn) && fit->place.gap > 0.4 * last.gap &&
                fit->place.gap < 2.5 * last.gap) {
                return fit;
            }
        }
        return std::nullopt;
    }

    const Around& around_;
    ViewedPoints scan_;
    double step_;
};

std::optional<GapPlace> place_of(const Around& around, const Border& border) {
    const auto other = sheet_beyond(around, border, kMostGap, -kMostMismatch, kMostMismatch);
    if (!other) {
        return std::nullopt;
    }
    // The sheet that ends is plate 1, on the right of travel. The narrowest gaps are not yet told from none.
    const double gap = std::max(other->gap, kLeastGap * around.field.at(border.p).spacing);
    return GapPlace{border.p + 0.5 * gap * border.out + 0.5 * other->height * border.n,
                    border.out.cross(border.n),
                    border.n,
                    gap,
                    other->height,
                    0};
}

bool lies_on(const GapWay& way, const Eigen::Vector3d& p, double reach) {
    return std::any_of(way.at.begin(), way.at.end(),
                       [&](const GapStation& s) { return (s.fit.place.p - p).norm() < reach; });
}

// Whether most of the way is part of the longer one.
bool runs_along(const GapWay& way, const GapWay& longer, double reach) {
    const auto on = std::count_if(way.at.begin(), way.at.end(),
                                  [&](const GapStation& s) { return lies_on(longer, s.fit.place.p, reach); });
    return way.at.size() <= longer.at.size() && 2 * static_cast<std::size_t>(on) > way.at.size();
}

}  // namespace

ViewedPoints viewed_points(const Around& around) {
    return {around.grid, around.following.view_starts};
}

bool is_gap(const GapFit& fit, const ScanScale& scale) {
    const auto& [place, n1, n2, gap, mismatch, sigma, shift, views, support, walled] = fit;
    return place.gap > kLeastGap * scale.spacing && place.gap < kMostGap && std::abs(place.mismatch) < kMostMismatch &&
           n1.dot(n2) > std::cos(kMostGapTurn) && std::min(support[0], support[1]) > 0;
}

double row_distance(const Around& around, const GapPlace& place) {
    const ScanScale scale = around.field.at(place.p);
    const double reach = 12 * scale.spacing, half = 0.5 * reach;
    const Eigen::Vector3d left = place.n.cross(place.t);
    double widest = 0;
    for (const double side : {-1.0, 1.0}) {
        std::vector<double> d{0, reach};
        around.grid.for_points_in_ball(place.p, place.gap + 2 * reach, [&](const Eigen::Vector3f& q, double) {
            const Eigen::Vector3d v = q.cast<double>() - place.p;
            const double across = side * v.dot(left) - 0.5 * place.gap;
            const double z = v.dot(place.n) - 0.5 * side * place.mismatch;
            if (across > 0 && across < reach && std::abs(v.dot(place.t)) < half && std::abs(z) < 4 * scale.noise) {
                d.push_back(across);
            }
        });
        std::sort(d.begin(), d.end());
        for (std::size_t i = 1; i < d.size(); ++i) {
            widest = std::max(widest, d[i] - d[i - 1]);
        }
    }
    return widest;
}

GapPlace between(const GapPlace& a, const GapPlace& b, double x) {
    const auto mixed = [x]<typename T>(const T& from, const T& to) -> T { return (1 - x) * from + x * to; };
    return {mixed(a.p, b.p),     mixed(a.t, b.t).normalized(),  mixed(a.n, b.n).normalized(),
            mixed(a.gap, b.gap), mixed(a.mismatch, b.mismatch), mixed(a.bend, b.bend)};
}

std::vector<GapWay> follow_gaps(const Around& around, const std::vector<Border>& borders) {
    const Follower follower(around);
    std::vector<GapWay> ways;
    for (const Border& border : borders) {
        const auto taken = [&](const Eigen::Vector3d& p) {
            return std::any_of(ways.begin(), ways.end(),
                               [&](const GapWay& way) { return lies_on(way, p, kMostGap + 2 * follower.step()); });
        };
        if (taken(border.p)) {
            continue;
        }
        const auto place = place_of(around, border);
        const auto seed = place ? follower.measure(*place, 4) : std::nullopt;
        if (seed && (seed->place.p - place->p).norm() < kMostGap && !taken(seed->place.p)) {
            GapWay way = follower.follow(*seed);
            // A way that had broken off before is found again by one that goes further.
            std::erase_if(ways, [&](const GapWay& other) { return runs_along(other, way, follower.step()); });
            if (way.at.size() >= kFewest) {
                ways.push_back(std::move(way));
            }
        }
    }
    return ways;
}

}  // namespace seampath::detail
