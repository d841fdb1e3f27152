#pragma once

#include "stages/read/cloud.hpp"
#include "stages/read/source.hpp"

/// One reader a format. Each throws InputError naming the byte or line; none allocates before the file has been shown
/// to hold that much.
namespace seampath {

/// PLY 1.0, ascii and both binaries. Takes x y z and, where all three are there, nx ny nz of element vertex; every
/// other property and element is walked over, so that a file cut short or followed by other bytes is refused.
Cloud read_ply(const Source& source);

/// PCD, ascii, binary and binary_compressed. Takes x y z and normal_x normal_y normal_z. A raster stays one; the sensor
/// is the file's VIEWPOINT where that is not the default, or the origin for a raster.
Cloud read_pcd(const Source& source);

}  // namespace seampath
