#include "datasets/score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stages/geometry/bspline.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 0.25;  // mm between the places at which a reported curve is looked at

struct Polyline {
    bool closed;
    std::vector<Vector3d> points;
    JointKind kind;
    std::vector<Vector3d> tangents{};  ///< of a model, one a point; else empty

    std::size_t segments() const { return points.size() - (closed ? 0 : 1); }
    const Vector3d& after(std::size_t i) const { return points[(i + 1) % points.size()]; }
    double length(std::size_t segment) const { return (after(segment) - points[segment]).norm(); }
    /// Length that point i stands for.
    double weight(std::size_t i) const {
        const std::size_t before = i > 0 ? i - 1 : points.size() - 1;
        return 0.5 * ((i > 0 || closed ? length(before) : 0) + (i < segments() ? length(i) : 0));
    }
};

/// A true seam with the arc length at its points.
struct TrueCurve {
    const TruthSeam& seam;
    Polyline line;
    std::vector<double> station;
    double length;
};

std::vector<TrueCurve> true_curves(const Truth& truth) {
    std::vector<TrueCurve> curves;
    for (const TruthSeam& seam : truth.seams) {
        TrueCurve curve{seam, {seam.closed, {}, seam.kind}, {}, 0};
        for (const TruthPoint& point : seam.points) {
            curve.line.points.push_back(point.p);
        }
        for (std::size_t i = 0; i < curve.line.points.size(); ++i) {
            curve.station.push_back(curve.length);
            curve.length += i < curve.line.segments() ? curve.line.length(i) : 0;
        }
        curves.push_back(std::move(curve));
    }
    return curves;
}

/// Where a point lies beside a true seam. Beyond an open end the station goes on, below 0 or above the length, and the
/// distance is from the straight continuation.
struct Foot {
    double distance = std::numeric_limits<double>::infinity();
    double station = 0;
    TruthPoint at{Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitZ(), Vector3d::UnitZ()};
};

/// Distance from the cubic through two neighbouring samples and their tangents (Hermite), at the foot on the chord.
/// Over 0.1 mm the cubic departs from a seam of 5 mm radius or more by less than 1e-4 mm.
Foot foot_on_piece(const TrueCurve& curve, std::size_t i, const Vector3d& p) {
    const TruthPoint& a = curve.seam.points[i];
    const TruthPoint& b = curve.seam.points[(i + 1) % curve.seam.points.size()];
    const double h = (b.p - a.p).norm();
    const double u = std::clamp((p - a.p).dot(b.p - a.p) / (h * h), 0.0, 1.0);
    const double v = 1 - u;
    const Vector3d q =
        v * v * (1 + 2 * u) * a.p + u * u * (1 + 2 * v) * b.p + h * u * v * (v * a.tangent - u * b.tangent);
    return {(p - q).norm(),
            curve.station[i] + u * h,
            {q, (v * a.tangent + u * b.tangent).normalized(), (v * a.n1 + u * b.n1).normalized(),
             (v * a.n2 + u * b.n2).normalized()}};
}

Foot foot_beyond_end(const TruthPoint& end, double station, const Vector3d& p) {
    const double along = (p - end.p).dot(end.tangent);
    const Vector3d q = end.p + along * end.tangent;
    return {(p - q).norm(), station + along, {q, end.tangent, end.n1, end.n2}};
}

Foot foot(const TrueCurve& curve, const Vector3d& p) {
    const auto& points = curve.line.points;
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
        if ((points[i] - p).squaredNorm() < (points[nearest] - p).squaredNorm()) {
            nearest = i;
        }
    }
    if (!curve.seam.closed && nearest == 0) {
        const Foot before = foot_beyond_end(curve.seam.points.front(), 0, p);
        return before.station < 0 ? before : foot_on_piece(curve, 0, p);
    }
    if (!curve.seam.closed && nearest + 1 == points.size()) {
        const Foot behind = foot_beyond_end(curve.seam.points.back(), curve.length, p);
        return behind.station > curve.length ? behind : foot_on_piece(curve, nearest - 1, p);
    }
    const Foot one = foot_on_piece(curve, nearest > 0 ? nearest - 1 : points.size() - 1, p);
    const Foot other = foot_on_piece(curve, nearest, p);
    return one.distance < other.distance ? one : other;
}

bool corresponds(const TrueCurve& curve, const Foot& foot) {
    return foot.distance <= kCorrespondence && foot.station >= -kCorrespondence &&
           foot.station <= curve.length + kCorrespondence;
}

/// The nearest true seam, at an infinite distance where none corresponds.
struct Match {
    Foot foot;
    JointKind kind{};
};

Match match(const std::vector<TrueCurve>& curves, const Vector3d& p) {
    Match nearest;
    for (const TrueCurve& curve : curves) {
        const Foot f = foot(curve, p);
        if (corresponds(curve, f) && f.distance < nearest.foot.distance) {
            nearest = {f, curve.seam.kind};
        }
    }
    return nearest;
}

double distance_from_line(const Polyline& line, const Vector3d& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < line.segments(); ++i) {
        const Vector3d step = line.after(i) - line.points[i];
        const double u = std::clamp((p - line.points[i]).dot(step) / std::max(step.squaredNorm(), 1e-300), 0.0, 1.0);
        nearest = std::min(nearest, (p - line.points[i] - u * step).squaredNorm());
    }
    return std::sqrt(nearest);
}

/// What one point of a reported curve is off by, and the length that it stands for.
struct Offset {
    double distance, weight;
    double lateral, vertical;
    double turn_deg;
};

Offset offset_of(const Polyline& line, std::size_t i, const Foot& foot) {
    constexpr double kDegrees = 180 / std::numbers::pi;
    const Vector3d off = line.points[i] - foot.at.p;
    const Vector3d up = (foot.at.n1 + foot.at.n2).normalized();
    const double cosine = line.tangents.empty() ? 1 : std::abs(line.tangents[i].dot(foot.at.tangent));
    return {foot.distance, line.weight(i), off.dot(foot.at.tangent.cross(up)), off.dot(up),
            kDegrees * std::acos(std::clamp(cosine, -1.0, 1.0))};
}

double quantile(const std::vector<Offset>& offsets, double Offset::*value, double share) {
    std::vector<std::pair<double, double>> weighted;
    for (const Offset& o : offsets) {
        weighted.emplace_back(o.*value, o.weight);
    }
    return weighted_quantile(std::move(weighted), share);
}

void summarise(const std::vector<Offset>& offsets, Score& score) {
    double total = 0, squares = 0, lateral = 0, lateral_squares = 0, vertical = 0, vertical_squares = 0;
    for (const Offset& o : offsets) {
        total += o.weight;
        squares += o.weight * o.distance * o.distance;
        lateral += o.weight * o.lateral;
        lateral_squares += o.weight * o.lateral * o.lateral;
        vertical += o.weight * o.vertical;
        vertical_squares += o.weight * o.vertical * o.vertical;
        score.max_mm = std::max(score.max_mm, o.distance);
        score.lateral_max_mm = std::max(score.lateral_max_mm, std::abs(o.lateral));
        score.vertical_max_mm = std::max(score.vertical_max_mm, std::abs(o.vertical));
    }
    if (total > 0) {
        score.rms_mm = std::sqrt(squares / total);
        score.lateral_mean_mm = lateral / total;
        score.lateral_rms_mm = std::sqrt(lateral_squares / total);
        score.vertical_mean_mm = vertical / total;
        score.vertical_rms_mm = std::sqrt(vertical_squares / total);
    }
    score.p50_mm = quantile(offsets, &Offset::distance, 0.5);
    score.p95_mm = quantile(offsets, &Offset::distance, 0.95);
    score.tangent_p95_deg = quantile(offsets, &Offset::turn_deg, 0.95);
}

double found_length(const TrueCurve& curve, const std::vector<Polyline>& lines) {
    double found = 0;
    for (std::size_t i = 0; i < curve.line.points.size(); ++i) {
        if (std::any_of(lines.begin(), lines.end(), [&](const Polyline& line) {
                return distance_from_line(line, curve.line.points[i]) <= kCorrespondence;
            })) {
            found += curve.line.weight(i);
        }
    }
    return found;
}

/// Length of the reported curves that corresponds to a true seam, that does so under another kind of joint, and that
/// does not.
struct Lengths {
    double of_seams = 0;
    double of_wrong_kind = 0;
    double of_nothing = 0;
};

Lengths reported_lengths(const std::vector<TrueCurve>& curves, const std::vector<Polyline>& lines) {
    Lengths lengths;
    for (const Polyline& line : lines) {
        for (std::size_t i = 0; i < line.segments(); ++i) {
            const int pieces = static_cast<int>(std::ceil(line.length(i) / kStep));
            for (int k = 0; k < pieces; ++k) {
                const Vector3d middle = line.points[i] + (k + 0.5) / pieces * (line.after(i) - line.points[i]);
                const Match seam = match(curves, middle);
                const bool is_true = std::isfinite(seam.foot.distance);
                (is_true ? lengths.of_seams : lengths.of_nothing) += line.length(i) / pieces;
                lengths.of_wrong_kind += is_true && seam.kind != line.kind ? line.length(i) / pieces : 0;
            }
        }
    }
    return lengths;
}

/// Ends may lie any distance beyond the seam's own ends, but must be beside it.
double end_error(const TrueCurve& curve, double end_station, const std::vector<Polyline>& lines) {
    double error = curve.length;
    for (const Polyline& line : lines) {
        if (line.closed) {
            continue;
        }
        for (const Vector3d& end : {line.points.front(), line.points.back()}) {
            const Foot f = foot(curve, end);
            if (f.distance <= kCorrespondence) {
                error = std::min(error, std::abs(f.station - end_station));
            }
        }
    }
    return error;
}

Score compare(const std::vector<Polyline>& lines, const Truth& truth) {
    const std::vector<TrueCurve> curves = true_curves(truth);
    Score score;
    std::vector<Offset> offsets;
    for (const Polyline& line : lines) {
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            const Foot nearest = match(curves, line.points[i]).foot;
            if (std::isfinite(nearest.distance)) {
                offsets.push_back(offset_of(line, i, nearest));
            }
        }
    }
    summarise(offsets, score);
    double length = 0;
    double found = 0;
    for (const TrueCurve& curve : curves) {
        length += curve.length;
        found += found_length(curve, lines);
        if (!curve.seam.closed) {
            score.end_errors_mm.push_back(end_error(curve, 0, lines));
            score.end_errors_mm.push_back(end_error(curve, curve.length, lines));
        }
    }
    const Lengths reported = reported_lengths(curves, lines);
    if (curves.empty()) {
        score.found = 1;
        score.false_share = reported.of_nothing > 0 ? std::numeric_limits<double>::infinity() : 0;
        return score;
    }
    score.found = found / length;
    score.false_share = reported.of_nothing / length;
    score.repeated_share = std::max(0.0, reported.of_seams - found) / length;
    score.wrong_kind_share = reported.of_wrong_kind / length;
    return score;
}

}  // namespace

double weighted_quantile(std::vector<std::pair<double, double>> value_and_weight, double share) {
    std::sort(value_and_weight.begin(), value_and_weight.end());
    double total = 0;
    for (const auto& [value, weight] : value_and_weight) {
        total += weight;
    }
    double below = 0;
    for (const auto& [value, weight] : value_and_weight) {
        below += weight;
        if (below >= share * total) {
            return value;
        }
    }
    return 0;
}

std::vector<TruthFoot> truth_feet(std::span<const Vector3d> points, const Truth& truth) {
    const std::vector<TrueCurve> curves = true_curves(truth);
    std::vector<TruthFoot> feet;
    for (const Vector3d& p : points) {
        const Foot nearest = match(curves, p).foot;
        feet.push_back({nearest.distance, nearest.at});
    }
    return feet;
}

Score score(std::span<const Seam> seams, const Truth& truth) {
    std::vector<Polyline> lines;
    for (const Seam& seam : seams) {
        Polyline line{seam.closed, {}, seam.kind};
        for (const SeamPoint& point : seam.points) {
            line.points.push_back(point.p);
        }
        lines.push_back(std::move(line));
    }
    return compare(lines, truth);
}

Score score(std::span<const SeamModel> models, const Truth& truth) {
    std::vector<Polyline> lines;
    for (const SeamModel& model : models) {
        const ArcLength arc(model.curve);
        const int steps = std::max(1, static_cast<int>(std::ceil(arc.length() / kStep)));
        Polyline line{model.closed, {}, model.kind};
        for (int i = 0; i < steps + (model.closed ? 0 : 1); ++i) {
            const double u = arc.parameter(arc.length() * i / steps);
            line.points.push_back(position(model.curve, u));
            line.tangents.push_back(tangent(model.curve, u));
        }
        lines.push_back(std::move(line));
    }
    return compare(lines, truth);
}

}  // namespace seampath
