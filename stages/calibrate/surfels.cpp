#include "stages/calibrate/surfels.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/grid.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kSameSide = 0.5;            // cosine: points further turned belong to another face
constexpr std::size_t kFewestOfSurfel = 10;  // for six coefficients
constexpr std::size_t kMostOfSurfel = 96;    // more add nothing but time

// The side, of the six of a cube, that a direction points to.
std::uint64_t side_of(const Vector3d& n) {
    Eigen::Index axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    return static_cast<std::uint64_t>(2 * axis + (n[axis] < 0));
}

std::optional<Vector3d> sensor_of(const Scan& scan, const std::optional<Vector3d>& given) {
    if (given || scan.sensor_mm) {
        return given ? given : scan.sensor_mm;
    }
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        box.extend(scan.position(i));
    }
    // A sensor stands off what it sees by about its field of view or more.
    const bool clear = box.exteriorDistance(Vector3d::Zero()) > 0.3 * box.diagonal().norm();
    return clear ? std::optional(Vector3d(Vector3d::Zero())) : std::nullopt;
}

// Normal equations of a quadratic over the plane through `middle` with the axes of the columns: x^2, xy, y^2, x, y, 1.
Surfel quadric_through(const std::vector<Vector3d>& points, const Vector3d& middle, const Matrix3d& axes,
                       double radius) {
    using Six = Eigen::Matrix<double, 6, 1>;
    Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
    Six g = Six::Zero();
    const auto row_of = [](const Vector3d& l) {
        return (Six() << l.x() * l.x(), l.x() * l.y(), l.y() * l.y(), l.x(), l.y(), 1).finished();
    };
    double squares = 0;
    for (const Vector3d& p : points) {
        const Vector3d l = axes.transpose() * (p - middle) / radius;
        const Six row = row_of(l);
        H += row * row.transpose();
        g += l.z() * row;
    }
    // A trace of ridge on the curvature: points on a line leave it open, a plane then is the simplest.
    H.diagonal().head<3>().array() += 1e-6 * static_cast<double>(points.size());
    const Six c = H.ldlt().solve(g);
    for (const Vector3d& p : points) {
        const Vector3d l = axes.transpose() * (p - middle) / radius;
        squares += std::pow(l.z() - row_of(l).dot(c), 2);
    }
    const Vector3d normal = Vector3d(-c[3], -c[4], 1).normalized();
    Surfel s;
    s.p = middle + axes * Vector3d(0, 0, c[5] * radius);
    s.n = axes * normal;
    Matrix3d K = Matrix3d::Zero();
    K.topLeftCorner<2, 2>() << 2 * c[0], c[1], c[1], 2 * c[2];
    const Matrix3d across = Matrix3d::Identity() - s.n * s.n.transpose();
    s.K = normal.z() / radius * across * axes * K * axes.transpose() * across;
    s.rms = radius * std::sqrt(squares / static_cast<double>(points.size()));
    return s;
}

std::optional<Surfel> surfel_at(const SidedCloud& cloud, const PointGrid& grid, std::uint32_t seed, double radius) {
    const Vector3d at = cloud.points[seed].cast<double>(), side = cloud.sides[seed].cast<double>();
    std::vector<std::pair<double, Vector3d>> near;
    const Vector3d reach = Vector3d::Constant(radius);
    grid.for_cells_in_box(at - reach, at + reach, [&](std::size_t cell) {
        const auto points = grid.points(cell);
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Vector3d p = points[k].cast<double>();
            const double d2 = (p - at).squaredNorm();
            const Vector3f& other = cloud.sides[grid.source(grid.first_point(cell) + k)];
            if (d2 <= radius * radius && (!cloud.normals || other.cast<double>().dot(side) > kSameSide)) {
                near.emplace_back(d2, p);
            }
        }
    });
    if (near.size() < kFewestOfSurfel) {
        return std::nullopt;
    }
    std::vector<Vector3d> points;
    const std::size_t step = (near.size() + kMostOfSurfel - 1) / kMostOfSurfel;
    Vector3d mean = Vector3d::Zero();
    for (std::size_t i = 0; i < near.size(); i += step) {
        points.push_back(near[i].second);
        mean += near[i].second;
    }
    mean /= static_cast<double>(points.size());
    Matrix3d scatter = Matrix3d::Zero();
    for (const Vector3d& p : points) {
        scatter += (p - mean) * (p - mean).transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(scatter);
    Matrix3d axes;
    axes.col(2) = eigen.eigenvectors().col(0);
    if (axes.col(2).dot(side) < 0) {
        axes.col(2) = -axes.col(2);
    }
    axes.col(0) = eigen.eigenvectors().col(2);
    axes.col(1) = axes.col(2).cross(axes.col(0));
    Surfel s = quadric_through(points, mean, axes, radius);
    s.p += cloud.origin;
    return s;
}

}  // namespace

SidedCloud sided(const Scan& scan, const std::optional<Vector3d>& sensor_mm) {
    const bool normals = scan.normals.size() == scan.points.size() && !scan.points.empty() && !sensor_mm;
    const std::optional<Vector3d> sensor = normals ? std::nullopt : sensor_of(scan, sensor_mm);
    if (!normals && !sensor) {
        throw InputError("calibrate: " + scan.name +
                         ": nothing says from which side its surfaces were seen; normals, or sensor_mm in the nominal "
                         "file (about where the sensor stood in the frame of the scan) were needed");
    }
    std::vector<std::uint32_t> order(scan.points.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::lexicographical_compare(scan.points[a].begin(), scan.points[a].end(), scan.points[b].begin(),
                                            scan.points[b].end());
    });
    SidedCloud cloud;
    cloud.origin = scan.origin_mm;
    cloud.normals = normals;
    cloud.sensor = sensor;
    cloud.points.reserve(order.size());
    cloud.sides.reserve(order.size());
    for (const std::uint32_t i : order) {
        cloud.points.push_back(scan.points[i]);
        cloud.sides.push_back(normals ? scan.normals[i]
                                      : Vector3f((*sensor - scan.position(i)).normalized().cast<float>()));
    }
    return cloud;
}

std::vector<Surfel> surfels_of(const SidedCloud& cloud, double spacing, double radius) {
    const PointGrid cells(cloud.points, spacing), grid(cloud.points, radius);
    std::vector<std::uint32_t> seeds;
    for (std::size_t c = 0; c < cells.cells(); ++c) {
        const Vector3d mean = cells.mean(c);
        std::array<double, 6> best;
        std::array<std::int64_t, 6> seed;
        best.fill(std::numeric_limits<double>::infinity());
        seed.fill(-1);
        for (std::size_t k = cells.first_point(c); k < cells.first_point(c) + cells.points(c).size(); ++k) {
            const std::uint32_t i = cells.source(k);
            const double d2 = (cloud.points[i].cast<double>() - mean).squaredNorm();
            const std::size_t side = cloud.normals ? side_of(cloud.sides[i].cast<double>()) : 0;
            if (d2 < best[side]) {
                best[side] = d2;
                seed[side] = i;
            }
        }
        for (const std::int64_t i : seed) {
            if (i >= 0) {
                seeds.push_back(static_cast<std::uint32_t>(i));
            }
        }
    }
    std::vector<std::optional<Surfel>> found(seeds.size());
    parallel_for(seeds.size(), 64, [&](std::size_t i) { found[i] = surfel_at(cloud, grid, seeds[i], radius); });
    std::vector<Surfel> surfels;
    for (const auto& s : found) {
        if (s) {
            surfels.push_back(*s);
        }
    }
    return surfels;
}

std::vector<Surfel> smooth_ones(std::vector<Surfel> surfels, double factor, double allowed_mm) {
    std::vector<double> rms;
    for (const Surfel& s : surfels) {
        rms.push_back(s.rms);
    }
    const double most = std::max(allowed_mm, factor * quantile(rms, 0.5));
    std::erase_if(surfels, [&](const Surfel& s) { return s.rms > most; });
    return surfels;
}

std::vector<Surfel> thinned(const std::vector<Surfel>& surfels, double spacing) {
    std::vector<std::pair<std::array<std::int64_t, 4>, std::size_t>> keys;
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        const auto cell = [&](int axis) { return static_cast<std::int64_t>(std::floor(surfels[i].p[axis] / spacing)); };
        keys.push_back({{cell(2), cell(1), cell(0), static_cast<std::int64_t>(side_of(surfels[i].n))}, i});
    }
    std::sort(keys.begin(), keys.end());
    std::vector<Surfel> kept;
    for (std::size_t begin = 0; begin < keys.size();) {
        std::size_t end = begin;
        while (end < keys.size() && keys[end].first == keys[begin].first) {
            ++end;
        }
        kept.push_back(surfels[keys[(begin + end) / 2].second]);
        begin = end;
    }
    return kept;
}

template <class F>
void SurfelGrid::for_cells_about(const Vector3d& p, double reach, const F& f) const {
    const Vector3d at = p - low_, half = Vector3d::Constant(cell_ / 2);
    const Eigen::Array3i first = ((at.array() - reach) / cell_).floor().cast<int>().max(0);
    const Eigen::Array3i last = ((at.array() + reach) / cell_).floor().cast<int>().min(count_.array() - 1);
    for (int z = first.z(); z <= last.z(); ++z) {
        for (int y = first.y(); y <= last.y(); ++y) {
            for (int x = first.x(); x <= last.x(); ++x) {
                const Vector3d middle = cell_ * Vector3d(x, y, z) + half;
                const Vector3d beyond = ((at - middle).cwiseAbs() - half).cwiseMax(0);
                if (beyond.squaredNorm() <= reach * reach) {
                    f(index({x, y, z}));
                }
            }
        }
    }
}

SurfelGrid::SurfelGrid(std::span<const Surfel> surfels, double reach) {
    constexpr double kMostCells = 4e6;
    Eigen::AlignedBox3d box;
    for (const Surfel& s : surfels) {
        box.extend(s.p);
    }
    low_ = box.min() - Vector3d::Constant(reach);
    const Vector3d size = box.max() + Vector3d::Constant(reach) - low_;
    cell_ = std::max(0.7 * reach, std::cbrt(size.prod() / kMostCells));
    count_ = (size / cell_).array().floor().cast<int>() + 1;
    start_.assign(static_cast<std::size_t>(count_.prod()) + 1, 0);
    for (const Surfel& s : surfels) {
        for_cells_about(s.p, reach, [&](std::size_t c) { ++start_[c + 1]; });
    }
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    list_.resize(start_.back());
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        for_cells_about(surfels[i].p, reach, [&](std::size_t c) { list_[next[c]++] = static_cast<std::uint32_t>(i); });
    }
}

}  // namespace seampath::calibrating
