#include "stages/extract/creases.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Dense>

#include "stages/geometry/parallel.hpp"

namespace seampath::detail {
namespace {

constexpr int kTrials = 48;  // a half of the surfels on one plane: failure chance (1 - 1/8)^48 = 0.2 %
constexpr double kFailure = 0.002;
constexpr double kLeastCrease = 20 * std::numbers::pi / 180;
constexpr double kLeastPlaneShare = 0.15;  // of the neighbours, on each plane
constexpr double kMostUnexplained = 0.25;
constexpr double kFoldShare = 0.85;  // of a plane's surfels, on its own side of the crease

struct CreasePlane {
    Eigen::Vector3d n{0, 0, 0};
    double d = 0;  // n.x = d
    double distance(const Eigen::Vector3d& x) const { return std::abs(n.dot(x) - d); }
};

using Points = std::vector<Eigen::Vector3d>;

// Small counter-based generator: the same trials for the same surfel, whatever thread works on it.
std::uint32_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<std::uint32_t>((x ^ (x >> 31)) >> 16);
}

std::optional<CreasePlane> through(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                                   double least_area) {
    const Eigen::Vector3d n = (b - a).cross(c - a);
    const double area = n.norm();
    if (area < least_area) {
        return std::nullopt;
    }
    return CreasePlane{n / area, n.dot(a) / area};
}

// Trials after which a plane that holds `count` of `all` points has been missed with a chance of kFailure (Fischler &
// Bolles 1981).
int trials_enough(std::size_t count, std::size_t all) {
    const double share = static_cast<double>(count) / static_cast<double>(all), hit = share * share * share;
    return hit < 1 ? static_cast<int>(std::ceil(std::log(kFailure) / std::log1p(-hit))) : 1;
}

// The plane with most points within `tolerance`.
std::optional<CreasePlane> consensus_plane(const Points& x, double tolerance, double least_area, std::uint64_t stream) {
    std::optional<CreasePlane> best;
    std::size_t most = 3;
    int enough = kTrials;
    for (int trial = 0; trial < enough && x.size() > 3; ++trial) {
        const auto pick = [&](int k) {
            return mix(stream * 1000003 + static_cast<std::uint64_t>(trial) * 31 +
                       static_cast<std::uint64_t>(k) * 7919) %
                   x.size();
        };
        const auto plane = through(x[pick(1)], x[pick(2)], x[pick(3)], least_area);
        if (!plane) {
            continue;
        }
        std::size_t count = 0;
        for (const auto& q : x) {
            count += plane->distance(q) < tolerance;
        }
        if (count > most) {
            most = count;
            best = plane;
            enough = std::min(kTrials, trials_enough(count, x.size()));
        }
    }
    return best;
}

std::optional<CreasePlane> fitted(const Points& x) {
    if (x.size() < 4) {
        return std::nullopt;
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& q : x) {
        mean += q;
    }
    mean /= static_cast<double>(x.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& q : x) {
        scatter += (q - mean) * (q - mean).transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(scatter);
    const Eigen::Vector3d n = solver.eigenvectors().col(0);
    return CreasePlane{n, n.dot(mean)};
}

struct Split {
    CreasePlane plane[2];
    std::vector<std::size_t> member[2];  // indices into the points
    std::size_t unexplained = 0;
};

void assign(const Points& x, double tolerance, Split& split) {
    split.unexplained = 0;
    split.member[0].clear();
    split.member[1].clear();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double d0 = split.plane[0].distance(x[i]), d1 = split.plane[1].distance(x[i]);
        if (std::min(d0, d1) < tolerance) {
            split.member[d0 <= d1 ? 0 : 1].push_back(i);
        } else {
            ++split.unexplained;
        }
    }
}

std::optional<Split> two_planes(const Points& x, double radius, double tolerance, std::uint64_t stream) {
    const double least_area = 0.05 * radius * radius;
    const auto first = consensus_plane(x, tolerance, least_area, stream);
    if (!first) {
        return std::nullopt;
    }
    Points rest;
    rest.reserve(x.size());
    for (const auto& q : x) {
        if (first->distance(q) >= tolerance) {
            rest.push_back(q);
        }
    }
    const auto second = consensus_plane(rest, tolerance, least_area, stream + 1);
    if (!second) {
        return std::nullopt;
    }
    Split split{{*first, *second}, {}, 0};
    for (int round = 0; round < 4; ++round) {
        assign(x, 2 * tolerance, split);
        for (int k = 0; k < 2; ++k) {
            Points members;
            members.reserve(split.member[k].size());
            for (const std::size_t i : split.member[k]) {
                members.push_back(x[i]);
            }
            const auto plane = fitted(members);
            if (!plane) {
                return std::nullopt;
            }
            split.plane[k] = *plane;
        }
    }
    assign(x, 2 * tolerance, split);
    return split;
}

// Both planes well supported, bent enough, and each only on its own side of the line: a fold, no step and no crossing.
std::optional<Crease> as_crease(const Surfels& surfels, std::span<const std::uint32_t> neighbours, const Points& x,
                                const Split& split) {
    const Surfel& centre = surfels.at[neighbours.front()];
    const auto n = static_cast<double>(x.size());
    if (static_cast<double>(split.unexplained) > kMostUnexplained * n ||
        static_cast<double>(std::min(split.member[0].size(), split.member[1].size())) <
            std::max(6.0, kLeastPlaneShare * n)) {
        return std::nullopt;
    }
    Crease crease;
    Eigen::Vector3d normal[2], away[2];
    for (int k = 0; k < 2; ++k) {
        double sign = 0;
        for (const std::size_t i : split.member[k]) {
            sign += split.plane[k].n.dot(surfels.at[neighbours[i]].n);
        }
        normal[k] = sign < 0 ? -split.plane[k].n : split.plane[k].n;
    }
    const Eigen::Vector3d axis = normal[0].cross(normal[1]);
    if (axis.norm() < std::sin(kLeastCrease)) {
        return std::nullopt;
    }
    const Eigen::Vector3d t = axis.normalized();
    // Point of both planes nearest to the centre (points are relative to the surfel).
    Eigen::Matrix3d A;
    A << split.plane[0].n.transpose(), split.plane[1].n.transpose(), t.transpose();
    const Eigen::Vector3d foot = A.partialPivLu().solve(Eigen::Vector3d(split.plane[0].d, split.plane[1].d, 0));
    if (foot.norm() > 0.4 * surfels.radius) {
        return std::nullopt;
    }
    for (int k = 0; k < 2; ++k) {
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const std::size_t i : split.member[k]) {
            mean += x[i] - foot;
        }
        away[k] = split.plane[k].n.cross(t);
        away[k] *= mean.dot(away[k]) < 0 ? -1 : 1;
        std::size_t own_side = 0;
        for (const std::size_t i : split.member[k]) {
            own_side += (x[i] - foot).dot(away[k]) > -0.1 * surfels.radius;
        }
        if (static_cast<double>(own_side) < kFoldShare * static_cast<double>(split.member[k].size())) {
            return std::nullopt;
        }
    }
    const double side0 = away[0].dot(normal[1]), side1 = away[1].dot(normal[0]);
    if (side0 * side1 <= 0) {
        return std::nullopt;  // the two normals do not agree on the side of the air
    }
    crease.concave = side0 > 0;
    crease.p = centre.p + foot;
    crease.n1 = normal[0];
    crease.n2 = normal[1];
    crease.t = t;
    crease.piece = centre.piece;
    crease.side = centre.side;
    crease.weight = n - static_cast<double>(split.unexplained);
    return crease;
}

}  // namespace

std::vector<Crease> find_creases(const Surfels& surfels, const ScaleField& field) {
    std::vector<std::optional<Crease>> found(surfels.at.size());
    parallel_for(surfels.at.size(), 64, [&](std::size_t i) {
        const Surfel& s = surfels.at[i];
        // Means of cells are quieter than points, but noise is correlated: half of it is taken to remain. One of two
        // surfaces may be seen at a slant, and be noisier than the place as a whole.
        const double geometric = 0.025 * surfels.radius;
        const auto neighbours = surfels.neighbours[i];
        if (neighbours.size() < 20 || s.flatness < 0.75 * geometric) {
            return;
        }
        const double least = std::max(0.75 * field.at(s.p).noise, geometric);
        if (s.flatness < 0.75 * least) {
            return;
        }
        Points x;
        x.reserve(neighbours.size());
        for (const std::uint32_t j : neighbours) {
            x.push_back(surfels.at[j].p - s.p);
        }
        for (const double tolerance : {least, 2 * least}) {
            const auto split = two_planes(x, surfels.radius, tolerance, i);
            found[i] = split ? as_crease(surfels, neighbours, x, *split) : std::nullopt;
            if (found[i] || s.flatness < 0.75 * 2 * least) {
                return;
            }
        }
    });
    std::vector<Crease> creases;
    for (const auto& crease : found) {
        if (crease) {
            creases.push_back(*crease);
        }
    }
    return creases;
}

}  // namespace seampath::detail
