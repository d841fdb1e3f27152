#include "datasets/surface_scenes.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/fixture_draws.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

enum SurfaceStream : std::uint64_t { kSurfacePose = 930, kSurfaceView, kSurfaceClutter, kSurfaceNoise };

Isometry3d at(double x, double y, double z) {
    return Isometry3d(Eigen::Translation3d(x, y, z));
}

// About Z, then laid so that the mesh's z runs along `axis`.
Isometry3d laid(const Vector3d& origin, const Vector3d& axis) {
    Isometry3d T = at(origin.x(), origin.y(), origin.z());
    T.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
    return T;
}

PartMesh bracket_mesh() {
    PartMesh mesh = block_mesh({0, 0, 0}, {180, 120, 10});
    mesh.add(block_mesh({0, 0, 10}, {10, 120, 110}));
    mesh.add(prism_mesh({{10, 10}, {95, 10}, {10, 95}}, 8), laid({0, 38, 0}, -Vector3d::UnitY()));
    mesh.add(bar_mesh(18, 28), at(130, 85, 10));
    return mesh;
}

PartMesh node_mesh() {
    PartMesh mesh;
    mesh.add(bar_mesh(40, 260), laid({0, 0, 60}, Vector3d::UnitX()));
    mesh.add(bar_mesh(60, 14), laid({-14, 0, 60}, Vector3d::UnitX()));
    mesh.add(bar_mesh(25, 110), laid({95, 0, 80}, Vector3d(0.3, 0, 1).normalized()));
    mesh.add(block_mesh({160, -5, 95}, {220, 5, 150}));
    mesh.add(block_mesh({200, -45, 0}, {225, 45, 40}));
    return mesh;
}

PartMesh housing_mesh() {
    PartMesh mesh = block_mesh({0, 0, 0}, {160, 110, 60});
    mesh.add(block_mesh({10, 10, 60}, {60, 45, 88}));
    mesh.add(bar_mesh(22, 30), at(115, 70, 60));
    mesh.add(prism_mesh({{0, 0}, {40, 0}, {0, 45}}, 30), laid({160, 60, 0}, -Vector3d::UnitY()));
    return mesh;
}

PartMesh tee_mesh() {
    PartMesh mesh = block_mesh({-76, -25, 0}, {184, 25, 50});
    mesh.add(block_mesh({-25, -25, 50}, {25, 25, 241}));
    mesh.add(block_mesh({-45, -40, 241}, {45, 30, 249}));
    return mesh;
}

PartMesh wedge_mesh() {
    PartMesh mesh = prism_mesh({{0, 0}, {150, 0}, {190, 70}, {110, 130}, {20, 95}}, 65);
    mesh.add(prism_mesh({{0, 0}, {70, 0}, {0, 40}}, 45), laid({60, 75, 65}, -Vector3d::UnitY()));
    return mesh;
}

PartMesh hat_mesh() {
    PartMesh mesh = block_mesh({0, 0, 0}, {40, 220, 3});
    mesh.add(block_mesh({40, 0, 0}, {43, 220, 48}));
    mesh.add(block_mesh({43, 0, 45}, {100, 180, 48}));
    mesh.add(block_mesh({100, 0, 0}, {103, 220, 48}));
    mesh.add(block_mesh({103, 60, 0}, {135, 220, 3}));
    mesh.add(bar_mesh(14, 22), at(70, 130, 48));
    return mesh;
}

PartMesh flange_mesh() {
    PartMesh mesh = bar_mesh(70, 18);
    mesh.add(bar_mesh(38, 70), at(0, 0, 18));
    for (int i = 0; i < 4; ++i) {
        Isometry3d T = Isometry3d::Identity();
        T.linear() = Eigen::AngleAxisd(portable::kPi / 2 * i, Vector3d::UnitZ()).toRotationMatrix();
        mesh.add(block_mesh({60, -14, 0}, {95, 14, 18}), T);
    }
    return mesh;
}

PartMesh sheet_mesh() {
    PartMesh mesh;
    mesh.vertices = {{0, 0, 20}, {240, 0, 20}, {240, 180, 20}, {0, 180, 20}};
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

// Tiles, so that what lies behind the camera goes without the rest.
PartMesh table_mesh(const Vector3d& middle) {
    constexpr int kTiles = 16;
    constexpr double kTile = 250;
    PartMesh mesh;
    for (int i = -kTiles; i < kTiles; ++i) {
        for (int k = -kTiles; k < kTiles; ++k) {
            const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
            for (const Vector2d& corner :
                 {Vector2d(i, k), Vector2d(i + 1, k), Vector2d(i + 1, k + 1), Vector2d(i, k + 1)}) {
                mesh.vertices.push_back(middle + kTile * Vector3d(corner.x(), corner.y(), 0));
            }
            mesh.faces.push_back({n, n + 1, n + 2});
            mesh.faces.push_back({n, n + 2, n + 3});
        }
    }
    return mesh;
}

// Blocks, pipes and balls about the part, a clamp over it, on a table.
PartMesh clutter_mesh(const Eigen::AlignedBox3d& box, Draws& draws) {
    const double radius = box.diagonal().head<2>().norm() / 2;
    const Vector3d middle(box.center().x(), box.center().y(), 0);
    PartMesh mesh = table_mesh(middle);
    for (int i = 0; i < 14; ++i) {
        const double a = draws.uniform(0, 2 * portable::kPi), r = radius * draws.uniform(1.35, 2.6);
        Isometry3d T = at(middle.x() + r * portable::cos(a), middle.y() + r * portable::sin(a), 0);
        T.linear() = Eigen::AngleAxisd(draws.uniform(0, 6), Vector3d::UnitZ()).toRotationMatrix();
        const Vector3d size(draws.uniform(15, 0.45 * radius), draws.uniform(15, 0.45 * radius),
                            draws.uniform(10, 0.7 * radius));
        if (i % 3 == 0) {
            mesh.add(bar_mesh(size.x() / 2, size.z()), T);
        } else if (i % 3 == 1) {
            mesh.add(block_mesh({-size.x() / 2, -size.y() / 2, 0}, {size.x() / 2, size.y() / 2, size.z()}), T);
        } else {
            T.translation().z() = size.x() / 2;
            mesh.add(ball_mesh(size.x() / 2), T);
        }
    }
    const double x = draws.uniform(box.min().x(), box.max().x());
    mesh.add(
        block_mesh({x - 8, box.min().y() - 20, box.max().z() + 15}, {x + 8, box.max().y() + 20, box.max().z() + 30}));
    return mesh;
}

// Looks at `target` from a place so high and so far that the part is not much smaller at its far end.
Lens lens_at(const Vector3d& target, double distance, double azimuth, double elevation, int width, int height,
             double focal) {
    const Vector3d up(portable::cos(azimuth) * portable::cos(elevation),
                      portable::sin(azimuth) * portable::cos(elevation), portable::sin(elevation));
    Lens lens{at(0, 0, 0), width, height, focal};
    lens.world_from_camera.translation() = target + distance * up;
    const Vector3d z = -up, x = z.cross(Vector3d::UnitZ()).normalized();
    lens.world_from_camera.linear() << x, z.cross(x), z;
    return lens;
}

double share_of(const MeshView& view, std::size_t part_faces) {
    const auto on = std::count_if(view.face.begin(), view.face.end(),
                                  [&](std::int32_t f) { return f >= 0 && static_cast<std::size_t>(f) < part_faces; });
    return static_cast<double>(on) / static_cast<double>(view.face.size());
}

double seen_area(const PartMesh& mesh, std::size_t part_faces, const Lens& lens, const MeshView& view) {
    double seen = 0, all = 0;
    for (std::size_t i = 0; i < part_faces; ++i) {
        const auto c = mesh.corners(i);
        all += (c[1] - c[0]).cross(c[2] - c[0]).norm() / 2;
    }
    for (std::size_t i = 0; i < view.face.size(); ++i) {
        if (view.face[i] >= 0 && static_cast<std::size_t>(view.face[i]) < part_faces) {
            const auto c = mesh.corners(static_cast<std::size_t>(view.face[i]));
            const Vector3d d = view.ray(lens, i), n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
            const double ahead = d.dot(lens.world_from_camera.linear().col(2)), t = view.depth[i];
            seen += t * t * ahead * ahead * ahead / (lens.focal_px * lens.focal_px * std::abs(n.dot(d)));
        }
    }
    return seen / all;
}

}  // namespace

PartMesh part_mesh(FixturePart part) {
    switch (part) {
        case FixturePart::bracket:
            return bracket_mesh();
        case FixturePart::node:
            return node_mesh();
        case FixturePart::housing:
            return housing_mesh();
        case FixturePart::tee:
            return tee_mesh();
        case FixturePart::wedge:
            return wedge_mesh();
        case FixturePart::hat:
            return hat_mesh();
        case FixturePart::sheet:
            return sheet_mesh();
        case FixturePart::pipe: {
            PartMesh mesh;
            mesh.add(bar_mesh(32, 220), laid({0, 0, 32}, Vector3d::UnitX()));
            return mesh;
        }
        case FixturePart::sleeve: {
            PartMesh mesh;
            mesh.add(prism_mesh({{0, 0}, {80, 0}, {80, 12}, {12, 12}, {12, 60}, {0, 60}}, 240, false),
                     laid({0, 0, 80}, Vector3d::UnitY()));
            return mesh;
        }
        case FixturePart::ball: {
            PartMesh mesh;
            mesh.add(ball_mesh(60), at(0, 0, 60));
            return mesh;
        }
        case FixturePart::cuboid:
            return block_mesh({0, 0, 0}, {160, 100, 60});
        case FixturePart::flange:
            return flange_mesh();
    }
    return {};
}

SurfaceScan make_surface_scan(const SurfaceScene& scene, std::uint64_t seed) {
    Draws placing(seed, kSurfacePose), viewing(seed, kSurfaceView), clutter(seed, kSurfaceClutter);
    PartMesh world = part_mesh(scene.part);
    const std::size_t part_faces = world.faces.size();
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : world.vertices) {
        box.extend(p);
    }
    world.add(clutter_mesh(box, clutter));
    const double drawn = std::floor(viewing.uniform(0, 4)), quarter = scene.quarter.value_or(drawn);
    const double distance = 3.5 * box.diagonal().norm(),
                 azimuth = portable::radians(90 * quarter + viewing.uniform(20, 70)),
                 elevation = portable::radians(viewing.uniform(35, 60));
    const Lens coarse =
        lens_at(box.center(), distance, azimuth, elevation, scene.width / 4, scene.height / 4, scene.width / 4.0);
    const double first = share_of(view_of(world, coarse), part_faces);
    const Lens lens = lens_at(box.center(), distance, azimuth, elevation, scene.width, scene.height,
                              scene.width * std::sqrt(scene.share / first));
    const MeshView view = view_of(world, lens);
    SurfaceScan result;
    result.made.base_from_part = placing.pose(800);
    const Isometry3d& T = result.made.base_from_part;
    Scan& scan = result.made.scan;
    scan.name = "scan";
    scan.format = "made";
    scan.unit_reason = "made in mm";
    scan.origin_mm = T.translation();
    scan.sensor_mm = T * lens.world_from_camera.translation();
    const Random noise(seed, kSurfaceNoise);
    for (std::size_t i = 0; i < view.face.size(); ++i) {
        if (view.face[i] >= 0) {
            const Vector3d p = lens.world_from_camera.translation() +
                               (view.depth[i] + scene.sigma_mm * noise.normal(i)) * view.ray(lens, i);
            scan.points.push_back((T * p - scan.origin_mm).cast<float>());
            result.of_part.push_back(static_cast<std::size_t>(view.face[i]) < part_faces);
        }
    }
    scan.points_in_file = scan.points.size();
    result.on_part = share_of(view, part_faces);
    result.part_seen = seen_area(world, part_faces, lens, view);
    return result;
}

Scan golden_scan(const SurfaceScan& seen) {
    const Isometry3d back = seen.made.base_from_part.inverse();
    Scan golden = seen.made.scan;
    golden.name = "golden";
    golden.origin_mm.setZero();
    golden.sensor_mm = back * *seen.made.scan.sensor_mm;
    golden.points.clear();
    for (std::size_t i = 0; i < seen.of_part.size(); ++i) {
        if (seen.of_part[i]) {
            golden.points.push_back((back * seen.made.scan.position(i)).cast<float>());
        }
    }
    golden.points_in_file = golden.points.size();
    return golden;
}

}  // namespace seampath
