#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "stages/read/cloud.hpp"
#include "stages/read/source.hpp"

namespace seampath {

/// Triangles in the file's own unit; vertices may be NaN or infinite, indices are in range.
struct Mesh {
    std::string format;
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Eigen::Vector3d> normals;  ///< one per vertex, or any other number; used only without faces
    std::vector<std::array<std::uint32_t, 3>> faces;
};

/// Takes three numbers from the line that begins at byte `at`. Throws InputError when one is none; `needed` says what
/// was expected and what to do.
Eigen::Vector3d take_vector(const Source& source, std::size_t at, std::string_view line, const std::string& needed);

/// Largest side of the axis-parallel box of all finite vertices: a mesh has no stray returns. 0 for no vertices.
double largest_extent(const Mesh& mesh);

/// Of all faces that can be used, in the square of the file's unit.
double area(const Mesh& mesh);

/// Points on the faces, one per spacing^2 of area, with the normals of their faces; `spacing` in the file's unit. The
/// fractional rest of each face is carried on to the next, so that small faces get their share together. Point number n
/// is element n of the additive recurrence R2 (M. Roberts, "The unreasonable effectiveness of quasirandom sequences",
/// 2018), folded into the triangle: evenly spread, and the same on every run. Faces with a vertex that is not finite
/// are counted as dropped. A mesh without faces gives its vertices. Throws InputError for too many points, or none.
Cloud sample_mesh(const Source& source, const Mesh& mesh, double spacing);

}  // namespace seampath
