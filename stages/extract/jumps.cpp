#include "stages/extract/jumps.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector3d;

constexpr std::ptrdiff_t kPlacesAside = 3;  // places to each side of one that tell its line
constexpr std::ptrdiff_t kBeyond = 8;       // places before an end that tell how it goes on
constexpr double kOff = 3;                  // times as far off as the middle one of its neighbours is
constexpr double kLeastJump = 1.5;          // sigmas; nearer to the line nothing is off it
constexpr double kBreaks = 3;  // sigmas between an end and what leads there, and times what ends do elsewhere

// Of what is not along travel.
double across(const Vector3d& d, const TrackPoint& at) {
    return (d - d.dot(at.t) * at.t).norm();
}

// How far a place is off the quadratic, over the stations along its own direction, through the others.
double off_line(const TrackPoint& place, const std::vector<const TrackPoint*>& others) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero(), b = Eigen::Matrix3d::Zero();
    double reach = 0;
    for (const TrackPoint* other : others) {
        reach = std::max(reach, std::abs((other->section.p - place.section.p).dot(place.t)));
    }
    for (const TrackPoint* other : others) {
        const Vector3d d = other->section.p - place.section.p;
        const double x = d.dot(place.t) / std::max(reach, 1e-9);
        const Vector3d row(1, x, x * x);
        A += row * row.transpose();
        b += row * d.transpose();
    }
    return across(A.ldlt().solve(b).row(0).transpose(), place);
}

class Way {
public:
    Way(const std::vector<TrackPoint>& places, bool closed)
        : places_(places), closed_(closed), n_(static_cast<std::ptrdiff_t>(places.size())) {}

    bool has(std::ptrdiff_t i) const { return closed_ || (i >= 0 && i < n_); }
    const TrackPoint& at(std::ptrdiff_t i) const { return places_[static_cast<std::size_t>((i + n_) % n_)]; }

    // How far place i is off the line of those around it, of which place `without` is none.
    double off(std::ptrdiff_t i, std::ptrdiff_t without) const {
        std::vector<const TrackPoint*> others;
        for (std::ptrdiff_t k = i - kPlacesAside; k <= i + kPlacesAside; ++k) {
            if (k != i && k != without && has(k)) {
                others.push_back(&at(k));
            }
        }
        return off_line(at(i), others);
    }

    bool is_off(std::ptrdiff_t i) const {
        if (at(i).modelled || !has(i - kPlacesAside) || !has(i + kPlacesAside)) {
            return false;
        }
        std::vector<double> about;
        for (const std::ptrdiff_t k : {i - 2, i - 1, i + 1, i + 2}) {
            if (has(k - kPlacesAside) && has(k + kPlacesAside)) {
                about.push_back(off(k, i));
            }
        }
        return off(i, i) > std::max(kLeastJump * at(i).sigma, kOff * quantile(about, 0.5));
    }

private:
    const std::vector<TrackPoint>& places_;
    bool closed_;
    std::ptrdiff_t n_;
};

// How far place i is off what the places behind it, towards the middle of the way, lead to.
double off_course(const std::vector<TrackPoint>& way, std::ptrdiff_t i, std::ptrdiff_t inwards) {
    std::vector<const TrackPoint*> before;
    for (std::ptrdiff_t k = 1; k <= kBeyond; ++k) {
        before.push_back(&way[static_cast<std::size_t>(i + k * inwards)]);
    }
    return off_line(way[static_cast<std::size_t>(i)], before);
}

// Cuts the back of the way where it breaks off.
void cut_back(std::vector<TrackPoint>& way) {
    const auto n = static_cast<std::ptrdiff_t>(way.size());
    for (std::ptrdiff_t i = n - kBeyond / 2; i < n; ++i) {
        const double usual = off_course(way, i - 1, -1);
        if (off_course(way, i, -1) > kBreaks * std::max(way[static_cast<std::size_t>(i)].sigma, usual)) {
            way.resize(static_cast<std::size_t>(i));
            return;
        }
    }
}

}  // namespace

std::vector<TrackPoint> without_jumps(std::vector<TrackPoint> way, bool closed) {
    if (way.size() < 3 * static_cast<std::size_t>(kBeyond)) {
        return way;
    }
    if (!closed) {
        cut_back(way);
        std::reverse(way.begin(), way.end());
        cut_back(way);
        std::reverse(way.begin(), way.end());
    }
    const Way all(way, closed);
    std::vector<TrackPoint> kept;
    for (std::size_t i = 0; i < way.size(); ++i) {
        if (!all.is_off(static_cast<std::ptrdiff_t>(i))) {
            kept.push_back(way[i]);
        }
    }
    return kept;
}

}  // namespace seampath::detail
