#include "stages/extract/groove_way.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/parallel.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLeastBevelDensity = 0.1;  // of the bevel's usual density
constexpr double kMostSlope = 0.3;          // of a groove's faces along it, from one place to the next
constexpr std::size_t kMostGrooveSteps = 100000;

GrooveWindow following_window_of(const ScanScale& scale) {
    const SectionWindow w = following_window(scale);
    return {0.6 * w.along, 0.6 * w.along, w.away, w.band};
}

GrooveWindow measuring_window_of(const ScanScale& scale) {
    return groove_window(measuring_window(scale));
}

GrooveShape moved(GrooveShape shape, const Vector2d& by) {
    for (std::size_t k = 0; k < 2; ++k) {
        shape.corner[k] -= by;
        shape.end[k] -= by;
    }
    return shape;
}

std::optional<GroovePlace> measure(const Tracker& tracker, const GrooveFrame& frame, const GrooveShape& guess,
                                   const GrooveWindow& window, int rounds) {
    auto fit = fit_groove(tracker.grid, tracker.view_starts, tracker.field.at(frame.p), frame, guess, window, rounds);
    if (!fit) {
        return std::nullopt;
    }
    return GroovePlace{frame, std::move(*fit), {}};
}

// The direction of the groove at a place: along both bevels.
Vector3d direction_of(const GroovePlace& place) {
    Vector3d n[2];
    for (std::size_t k = 0; k < 2; ++k) {
        const GrooveFace& face = place.fit.bevel[k];
        n[k] = (place.frame.direction(face.n - face.c[1] / face.length * face.d) - face.slope_along * place.frame.t)
                   .normalized();
    }
    return n[0].cross(n[1]).normalized();
}

Vector3d up_of(const GroovePlace& place) {
    Vector3d up = Vector3d::Zero();
    for (const GrooveFace& top : place.fit.top) {
        up += (place.frame.direction(top.n) - top.c[1] / top.length * place.frame.direction(top.d) -
               top.slope_along * place.frame.t)
                  .normalized();
    }
    return up.normalized();
}

// The line that a groove is followed along: the middle of its top edges, which are known better than its root.
Vector2d middle_of(const GroovePlace& place) {
    return 0.5 * (place.fit.shape.corner[0] + place.fit.shape.corner[1]);
}

// Moved to that line, turned to the measured direction.
struct Station {
    GrooveFrame frame;
    GrooveShape shape;
};
Station settled(const GroovePlace& place) {
    Station s;
    s.frame.p = place.frame.at(middle_of(place));
    s.frame.t = direction_of(place);
    const Vector3d up = up_of(place);
    s.frame.up = (up - up.dot(s.frame.t) * s.frame.t).normalized();
    s.shape = moved(place.fit.shape, middle_of(place));
    return s;
}

bool believable(const GroovePlace& place, const std::vector<GroovePlace>& way, double step) {
    std::vector<double> width;
    std::array<std::vector<double>, 2> density;
    for (std::size_t i = way.size() > 15 ? way.size() - 15 : 0; i < way.size(); ++i) {
        for (std::size_t k = 0; k < 2; ++k) {
            density[k].push_back(way[i].fit.density[k]);
        }
        width.push_back((way[i].fit.shape.corner[1] - way[i].fit.shape.corner[0]).norm());
    }
    const double now = (place.fit.shape.corner[1] - place.fit.shape.corner[0]).norm(), before = quantile(width, 0.5);
    if (middle_of(place).norm() > 0.7 * step + 0.1 * before || std::abs(now - before) > 0.25 * before) {
        return false;
    }
    for (std::size_t k = 0; k < 2; ++k) {
        if (place.fit.density[k] < kLeastBevelDensity * quantile(density[k], 0.5) ||
            std::max(std::abs(place.fit.bevel[k].slope_along), std::abs(place.fit.top[k].slope_along)) > kMostSlope) {
            return false;
        }
    }
    return true;
}

// Extends the way in one direction; true when it comes back to its beginning.
bool advance(const Tracker& tracker, std::vector<GroovePlace>& way, double direction) {
    constexpr std::size_t kBehind = 10, kOver = 8;
    while (way.size() < kMostGrooveSteps) {
        Station next = settled(way.back());
        Vector3d t = next.frame.t;
        if (way.size() > kOver) {
            // Over some places: one place's noise must not steer.
            const Station before = settled(way[way.size() - 1 - kOver]);
            const Vector3d chord = next.frame.p - before.frame.p;
            next.frame.bend = direction * (next.frame.t - before.frame.t) / chord.norm();
            next.frame.bend -= next.frame.bend.dot(t) * t;
            t = (direction * chord.normalized() + 0.5 * direction * chord.norm() * next.frame.bend).normalized();
        }
        const Vector3d ahead = direction * (t + 0.5 * direction * tracker.step * next.frame.bend).normalized();
        next.frame.p += tracker.step * ahead;
        next.frame.t = t;
        next.frame.up = (next.frame.up - next.frame.up.dot(t) * t).normalized();
        const GrooveWindow window = following_window_of(tracker.field.at(next.frame.p));
        auto place = measure(tracker, next.frame, next.shape, window, 2);
        if (!place || !believable(*place, way, tracker.step)) {
            return false;
        }
        for (std::size_t i = 0; i + kBehind < way.size(); ++i) {
            const Vector3d there = way[i].frame.at(middle_of(way[i]));
            if ((there - place->frame.at(middle_of(*place))).norm() < 0.7 * tracker.step) {
                way.erase(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(i));
                return true;
            }
        }
        way.push_back(std::move(*place));
    }
    return false;
}

// The line of a way's roots, smoothed: frames at equal steps along it.
class Course {
public:
    Course(const std::vector<Station>& stations, bool closed, double smooth, double noise)
        : stations_(stations), closed_(closed), smooth_(smooth), noise_(noise) {
        station_.push_back(0);
        const std::size_t n = stations.size();
        for (std::size_t i = 1; i < n + (closed ? 1 : 0); ++i) {
            station_.push_back(station_.back() + (stations[i % n].frame.p - stations[i - 1].frame.p).norm());
        }
    }
    double length() const { return station_.back(); }

    // A quadratic through the places within twice `smooth`, or less far where they do not lie on one; as many of them
    // at an end.
    Station at(double s) const {
        double smooth = 2 * smooth_;
        while (true) {
            const auto [station, rms] =
                quadratic(s, closed_ ? smooth : smooth + std::max({0.0, smooth - s, s + smooth - length()}));
            if (rms < noise_ || smooth < 0.7 * smooth_) {
                return station;
            }
            smooth *= 0.7;
        }
    }

private:
    struct Local {
        Station station;
        double rms;
    };

    Local quadratic(double s, double reach) const {
        const double total = length();
        Eigen::Matrix3d A = Eigen::Matrix3d::Zero(), b = Eigen::Matrix3d::Zero();
        Vector3d up = Vector3d::Zero();
        GrooveShape sum{};
        for (auto* part : {&sum.corner, &sum.end, &sum.out}) {
            part->fill(Vector2d::Zero());
        }
        double count = 0, squares = 0;
        const auto n = static_cast<std::ptrdiff_t>(stations_.size());
        const std::ptrdiff_t first = closed_ ? -n : 0, last = closed_ ? 2 * n : n;
        for (std::ptrdiff_t j = first; j < last; ++j) {
            const std::ptrdiff_t turn = j < 0 ? -1 : j / n;
            const auto i = static_cast<std::size_t>(j - turn * n);
            const double x = (station_[i] + static_cast<double>(turn) * total - s) / reach;
            if (std::abs(x) > 1) {
                continue;
            }
            const Vector3d row(1, x, x * x), p = stations_[i].frame.p - stations_.front().frame.p;
            A += row * row.transpose();
            b += row * p.transpose();
            squares += p.squaredNorm();
            up += stations_[i].frame.up;
            for (std::size_t k = 0; k < 2; ++k) {
                sum.corner[k] += stations_[i].shape.corner[k];
                sum.end[k] += stations_[i].shape.end[k];
                sum.out[k] += stations_[i].shape.out[k];
            }
            count += 1;
        }
        const Eigen::Matrix3d c = A.ldlt().solve(b);
        Station result;
        result.frame.p = stations_.front().frame.p + c.row(0).transpose();
        result.frame.t = c.row(1).transpose().normalized();
        result.frame.bend = 2 * c.row(2).transpose() / (reach * reach);
        result.frame.bend -= result.frame.bend.dot(result.frame.t) * result.frame.t;
        result.frame.up = (up - up.dot(result.frame.t) * result.frame.t).normalized();
        for (std::size_t k = 0; k < 2; ++k) {
            result.shape.corner[k] = sum.corner[k] / count;
            result.shape.end[k] = sum.end[k] / count;
            result.shape.out[k] = sum.out[k].normalized();
        }
        return {result, std::sqrt(std::max(0.0, squares - (c.transpose() * b).trace()) / count)};
    }

private:
    const std::vector<Station>& stations_;
    bool closed_;
    double smooth_, noise_;
    std::vector<double> station_;
};

// How far ahead (+1) or behind (-1) of a place the shorter of its bevels reaches, mm.
double reach_from(const Tracker& tracker, const Station& at, const GrooveFit& fit, double direction, double look) {
    const ScanScale scale = tracker.field.at(at.frame.p);
    GrooveFrame frame = at.frame;
    GrooveBox box{Vector2d::Constant(1e9), Vector2d::Constant(-1e9)};
    for (std::size_t k = 0; k < 2; ++k) {
        for (const Vector2d& x : {fit.shape.corner[k], fit.shape.end[k]}) {
            box.low = box.low.cwiseMin(x);
            box.high = box.high.cwiseMax(x);
        }
    }
    box.low.array() -= 5 * scale.noise;
    box.high.array() += 5 * scale.noise;
    const auto points = groove_points(tracker.grid, tracker.view_starts, frame, -look, look, box);
    double reach = look;
    for (std::size_t k = 0; k < 2; ++k) {
        std::vector<double> s;
        const double corner = fit.bevel[k].along(fit.shape.corner[k]), end = fit.bevel[k].along(fit.shape.end[k]);
        for (const GroovePoint& q : points) {
            const double u = fit.bevel[k].along(q.section());
            if (u > end && u < corner && std::abs(fit.bevel[k].off(q.section())) < 5 * scale.noise) {
                s.push_back(direction * q.s);
            }
        }
        const auto edge = density_edge(std::move(s), 0, scale.spacing, scale.noise);
        reach = std::min(reach, edge ? edge->at : 0.0);
    }
    return reach;
}

}  // namespace

std::optional<GrooveWay> follow_groove(const Tracker& following, const GrooveSeed& seed) {
    const GrooveWindow window = following_window_of(following.field.at(seed.frame.p));
    auto first = measure(following, seed.frame, seed.shape, window, 3);
    if (first) {
        const Station turned = settled(*first);
        first = measure(following, turned.frame, turned.shape, window, 2);
    }
    if (!first || middle_of(*first).norm() > 2 * following.step) {
        return std::nullopt;
    }
    GrooveWay way;
    way.places = {std::move(*first)};
    way.closed = advance(following, way.places, 1);
    if (!way.closed) {
        std::reverse(way.places.begin(), way.places.end());
        way.closed = advance(following, way.places, -1);
        std::reverse(way.places.begin(), way.places.end());
    }
    return way;
}

std::optional<GrooveWay> measure_groove(const Tracker& tracker, const GrooveWay& followed) {
    constexpr std::size_t kFewest = 6;
    if (followed.places.size() < kFewest) {
        return std::nullopt;
    }
    std::vector<Station> stations;
    for (const GroovePlace& place : followed.places) {
        stations.push_back(settled(place));
    }
    const GrooveWindow window = measuring_window_of(tracker.field.at(stations[stations.size() / 2].frame.p));
    const double noise = tracker.field.overall.noise;
    {
        // With wider windows its line runs smoother.
        const Course first(stations, followed.closed, window.back, noise);
        const auto coarse =
            std::max<std::size_t>(kFewest, static_cast<std::size_t>(first.length() / (4 * tracker.step)));
        std::vector<std::optional<Station>> wide(coarse + (followed.closed ? 0 : 1));
        parallel_for(wide.size(), 4, [&](std::size_t i) {
            const Station at = first.at(first.length() * static_cast<double>(i) / static_cast<double>(coarse));
            const auto place = measure(tracker, at.frame, at.shape, window, 2);
            if (place) {
                wide[i] = settled(*place);
            }
        });
        stations.clear();
        for (const auto& station : wide) {
            if (station) {
                stations.push_back(*station);
            }
        }
        if (stations.size() < kFewest) {
            return std::nullopt;
        }
    }
    const Course course(stations, followed.closed, window.back, 0.5 * noise);
    double begin = 0, end = course.length();
    if (!followed.closed) {
        const std::size_t inside = std::min<std::size_t>(8, followed.places.size() / 3);
        const double look = static_cast<double>(inside + 8) * tracker.step, spacing = tracker.field.overall.spacing;
        const auto reach = [&](double from, double direction) {
            const Station at = course.at(from);
            const auto place =
                measure(tracker, at.frame, at.shape, following_window_of(tracker.field.at(at.frame.p)), 2);
            return place ? from + direction * (reach_from(tracker, at, place->fit, direction, look) - spacing) : from;
        };
        const double in = static_cast<double>(inside) * tracker.step;
        begin = reach(in, -1);
        end = reach(course.length() - in, 1);
        if (end - begin < static_cast<double>(kFewest) * tracker.step) {
            return std::nullopt;
        }
    }
    const auto count =
        std::max<std::size_t>(kFewest, static_cast<std::size_t>(std::lround((end - begin) / tracker.step)));
    std::vector<std::optional<GroovePlace>> measured(count + (followed.closed ? 0 : 1));
    parallel_for(measured.size(), 4, [&](std::size_t i) {
        const double s = begin + (end - begin) * static_cast<double>(i) / static_cast<double>(count);
        const Station at = course.at(s);
        GrooveWindow w = window;
        if (!followed.closed) {
            w = near_ends(window, s - begin, end - s);
        }
        measured[i] = measure(tracker, at.frame, at.shape, w, 3);
    });
    GrooveWay way;
    way.closed = followed.closed;
    std::vector<GrooveFit> fits;
    for (auto& place : measured) {
        if (place) {
            fits.push_back(place->fit);
            way.places.push_back(std::move(*place));
        }
    }
    if (way.places.size() < kFewest || 2 * way.places.size() < measured.size()) {
        return std::nullopt;
    }
    const auto root = pool_roots(fits, (end - begin) / static_cast<double>(count), 2 * window.back);
    if (!root) {
        return std::nullopt;
    }
    way.root = *root;
    for (std::size_t i = 0; i < way.places.size(); ++i) {
        const auto numbers = numbers_of(fits[i], way.root);
        way.places[i].fit = std::move(fits[i]);
        if (!numbers) {
            return std::nullopt;
        }
        way.places[i].numbers = *numbers;
    }
    return way;
}

}  // namespace seampath::detail
