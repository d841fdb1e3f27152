#include "stages/geometry/edge_witness.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr double kReach = 14;       // point distances of a top from which the density is taken
constexpr double kBinPoints = 14;   // of one view, in one bin along the edge
constexpr double kWallTilt = 0.05;  // 1-sigma of an edge wall's slope off the upright: 3 deg
constexpr double kWallShare = 0.2;  // of a view's rows that show points right below the edge when it sees the wall
constexpr double kLeastWall = 20;   // points
constexpr double kSharedNoise = 3;  // variance of the mean of few hundred wall points, over that of independent ones
constexpr double kViewSigma = 0.3;  // noises by which views differ, to weigh them with
constexpr double kWallWord = 1.5;   // how much more than a view that counts a wall is believed
constexpr double kAstray = 6;       // squared, of a witness off the one that most agree with
constexpr double kTwo = 1.6;        // agreement of two witnesses
constexpr std::size_t kLeastBins = 2;

using Pointers = std::vector<const EdgePoint*>;

// Tukey's biweight mean with the scale from the median absolute deviation.
struct Level {
    double value = 0, variance = 0, scale = 0;
};
Level robust_level(const std::vector<double>& y, double least_scale) {
    std::vector<double> work = y;
    Level level{quantile(work, 0.5), 0, 0};
    double weights = 0, squares = 0;
    for (int round = 0; round < 6; ++round) {
        work.clear();
        for (const double x : y) {
            work.push_back(std::abs(x - level.value));
        }
        level.scale = std::max(1.4826 * quantile(work, 0.5), least_scale);
        double sum = 0;
        weights = squares = 0;
        for (const double x : y) {
            const double r = (x - level.value) / (4.685 * level.scale), w = std::pow(std::max(0.0, 1 - r * r), 2);
            sum += w * (x - level.value);
            weights += w;
            squares += w * w;
        }
        level.value += sum / std::max(weights, 1e-9);
    }
    level.variance = level.scale * level.scale * squares / std::max(weights * weights, 1e-12);
    return level;
}

// Points of one view in bins along the edge: on a strip of the plate, and from there over the edge.
struct StripCounts {
    std::vector<double> inner, outer;
    double bin = 0;    // mm
    double below = 0;  // points right below the edge, less those as far above it
};

struct Strip {
    double begin, end;  // mm from the line
    double width() const { return end - begin; }
};

StripCounts count(const Pointers& points, const EdgeLook& look, const Strip& strip, std::size_t bins) {
    const double gate = kTopGate * look.noise;
    StripCounts counts{std::vector<double>(bins, 0), std::vector<double>(bins, 0),
                       2 * look.along / static_cast<double>(bins), 0};
    for (const EdgePoint* q : points) {
        const auto i = std::min(bins - 1, static_cast<std::size_t>(std::max(0.0, (q->s + look.along) / counts.bin)));
        const bool on_top = std::abs(q->off) <= gate;
        if (q->d >= strip.begin) {
            counts.inner[i] += on_top && q->d < strip.end;
            continue;
        }
        // What hangs below the top, half-way at most to what the view sees behind the edge: the other plate's wall, or
        // its top when that is lower.
        const bool hangs = q->off < -gate && (q->d > 0 || q->off > -look.above / 2);
        counts.outer[i] += (on_top && q->d > 0) || hangs;
        if (std::abs(q->d - look.distance) < std::max(2 * look.spacing, 4 * look.noise)) {
            const double height = q->off / look.noise;
            counts.below += (height < -2 && height > -8) - (height > 2 && height < 8);
        }
    }
    return counts;
}

// The distance of the edge by a view that sees the top stop; nothing by one that sees the wall below.
void add_counted(Edge& edge, std::uint32_t view, const Pointers& points, const EdgeLook& look, const Strip& strip) {
    const double inner = static_cast<double>(std::count_if(points.begin(), points.end(), [&](const EdgePoint* q) {
        return std::abs(q->off) <= kTopGate * look.noise && q->d >= strip.begin && q->d < strip.end;
    }));
    const auto bins = static_cast<std::size_t>(std::min(inner / kBinPoints, look.along / look.spacing / 2));
    if (bins < kLeastBins) {
        return;
    }
    const StripCounts counts = count(points, look, strip, bins);
    std::vector<double> sorted = counts.inner, distance, place;
    const double least = 0.5 * quantile(sorted, 0.5);
    for (std::size_t i = 0; i < bins; ++i) {
        if (counts.inner[i] > least) {
            distance.push_back(strip.begin - strip.width() * counts.outer[i] / counts.inner[i]);
            place.push_back(-look.along + counts.bin * (static_cast<double>(i) + 0.5));
        }
    }
    const double covered = counts.bin * static_cast<double>(distance.size()),
                 rows = std::sqrt(inner / (strip.width() * covered)) * covered;
    if (distance.size() < kLeastBins || counts.below > kWallShare * rows) {
        return;
    }
    const Level level = robust_level(distance, 0.2 * look.spacing);
    edge.witnesses.push_back({view, false, level.value, level.variance, 0});
    for (std::size_t i = 0; i < distance.size(); ++i) {
        if (std::abs(distance[i] - level.value) < 3 * level.scale) {
            edge.offs.push_back({place[i], distance[i] - level.value, 1 / (level.scale * level.scale)});
        }
    }
}

// Distance at which most points below the top lie one below the other: the wall, if there is one.
std::optional<double> wall_distance(const Pointers& below, double width, double reach) {
    std::vector<double> d;
    for (const EdgePoint* q : below) {
        d.push_back(q->d);
    }
    std::sort(d.begin(), d.end());
    std::size_t most = 0, first = 0, at = 0;
    for (std::size_t i = 0; i < d.size(); ++i) {
        while (d[i] - d[first] > width) {
            ++first;
        }
        if (i - first + 1 > most) {
            most = i - first + 1;
            at = first;
        }
    }
    const double elsewhere = static_cast<double>(d.size() - most) / std::max(1e-9, reach - width) * width;
    if (static_cast<double>(most) < std::max(kLeastWall, 2 * elsewhere)) {
        return std::nullopt;
    }
    return d[at + most / 2];
}

/// The line d = e + m off in which a wall is seen from above.
struct WallLine {
    double e = 0, m = 0, sigma = 0;
    double variance = 0;  // of e
    double off(const EdgePoint& q) const { return q.d - e - m * q.off; }
    double weight(const EdgePoint& q) const {
        const double r = off(q) / (4.685 * sigma);
        return std::pow(std::max(0.0, 1 - r * r), 2);
    }
};

// By re-weighted least squares with Tukey's biweight; that edges are upright counts as an observation of m.
std::optional<WallLine> fit_wall(const Pointers& below, double begin, double noise) {
    WallLine line{begin, 0, noise, 0};
    for (int round = 0; round < 10; ++round) {
        Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
        Eigen::Vector2d b = Eigen::Vector2d::Zero();
        A(1, 1) = kSharedNoise * line.sigma * line.sigma / (kWallTilt * kWallTilt);
        std::vector<double> residuals;
        for (const EdgePoint* q : below) {
            const double w = line.weight(*q);
            const Eigen::Vector2d row(1, q->off);
            A += w * row * row.transpose();
            b += w * q->d * row;
            if (w > 0.2) {
                residuals.push_back(std::abs(line.off(*q)));
            }
        }
        if (static_cast<double>(residuals.size()) < kLeastWall) {
            return std::nullopt;
        }
        line.sigma = std::clamp(1.4826 * quantile(residuals, 0.5), 0.3 * noise, 2 * noise);
        const Eigen::Matrix2d cofactors = A.inverse();
        const Eigen::Vector2d x = cofactors * b;
        line.e = x[0], line.m = x[1];
        line.variance = kSharedNoise * line.sigma * line.sigma * cofactors(0, 0);
    }
    return line;
}

// The wall below the edge, by all views that see it; each is a witness of where it meets the top.
void add_walls(Edge& edge, const std::vector<EdgePoint>& points, const EdgeLook& look) {
    const double gate = kTopGate * look.noise, reach = look.distance + 3 * look.spacing;
    Pointers below;
    for (const EdgePoint& q : points) {
        if (q.off < -gate && q.off > -kWallDepth * look.spacing && q.d > 0 && q.d < reach) {
            below.push_back(&q);
        }
    }
    const auto begin = wall_distance(below, 3 * look.noise, reach);
    const auto line = begin ? fit_wall(below, *begin, look.noise) : std::nullopt;
    if (!line) {
        return;
    }
    struct Sum {
        double weight = 0, off = 0;
    };
    std::map<std::uint32_t, Sum> views;
    double all = 0;
    for (const EdgePoint* q : below) {
        const double w = line->weight(*q);
        views[q->view].weight += w;
        views[q->view].off += w * line->off(*q);
        all += w;
        if (w > 0.2) {
            edge.offs.push_back({q->s, line->off(*q), 1 / (kSharedNoise * line->sigma * line->sigma)});
        }
    }
    for (const auto& [view, sum] : views) {
        if (sum.weight >= 0.4 * kLeastWall) {
            edge.witnesses.push_back(
                {view, true, line->e + sum.off / sum.weight, line->variance * all / sum.weight, 0});
            edge.walled = true;
        }
    }
}

double apart(const Witness& a, const Witness& b, double between) {
    return std::pow(a.distance - b.distance, 2) / (a.variance + b.variance + 2 * between);
}

// The witness that most others agree with. An edge may lie in the shadow of the other plate for most of the views:
// then those that reach furthest are believed when two of them agree.
Witness reference_of(const std::vector<Witness>& all, const EdgeLook& look, double between) {
    const Witness* reference = &all.front();
    double most = 0;
    for (const Witness& w : all) {
        double agreement = 0;
        for (const Witness& other : all) {
            agreement += std::exp(-0.5 * apart(w, other, between)) * (other.wall ? kWallWord : 1);
        }
        if (look.shaded) {
            agreement = std::min(agreement, kTwo) - 1e-3 * w.distance / look.distance;
        }
        if (agreement > most) {
            most = agreement;
            reference = &w;
        }
    }
    return *reference;
}

void weigh(Edge& edge, const EdgeLook& look) {
    const double between = std::pow(kViewSigma * look.noise, 2);
    const Witness reference = reference_of(edge.witnesses, look, between);
    std::erase_if(edge.witnesses, [&](const Witness& w) { return apart(w, reference, between) > kAstray; });
    double weights = 0;
    for (Witness& w : edge.witnesses) {
        w.share = 1 / (w.variance + between);
        weights += w.share;
    }
    for (Witness& w : edge.witnesses) {
        w.share /= weights;
        edge.distance += w.share * w.distance;
        edge.variance += w.share * w.share * w.variance;
    }
}

}  // namespace

std::optional<Edge> find_edge(const std::vector<EdgePoint>& points, const EdgeLook& look) {
    Edge edge;
    const Strip strip{look.distance + std::max(3 * look.spacing, 4 * look.noise),
                      std::min(look.distance + kReach * look.spacing, 0.9 * look.away)};
    if (strip.width() > 4 * look.spacing) {
        std::map<std::uint32_t, Pointers> by_view;
        for (const EdgePoint& q : points) {
            by_view[q.view].push_back(&q);
        }
        for (const auto& [view, own] : by_view) {
            add_counted(edge, view, own, look, strip);
        }
    }
    add_walls(edge, points, look);
    if (edge.witnesses.empty()) {
        return std::nullopt;
    }
    weigh(edge, look);
    return edge;
}

}  // namespace seampath
