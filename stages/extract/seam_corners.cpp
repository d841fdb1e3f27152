#include "stages/extract/seam_corners.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "stages/angle.hpp"
#include "stages/geometry/lines.hpp"
#include "stages/text.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector3d;

// A seam that turns by less is bent; one that turns by more comes back.
constexpr double kLeastCorner = 15 * kDegree, kMostCorner = 165 * kDegree;

// Between normals of one flank from either side of a corner.
constexpr double kSameFlank = 4 * kDegree;

// Both ends' lines pass each other by no more than so many sigmas, or such a share of the reach.
constexpr double kMostSigmas = 4, kMostPassing = 0.1;

// Points of a piece between two corners.
constexpr std::size_t kFewestPoints = 6;

// Of a way somewhere on which the seam may end, as a share of the way: 1 / sqrt(12).
constexpr double kSigmaOfWay = 0.2887;

/// An end of a seam: 2 * seam, one more for its last point.
using EndNumber = std::size_t;

struct End {
    SeamPoint at;
    Vector3d out;  // unit, away from the seam
};

End seam_end(const Seam& seam, bool last) {
    const SeamPoint& at = last ? seam.points.back() : seam.points.front();
    return {at, (last ? 1 : -1) * at.n1.cross(at.n2).normalized()};
}

/// A corner between two ends.
struct Meeting {
    EndNumber a, b;
    Vector3d p;
    double sigma, turn;
};

bool same_flank(const SeamPoint& a, const SeamPoint& b) {
    const double least = std::cos(kSameFlank);
    return std::max({a.n1.dot(b.n1), a.n1.dot(b.n2), a.n2.dot(b.n1), a.n2.dot(b.n2)}) > least;
}

std::optional<Meeting> meeting(const End& a, const End& b, double reach) {
    const double turn = std::acos(std::clamp(-a.out.dot(b.out), -1.0, 1.0));
    if (turn < kLeastCorner || turn > kMostCorner || !same_flank(a.at, b.at)) {
        return std::nullopt;
    }
    const auto [along_a, along_b, corner] = nearest_of_lines(a.at.p, a.out, b.at.p, b.out);
    const double passing = std::abs((b.at.p - a.at.p).dot(a.out.cross(b.out).normalized()));
    const double sigma = std::hypot(a.at.sigma_mm, b.at.sigma_mm);
    if (std::max(std::abs(along_a), std::abs(along_b)) > reach ||
        passing > kMostSigmas * sigma + kMostPassing * reach) {
        return std::nullopt;
    }
    const double way = std::max({0.0, along_a, along_b});
    return Meeting{0, 0, corner, std::hypot(std::max(a.at.sigma_mm, b.at.sigma_mm), kSigmaOfWay * way), turn};
}

// Whether a third seam comes near to the corner: three surfaces meet there around the air. It may end a little earlier
// than those that meet.
bool has_third(const std::vector<Seam>& seams, const Meeting& met, double reach) {
    for (std::size_t s = 0; s < seams.size(); ++s) {
        const auto& points = seams[s].points;
        if (s != met.a / 2 && s != met.b / 2 && std::any_of(points.begin(), points.end(), [&](const SeamPoint& point) {
                return (point.p - met.p).norm() < 2 * reach;
            })) {
            return true;
        }
    }
    return false;
}

// Those of ends that meet no third.
std::vector<Meeting> meetings(const std::vector<Seam>& seams, double reach) {
    std::vector<Meeting> all;
    std::vector<int> times(2 * seams.size(), 0);
    const auto may_turn = [&](EndNumber end) {
        const Seam& seam = seams[end / 2];
        return seam.kind == JointKind::fillet && !seam.closed && seam.points.size() >= kFewestPoints;
    };
    for (EndNumber a = 0; a < times.size(); ++a) {
        for (EndNumber b = a + 1; b < times.size(); ++b) {
            if (!may_turn(a) || !may_turn(b)) {
                continue;
            }
            if (auto met = meeting(seam_end(seams[a / 2], a % 2 == 1), seam_end(seams[b / 2], b % 2 == 1), reach)) {
                met->a = a;
                met->b = b;
                ++times[a];
                ++times[b];
                all.push_back(*met);
            }
        }
    }
    std::erase_if(
        all, [&](const Meeting& met) { return times[met.a] > 1 || times[met.b] > 1 || has_third(seams, met, reach); });
    return all;
}

void reverse(Seam& seam) {
    std::reverse(seam.points.begin(), seam.points.end());
    for (SeamPoint& point : seam.points) {
        std::swap(point.n1, point.n2);
    }
}

// Without what lies beyond the corner or so near to it that it tells no direction.
void trim(std::vector<SeamPoint>& points, const Vector3d& corner, bool last) {
    constexpr double kNear = 0.1;
    while (points.size() > kFewestPoints) {
        const SeamPoint& end = last ? points.back() : points.front();
        const SeamPoint& next = last ? points[points.size() - 2] : points[1];
        const Vector3d step = end.p - next.p;
        if ((corner - end.p).dot(step) > kNear * step.squaredNorm()) {
            return;
        }
        points.erase(last ? points.end() - 1 : points.begin());
    }
}

/// Goes from seam to seam, as far as ends meet.
class Joiner {
public:
    Joiner(std::vector<Seam>& seams, const std::vector<Meeting>& met)
        : seams_(seams), met_(met), at_(2 * seams.size(), -1), taken_(seams.size(), 0) {
        for (std::size_t k = 0; k < met.size(); ++k) {
            at_[met[k].a] = at_[met[k].b] = static_cast<std::ptrdiff_t>(k);
        }
    }

    std::vector<Seam> join() {
        std::vector<Seam> result;
        for (std::size_t s = 0; s < seams_.size(); ++s) {
            if (taken_[s] == 0) {
                result.push_back(chain(first_end(2 * s)));
            }
        }
        return result;
    }

private:
    EndNumber beyond(EndNumber end) const {
        const Meeting& met = met_[static_cast<std::size_t>(at_[end])];
        return met.a == end ? met.b : met.a;
    }

    // Of the chain in which the seam is: the end at which nothing is met, or in a ring the seam's own.
    EndNumber first_end(EndNumber start) const {
        EndNumber end = start;
        while (at_[end] >= 0) {
            end = beyond(end) ^ 1;
            if (end == start) {
                break;
            }
        }
        return end;
    }

    Seam chain(EndNumber first) {
        if (at_[first] < 0 && at_[first ^ 1] < 0) {
            taken_[first / 2] = 1;
            return std::move(seams_[first / 2]);
        }
        Seam whole;
        whole.closed = at_[first] >= 0;
        std::string turns;
        EndNumber in = first;
        double confidence = 1;
        if (whole.closed) {
            add_corner(whole, first, turns);
        }
        while (true) {
            Seam& seam = seams_[in / 2];
            taken_[in / 2] = 1;
            if (in % 2 == 1) {
                reverse(seam);
            }
            whole.kind_reason = whole.points.size() <= 1 ? seam.kind_reason : whole.kind_reason;
            confidence = std::min(confidence, seam.confidence);
            trim_ends(seam, in);
            std::move(seam.points.begin(), seam.points.end(), std::back_inserter(whole.points));
            const EndNumber out = in ^ 1;
            if (at_[out] < 0 || beyond(out) == first) {
                break;
            }
            add_corner(whole, out, turns);
            in = beyond(out);
        }
        whole.confidence = confidence;
        whole.kind_reason += "; goes on round corners of " + turns + " deg";
        set_normals(whole);
        return whole;
    }

    void trim_ends(Seam& seam, EndNumber in) const {
        for (const EndNumber end : {in, in ^ 1}) {
            if (at_[end] >= 0) {
                trim(seam.points, met_[static_cast<std::size_t>(at_[end])].p, end != in);
            }
        }
    }

    void add_corner(Seam& whole, EndNumber end, std::string& turns) const {
        const Meeting& met = met_[static_cast<std::size_t>(at_[end])];
        whole.corners.push_back(whole.points.size());
        whole.points.push_back({met.p, {}, {}, met.sigma, false});
        turns += (turns.empty() ? "" : ", ") + fixed(met.turn / kDegree, 0);
    }

    static void set_normals(Seam& seam) {
        const std::size_t n = seam.points.size();
        for (const std::size_t c : seam.corners) {
            const SeamPoint &before = seam.points[(c + n - 1) % n], &behind = seam.points[(c + 1) % n];
            seam.points[c].n1 = (before.n1 + behind.n1).normalized();
            seam.points[c].n2 = (before.n2 + behind.n2).normalized();
        }
    }

    std::vector<Seam>& seams_;
    const std::vector<Meeting>& met_;
    std::vector<std::ptrdiff_t> at_;  // number of the meeting of each end, or -1
    std::vector<char> taken_;
};

}  // namespace

void join_at_corners(std::vector<Seam>& seams, double reach) {
    const std::vector<Meeting> met = meetings(seams, reach);
    if (!met.empty()) {
        seams = Joiner(seams, met).join();
    }
}

}  // namespace seampath::detail
