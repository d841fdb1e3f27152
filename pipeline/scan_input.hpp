#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/capture_file.hpp"
#include "stages/extract/extract.hpp"
#include "stages/geometry/photo_view.hpp"
#include "stages/read/read.hpp"
#include "stages/types.hpp"

/// What a run begins with: a point cloud, or pictures that a capture file names.
namespace seampath {

/// One of the pictures of a laser line, with the line that was found in it: the middle one of those that show it.
struct StripeView {
    GreyImage image;
    Stripe stripe;
    CameraModel camera;
    std::size_t index = 0;  ///< of the picture
};

/// A scan and, when it came from a laser line, the profiles that it is made of.
struct ScanInput {
    Scan scan;
    std::vector<Profile> profiles;  ///< one a picture, in the camera's frame; empty for other scans
    std::vector<Eigen::Isometry3d> base_from_camera;
    LaserPlane plane;
    std::vector<float> sigma_mm;  ///< of each point where the sensor tells it; else empty
    std::optional<StripeView> stripe;
    std::optional<PhotoView> photo;  ///< the scan then holds where some of its pixels lie on the plane, and no heights
};

/// Reads the file and what it names. Throws InputError.
ScanInput read_scan(const std::filesystem::path& file, const ReadOptions& options);

/// The seam of a photograph of a flat joint, in the plane's frame; none is a result. Throws InputError where the joint
/// asked for is no butt joint.
Extraction extract_photo(const PhotoView& photo, JointChoice joint);

/// SHA-256 of the file; of a capture, of the file and all of its pictures. Throws InputError when one can't be read.
std::string scan_sha256(const std::filesystem::path& file);

/// How far each seam lies from the same seam measured profile by profile, one sentence a seam; empty without profiles.
std::vector<std::string> compare_with_profiles(const ScanInput& input, const std::vector<Seam>& seams);

}  // namespace seampath
