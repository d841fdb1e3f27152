#pragma once

#include "stages/read/cloud.hpp"
#include "stages/read/mesh.hpp"
#include "stages/read/source.hpp"

/// One reader a format. Each throws InputError naming the byte or line; none allocates before the file has been shown
/// to hold that much.
namespace seampath {

/// PLY 1.0, ascii and both binaries. Takes x y z and, where all three are there, nx ny nz of element vertex; every
/// other property and element is walked over, so that a file cut short or followed by other bytes is refused.
Cloud read_ply(const Source& source);

/// The same file's faces (lists vertex_indices or vertex_index) as triangles; none, and no vertices, for a cloud.
Mesh read_ply_mesh(const Source& source);

/// PCD, ascii, binary and binary_compressed. Takes x y z and normal_x normal_y normal_z. A raster stays one; the sensor
/// is the file's VIEWPOINT where that is not the default, or the origin for a raster.
Cloud read_pcd(const Source& source);

/// Columns of numbers apart by blanks, commas or semicolons: x y z are the first three, or those that a header line
/// names. Normals are the columns nx ny nz of a header line, or the last three of six where all of them have length 1.
Cloud read_text(const Source& source);

/// Ascii and binary STL. The normals in the file are not used; those of the corners are.
Mesh read_stl(const Source& source);

/// Whether these bytes begin as an ascii STL does, or have the size that a binary one's header promises.
bool is_stl(std::string_view bytes);

/// Wavefront OBJ: v, vn and f with positive or negative indices; polygons become fans of triangles.
Mesh read_obj(const Source& source);

}  // namespace seampath
