#include <algorithm>
#include <cmath>

#include "stages/geometry/robust.hpp"
#include "stages/stripe/lines.hpp"
#include "stages/stripe/stripe.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

/// 1-sigma of the place where two lines meet, from those across each of them there.
double sigma_of_meeting(const ProfileLine& a, const ProfileLine& b, const Vector2d& p) {
    const auto across = [&](const ProfileLine& line) {
        const double lever = line.direction.dot(p - line.middle) / line.length;
        return line.sigma * std::sqrt(1 + 12 * lever * lever);  // of a line through evenly spread points
    };
    return std::hypot(across(a), across(b)) / std::abs(std::sin(turn(a, b)));
}

ProfileFeature corner_of(const ProfileLine& a, const ProfileLine& b) {
    const Vector2d p = meeting(a, b);
    return {p, sigma_of_meeting(a, b, p), turn(a, b)};
}

/// The neighbouring pieces between which the profile bends most to one side, weighted by the shorter one's length: that
/// much is known of the corner. Null where none bends enough.
const ProfileLine* sharpest(const std::vector<ProfileLine>& lines, double side) {
    const ProfileLine* best = nullptr;
    double most = 0;
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
        const double bend = side * turn(lines[i], lines[i + 1]);
        const double weight = bend * std::min(lines[i].length, lines[i + 1].length);
        if (bend > kLeastBend && weight > most) {
            most = weight;
            best = &lines[i];
        }
    }
    return best;
}

std::optional<ProfileFeature> corner_feature(const std::vector<ProfileLine>& lines, double side) {
    const ProfileLine* first = sharpest(lines, side);
    return first ? std::optional(corner_of(first[0], first[1])) : std::nullopt;
}

Vector2d foot_on(const ProfileLine& line, const Vector2d& p) {
    return line.middle + line.direction.dot(p - line.middle) * line.direction;
}

/// The foot, on the line of a piece, of the place where its stripe ends: outwards from its inner part, the ridge's
/// sharpness falls to half of what it is there. The last point before a gap where it does not.
Vector2d end_of(const ProfilePoints& points, const ProfileLine& line, bool last, double band) {
    const auto n = static_cast<std::ptrdiff_t>(points.p.size());
    const std::ptrdiff_t step = last ? 1 : -1;
    std::ptrdiff_t i = static_cast<std::ptrdiff_t>(last ? line.end - 1 : line.begin);
    const Vector2d corner = points.p[static_cast<std::size_t>(i)];
    std::vector<double> inner;
    const auto in_piece = [&](std::ptrdiff_t k) {
        return k >= static_cast<std::ptrdiff_t>(line.begin) && k < static_cast<std::ptrdiff_t>(line.end);
    };
    for (; in_piece(i) && (points.p[static_cast<std::size_t>(i)] - corner).norm() < 4 * band; i -= step) {
        if ((points.p[static_cast<std::size_t>(i)] - corner).norm() > band) {
            inner.push_back(points.sigma[static_cast<std::size_t>(i)]);
        }
    }
    const double limit = 2 * quantile(inner, 0.5);
    for (i = std::clamp<std::ptrdiff_t>(i, 0, n - 1); i + step >= 0 && i + step < n; i += step) {
        const auto here = static_cast<std::size_t>(i), next = static_cast<std::size_t>(i + step);
        if ((points.p[next] - points.p[here]).norm() > band) {
            return foot_on(line, points.p[here]);
        }
        if (points.sigma[next] > limit && points.sigma[here] <= limit) {
            const double x = (1 / points.sigma[here] - 1 / limit) / (1 / points.sigma[here] - 1 / points.sigma[next]);
            return foot_on(line, points.p[here] + x * (points.p[next] - points.p[here]));
        }
    }
    return foot_on(line, points.p[static_cast<std::size_t>(i)]);
}

double half_step_of(const ProfileLine& line) {
    return 0.5 * line.length / static_cast<double>(line.end - line.begin);
}

ProfileFeature middle_of_ends(const ProfilePoints& points, const ProfileLine& a, const ProfileLine& b, double band) {
    return {0.5 * (end_of(points, a, true, band) + end_of(points, b, false, band)),
            std::hypot(std::max(half_step_of(a), half_step_of(b)), std::hypot(a.sigma, b.sigma)), turn(a, b)};
}

std::optional<ProfileFeature> groove_feature(const ProfilePoints& points, const std::vector<ProfileLine>& lines,
                                             double band) {
    const ProfileLine* first = sharpest(lines, 1);
    if (!first) {
        return std::nullopt;
    }
    const ProfileLine &a = first[0], &b = first[1];
    const bool apart = (points.p[b.begin] - points.p[a.end - 1]).norm() > 3 * band;
    return apart ? middle_of_ends(points, a, b, band) : corner_of(a, b);
}

/// The two neighbours that run side by side: with the largest step between them for a lap joint, the widest gap for a
/// butt joint. Null where there are none.
const ProfileLine* widest_apart(const ProfilePoints& points, const std::vector<ProfileLine>& lines, bool step,
                                double band) {
    const ProfileLine* best = nullptr;
    double most = band;
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
        const ProfileLine &a = lines[i], &b = lines[i + 1];
        const Vector2d gap = points.p[b.begin] - points.p[a.end - 1];
        const double apart = step ? std::abs(a.height(points.p[b.begin])) : gap.dot(a.direction);
        if (std::abs(turn(a, b)) < kLeastBend && apart > most) {
            most = apart;
            best = &a;
        }
    }
    return best;
}

/// The foot of the step, on the lower sheet: below what is seen of the step's wall clear of both sheets, or else below
/// the upper sheet's end.
std::optional<ProfileFeature> lap_feature(const ProfilePoints& points, const std::vector<ProfileLine>& lines,
                                          const ProfileScale& scale) {
    const ProfileLine* first = widest_apart(points, lines, true, scale.band);
    if (!first) {
        return corner_feature(lines, 1);  // the step's wall is a piece of its own
    }
    const ProfileLine &a = first[0], &b = first[1];
    const bool up = a.height(points.p[b.begin]) > 0;
    const ProfileLine &lower = up ? a : b, &upper = up ? b : a;
    std::vector<double> wall;  // along the lower sheet
    for (std::size_t i = a.end; i < b.begin; ++i) {
        if (lower.height(points.p[i]) > scale.band && upper.height(points.p[i]) < -scale.band) {
            wall.push_back(lower.direction.dot(points.p[i] - lower.middle));
        }
    }
    if (!wall.empty()) {
        const auto n = static_cast<double>(wall.size());
        const Vector2d foot = lower.middle + quantile(wall, 0.5) * lower.direction;
        const double across = scale.sigma * std::sqrt(std::max(1.0, scale.correlated / n));
        return ProfileFeature{foot, std::hypot(across, lower.sigma), turn(a, b)};
    }
    const Vector2d foot = foot_on(lower, end_of(points, upper, !up, scale.band));
    return ProfileFeature{foot, std::hypot(half_step_of(upper), lower.sigma), turn(a, b)};
}

}  // namespace

std::optional<ProfileFeature> find_feature(const ProfilePoints& points, const ProfileScale& scale, JointKind kind) {
    const std::vector<ProfileLine> lines = straight_pieces(points.p, scale);
    switch (kind) {
        case JointKind::lap:
            return lap_feature(points, lines, scale);
        case JointKind::butt: {
            const ProfileLine* first = widest_apart(points, lines, false, scale.band);
            return first ? std::optional(middle_of_ends(points, first[0], first[1], scale.band)) : std::nullopt;
        }
        case JointKind::v_groove:
            return groove_feature(points, lines, scale.band);
        case JointKind::corner:
            return corner_feature(lines, -1);
        default:
            return corner_feature(lines, 1);
    }
}

}  // namespace seampath
