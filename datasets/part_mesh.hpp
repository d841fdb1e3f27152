#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "stages/types.hpp"

/// Parts as triangles, as a CAD program exports them, and how a camera sees them.
namespace seampath {

/// Triangles turn anticlockwise about their outward normal.
struct PartMesh {
    std::vector<Eigen::Vector3d> vertices;  ///< mm
    std::vector<std::array<std::uint32_t, 3>> faces;

    void add(const PartMesh& other, const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity());
    std::array<Eigen::Vector3d, 3> corners(std::size_t face) const;
};

PartMesh block_mesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// A polygon of the plane z = 0 (anticlockwise), drawn out to z = height. Without caps it is a sleeve. The caps are
/// fans about the first corner, which must see all others.
PartMesh prism_mesh(const std::vector<Eigen::Vector2d>& polygon, double height, bool caps = true);

/// A bar about z from 0 to height; 180 flat strips.
PartMesh bar_mesh(double radius, double height);

PartMesh ball_mesh(double radius);

/// Evenly spread points with normals, about `count` of them.
Scan sampled_mesh(const PartMesh& mesh, std::size_t count, const std::string& name);

/// Binary STL.
std::string stl_of(const PartMesh& mesh);

/// A pinhole camera: z ahead, x to the right, square pixels.
struct Lens {
    Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
    int width = 0, height = 0;
    double focal_px = 0;
};

/// What each pixel sees, row by row.
struct MeshView {
    std::vector<double> depth;       ///< mm along the pixel's ray; infinite where there is nothing
    std::vector<std::int32_t> face;  ///< of the mesh, or -1
    Eigen::Vector3d ray(const Lens& lens, std::size_t pixel) const;  ///< unit, world
};

MeshView view_of(const PartMesh& mesh, const Lens& lens);

}  // namespace seampath
