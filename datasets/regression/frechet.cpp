#include "datasets/regression/frechet.hpp"

#include <algorithm>
#include <cmath>

#include "stages/error.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// Part of a segment, 0 to 1 along it; empty where low is above high.
struct Free {
    double low = 1, high = 0;
    bool empty() const { return low > high; }
};

/// The part of the segment from a to b that lies within `leash` of c.
Free free_part(const Vector3d& c, const Vector3d& a, const Vector3d& b, double leash) {
    const Vector3d d = b - a, w = a - c;
    const double dd = d.squaredNorm(), dw = d.dot(w), rest = w.squaredNorm() - leash * leash;
    if (dd == 0) {
        return rest <= 0 ? Free{0, 1} : Free{};
    }
    const double root = dw * dw - dd * rest;
    if (root < 0) {
        return {};
    }
    const double s = std::sqrt(root);
    const Free part{std::max(0.0, (-dw - s) / dd), std::min(1.0, (-dw + s) / dd)};
    return part;
}

/// What of `free` can be reached on a cell's far side: all of it from the side beside it, else what lies no further
/// back than the nearest reached place of the side opposite.
Free reached(Free free, const Free& beside, const Free& opposite) {
    if (!beside.empty()) {
        return free;
    }
    if (opposite.empty()) {
        return {};
    }
    free.low = std::max(free.low, opposite.low);
    return free;
}

/// Whether a leash of this length is long enough. Cells go row by row; `below[i]` is what was reached of the lower side
/// of cell i of the row at work, on p's segment i, and `left` of the left side, on q's segment.
bool long_enough(const Points& p, const Points& q, double leash) {
    if ((p.front() - q.front()).norm() > leash || (p.back() - q.back()).norm() > leash) {
        return false;
    }
    std::vector<Free> below(p.size() - 1);
    for (std::size_t i = 0; i < below.size(); ++i) {  // along the edge of the diagram, without a gap from its corner
        const bool joined = i == 0 || (!below[i - 1].empty() && below[i - 1].high == 1);
        const Free free = free_part(q.front(), p[i], p[i + 1], leash);
        below[i] = joined && free.low == 0 ? free : Free{};
    }
    Free edge{0, 1};
    for (std::size_t j = 0; j + 1 < q.size(); ++j) {
        const Free first = free_part(p.front(), q[j], q[j + 1], leash);
        edge = !edge.empty() && edge.high == 1 && first.low == 0 ? first : Free{};
        Free left = edge;
        for (std::size_t i = 0; i < below.size(); ++i) {
            const Free right = reached(free_part(p[i + 1], q[j], q[j + 1], leash), below[i], left);
            below[i] = reached(free_part(q[j + 1], p[i], p[i + 1], leash), left, below[i]);
            left = right;
        }
        if (j + 2 == q.size()) {
            return !left.empty() && left.high == 1;
        }
    }
    return false;
}

}  // namespace

double frechet_distance(const Points& p, const Points& q) {
    ensure(p.size() >= 2 && q.size() >= 2, "both lines have two points");
    double low = std::max((p.front() - q.front()).norm(), (p.back() - q.back()).norm());
    // A little above what the ends need, whose own distance would be lost in rounding.
    double high = std::max(low * (1 + 1e-6), 1e-6);
    while (!long_enough(p, q, high)) {
        low = high;
        high *= 2;
    }
    while (high - low > std::max(1e-6, 1e-4 * high)) {
        const double middle = (low + high) / 2;
        (long_enough(p, q, middle) ? high : low) = middle;
    }
    return high;
}

}  // namespace seampath
