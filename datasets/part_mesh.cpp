#include "datasets/part_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"
#include "stages/geometry/parallel.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kStrips = 180;
constexpr int kBands = 64;  // rows of a picture that are drawn apart, on all processors

std::uint32_t add_vertex(PartMesh& mesh, const Vector3d& p) {
    mesh.vertices.push_back(p);
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

std::vector<Vector2d> circle_of(double radius) {
    std::vector<Vector2d> polygon;
    for (int i = 0; i < kStrips; ++i) {
        const double a = 2 * portable::kPi * i / kStrips;
        polygon.emplace_back(radius * portable::cos(a), radius * portable::sin(a));
    }
    return polygon;
}

Vector3d camera_ray(const Lens& lens, int column, int row) {
    return Vector3d((column + 0.5 - 0.5 * lens.width) / lens.focal_px, (row + 0.5 - 0.5 * lens.height) / lens.focal_px,
                    1)
        .normalized();
}

}  // namespace

void PartMesh::add(const PartMesh& other, const Isometry3d& pose) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const Vector3d& p : other.vertices) {
        vertices.push_back(pose * p);
    }
    for (const auto& f : other.faces) {
        faces.push_back({f[0] + first, f[1] + first, f[2] + first});
    }
}

std::array<Vector3d, 3> PartMesh::corners(std::size_t face) const {
    const auto& f = faces[face];
    return {vertices[f[0]], vertices[f[1]], vertices[f[2]]};
}

PartMesh prism_mesh(const std::vector<Vector2d>& polygon, double height, bool caps) {
    PartMesh mesh;
    const auto n = static_cast<std::uint32_t>(polygon.size());
    for (const double z : {0.0, height}) {
        for (const Vector2d& p : polygon) {
            add_vertex(mesh, {p.x(), p.y(), z});
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t k = (i + 1) % n;
        mesh.faces.push_back({i, k, k + n});
        mesh.faces.push_back({i, k + n, i + n});
    }
    for (std::uint32_t i = 1; caps && i + 1 < n; ++i) {
        mesh.faces.push_back({0, i + 1, i});
        mesh.faces.push_back({n, n + i, n + i + 1});
    }
    return mesh;
}

PartMesh block_mesh(const Vector3d& low, const Vector3d& high) {
    PartMesh mesh = prism_mesh({{low.x(), low.y()}, {high.x(), low.y()}, {high.x(), high.y()}, {low.x(), high.y()}},
                               high.z() - low.z());
    for (Vector3d& p : mesh.vertices) {
        p.z() += low.z();
    }
    return mesh;
}

PartMesh bar_mesh(double radius, double height) {
    return prism_mesh(circle_of(radius), height);
}

PartMesh ball_mesh(double radius) {
    PartMesh mesh;
    const int rings = kStrips / 2;
    for (int ring = 0; ring <= rings; ++ring) {
        const double b = portable::kPi * ring / rings;
        for (const Vector2d& p : circle_of(radius * portable::sin(b))) {
            add_vertex(mesh, {p.x(), p.y(), -radius * portable::cos(b)});
        }
    }
    for (int ring = 0; ring < rings; ++ring) {
        for (int i = 0; i < kStrips; ++i) {
            const auto at = [&](int r, int k) { return static_cast<std::uint32_t>(r * kStrips + k % kStrips); };
            mesh.faces.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
            mesh.faces.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
        }
    }
    return mesh;
}

Scan sampled_mesh(const PartMesh& mesh, std::size_t count, const std::string& name) {
    double area = 0;
    const auto twice = [&](std::size_t face) {
        const auto c = mesh.corners(face);
        return Vector3d((c[1] - c[0]).cross(c[2] - c[0]));
    };
    for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
        area += twice(i).norm() / 2;
    }
    Scan scan;
    scan.name = name;
    scan.format = "made";
    scan.unit_reason = "made in mm";
    const Random random(1, 950);
    double due = 0;
    std::uint64_t n = 0;
    for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
        const auto c = mesh.corners(i);
        const Vector3d cross = twice(i);
        for (due += cross.norm() / 2 / area * static_cast<double>(count); due >= 1; due -= 1, ++n) {
            double u = random.uniform(2 * n), v = random.uniform(2 * n + 1);
            if (u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            scan.points.push_back((c[0] + u * (c[1] - c[0]) + v * (c[2] - c[0])).cast<float>());
            scan.normals.push_back(cross.normalized().cast<float>());
        }
    }
    scan.points_in_file = scan.points.size();
    return scan;
}

std::string stl_of(const PartMesh& mesh) {
    static_assert(std::endian::native == std::endian::little);
    std::string bytes(80, ' ');
    const auto append = [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); };
    const auto count = static_cast<std::uint32_t>(mesh.faces.size());
    append(&count, sizeof count);
    for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
        const auto c = mesh.corners(i);
        const Eigen::Vector3f n = (c[1] - c[0]).cross(c[2] - c[0]).normalized().cast<float>();
        append(n.data(), 12);
        for (const Vector3d& p : c) {
            const Eigen::Vector3f f = p.cast<float>();
            append(f.data(), 12);
        }
        const std::uint16_t attribute = 0;
        append(&attribute, sizeof attribute);
    }
    return bytes;
}

Vector3d MeshView::ray(const Lens& lens, std::size_t pixel) const {
    const auto width = static_cast<std::size_t>(lens.width);
    return lens.world_from_camera.linear() *
           camera_ray(lens, static_cast<int>(pixel % width), static_cast<int>(pixel / width));
}

MeshView view_of(const PartMesh& mesh, const Lens& lens) {
    const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
    MeshView view{std::vector<double>(pixels, std::numeric_limits<double>::infinity()),
                  std::vector<std::int32_t>(pixels, -1)};
    const Isometry3d camera_from_world = lens.world_from_camera.inverse();
    std::vector<Vector3d> vertices;
    for (const Vector3d& p : mesh.vertices) {
        vertices.push_back(camera_from_world * p);
    }
    const auto draw = [&](std::size_t face, int first_row, int last_row) {
        const auto& f = mesh.faces[face];
        const Vector3d &a = vertices[f[0]], &b = vertices[f[1]], &c = vertices[f[2]];
        const Vector3d n = (b - a).cross(c - a);
        if (std::min({a.z(), b.z(), c.z()}) < 1) {
            return;  // behind the camera
        }
        const auto column = [&](const Vector3d& p) { return lens.focal_px * p.x() / p.z() + 0.5 * lens.width - 0.5; };
        const auto row = [&](const Vector3d& p) { return lens.focal_px * p.y() / p.z() + 0.5 * lens.height - 0.5; };
        const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({column(a), column(b), column(c)}))));
        const int x1 =
            std::min(lens.width - 1, static_cast<int>(std::floor(std::max({column(a), column(b), column(c)}))));
        const int y0 = std::max(first_row, static_cast<int>(std::ceil(std::min({row(a), row(b), row(c)}))));
        const int y1 = std::min(last_row, static_cast<int>(std::floor(std::max({row(a), row(b), row(c)}))));
        // A ray is within the triangle when it lies on the same side of the planes through the eye and each edge.
        const Vector3d ab = a.cross(b), bc = b.cross(c), ca = c.cross(a);
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                const Vector3d d = camera_ray(lens, x, y);
                const double u = ab.dot(d), v = bc.dot(d), w = ca.dot(d);
                const bool inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
                const double t = n.dot(a) / n.dot(d);
                const auto pixel =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(lens.width) + static_cast<std::size_t>(x);
                if (inside && t > 0 && t < view.depth[pixel]) {
                    view.depth[pixel] = t;
                    view.face[pixel] = static_cast<std::int32_t>(face);
                }
            }
        }
    };
    parallel_for(kBands, 1, [&](std::size_t band) {
        const int first = static_cast<int>(band) * lens.height / kBands,
                  last = (static_cast<int>(band) + 1) * lens.height / kBands - 1;
        for (std::size_t face = 0; face < mesh.faces.size(); ++face) {
            draw(face, first, last);
        }
    });
    return view;
}

}  // namespace seampath
