#include "pipeline/scan_input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/digest.hpp"
#include "pipeline/files.hpp"
#include "stages/depth/depth.hpp"
#include "stages/error.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/photo/photo.hpp"
#include "stages/picture/picture.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr std::size_t kMaxPictureBytes = std::size_t{1} << 30;

using Decoder = GreyImage (*)(std::string_view bytes, const std::string& name);

/// A picture of the camera's size.
GreyImage picture_of(const fs::path& file, const CameraModel& camera, Decoder decode = decode_picture) {
    GreyImage image = decode(read_file(file, kMaxPictureBytes, "read"), file.string());
    if (image.width != camera.width || image.height != camera.height) {
        throw InputError("read: " + file.string() + ": is " + std::to_string(image.width) + " x " +
                         std::to_string(image.height) + " pixels, but its camera has " + std::to_string(camera.width) +
                         " x " + std::to_string(camera.height) + "; the picture as the camera gave it was needed");
    }
    return image;
}

void check_not_black(const GreyImage& image, const fs::path& file) {
    // What a covered camera gives by its noise; cameras of 10 or 12 bits fill the lower ones of 16.
    const double black = image.white > 255 ? 0.001 * image.white : 0.02 * image.white;
    const double brightest = *std::max_element(image.value.begin(), image.value.end());
    if (brightest <= black) {
        throw InputError("read: " + file.string() + ": is black: its brightest pixel is " + shortest(brightest) +
                         " of " + shortest(image.white) + "; check the light, the lens cap and the exposure");
    }
}

StripeView stripe_view(const StripeCapture& capture, const std::vector<Profile>& profiles) {
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < profiles.size(); ++i) {
        if (!profiles[i].points.empty()) {
            shown.push_back(i);
        }
    }
    const std::size_t index = shown[shown.size() / 2];
    GreyImage image = picture_of(capture.images[index], capture.camera);
    Stripe stripe = find_stripes(image, 1).at(0);
    return {std::move(image), std::move(stripe), capture.camera, index};
}

ScanInput scan_of_stripes(const StripeCapture& capture, const fs::path& file) {
    ScanInput input;
    input.plane = capture.plane;
    input.base_from_camera = capture.base_from_camera;
    input.profiles.resize(capture.images.size());
    parallel_for(capture.images.size(), 1, [&](std::size_t i) {
        const GreyImage image = picture_of(capture.images[i], capture.camera);
        check_not_black(image, capture.images[i]);
        for (const Stripe& stripe : find_stripes(image, 1)) {
            input.profiles[i] = triangulate(stripe, capture.camera, capture.plane);
        }
    });
    if (std::all_of(input.profiles.begin(), input.profiles.end(), [](const Profile& p) { return p.points.empty(); })) {
        throw InputError("read: " + file.string() + ": none of its " + std::to_string(capture.images.size()) +
                         " pictures shows a laser line that crosses it from side to side; check the laser and the "
                         "exposure");
    }
    StripeScan stripes = scan_of_profiles(input.profiles, capture.base_from_camera, capture.camera.width);
    input.scan = std::move(stripes.scan);
    input.sigma_mm = std::move(stripes.sigma_mm);
    input.scan.format = "capture laser_stripe";
    input.stripe = stripe_view(capture, input.profiles);
    return input;
}

ScanInput scan_of_depths(const DepthCapture& capture) {
    const GreyImage image = picture_of(capture.image, capture.camera);
    if (image.white != 65535) {
        throw InputError("read: " + capture.image.string() +
                         ": has 8 bits a pixel; a depth image of 16 was needed: 256 " +
                         "steps of depth are too few to measure with");
    }
    if (std::all_of(image.value.begin(), image.value.end(), [](float grey) { return grey == 0; })) {
        throw InputError("read: " + capture.image.string() +
                         ": is black: no pixel has a depth; check the camera and its range");
    }
    ScanInput input;
    input.scan = scan_of_depth(image, capture.camera, capture.mm_per_unit, capture.base_from_camera).scan;
    input.scan.format = "capture depth";
    return input;
}

ScanInput scan_of_photo(const PhotoCapture& capture) {
    constexpr int kSide = 200;  // points: what a photograph covers is a plane anyway
    GreyImage image = picture_of(capture.image, capture.camera, decode_photograph);
    check_not_black(image, capture.image);
    ScanInput input;
    Eigen::Isometry3d camera_from_plane = capture.camera_from_plane;
    Matrix6 covariance = Matrix6::Zero();
    if (!capture.plane_points.points.empty()) {
        const BoardPlace place = locate_plane(capture.camera, capture.plane_points);
        camera_from_plane = place.camera_from_board;
        covariance = place.covariance;
    }
    const int step = std::max(1, std::max(image.width, image.height) / kSide);
    for (int row = 0; row < image.height; row += step) {
        for (int column = 0; column < image.width; column += step) {
            const Vector3d p = point_on_plane(capture.camera, camera_from_plane, Eigen::Vector2d(column, row));
            input.scan.points.push_back(p.cast<float>());
        }
    }
    input.scan.points_in_file = image.value.size();
    input.scan.format = "capture photo";
    input.scan.sensor_mm = camera_from_plane.inverse().translation();
    input.photo = PhotoView{std::move(image), capture.camera, camera_from_plane, covariance};
    return input;
}

/// Distance of p from the polyline of a seam's points; infinite beyond its open ends.
double distance_from(const Seam& seam, const Vector3d& p) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double nearest = kInfinity;
    bool beyond = false;
    const std::size_t n = seam.points.size(), pieces = n - (seam.closed ? 0 : 1);
    for (std::size_t i = 0; i < pieces; ++i) {
        const Vector3d a = seam.points[i].p, along = seam.points[(i + 1) % n].p - a;
        const double x = (p - a).dot(along) / along.squaredNorm();
        const double distance = (p - a - std::clamp(x, 0.0, 1.0) * along).norm();
        if (distance < nearest) {
            nearest = distance;
            beyond = !seam.closed && ((i == 0 && x < 0) || (i + 1 == pieces && x > 1));
        }
    }
    return beyond ? kInfinity : nearest;
}

std::string comparison(const ScanInput& input, const Seam& seam, std::size_t number) {
    constexpr double kSamePlace = 2;  // mm; further off it is another joint's
    double squares = 0, variances = 0;
    int met = 0;
    for (std::size_t i = 0; i < input.profiles.size(); ++i) {
        const auto point = find_seam_point(input.profiles[i], input.plane, seam.kind);
        const double off = point ? distance_from(seam, input.base_from_camera[i] * point->p) : kSamePlace;
        if (off < kSamePlace) {
            squares += off * off;
            variances += point->sigma_mm * point->sigma_mm;
            ++met;
        }
    }
    const std::string which = "seam " + std::to_string(number + 1) + ", measured profile by profile: ";
    if (met == 0) {
        return which + "no profile shows it";
    }
    const double rms = std::sqrt(squares / met), sigma = std::sqrt(variances / met);
    return which + fixed(rms, 3) + " mm rms from the cloud's in " + std::to_string(met) + " of " +
           std::to_string(input.profiles.size()) + " profiles, " + fixed(sigma, 3) + " mm expected" +
           (rms > 3 * sigma ? ": the two do not agree" : "");
}

}  // namespace

ScanInput read_scan(const fs::path& file, const ReadOptions& options) {
    if (!is_capture(file)) {
        ScanInput input;
        input.scan = read(file, options);
        return input;
    }
    const Capture capture = read_capture(file);
    ScanInput input;
    if (const auto* stripes = std::get_if<StripeCapture>(&capture)) {
        input = scan_of_stripes(*stripes, file);
    } else if (const auto* depth = std::get_if<DepthCapture>(&capture)) {
        input = scan_of_depths(*depth);
    } else {
        input = scan_of_photo(std::get<PhotoCapture>(capture));
    }
    input.scan.name = file.stem().string();
    input.scan.unit_reason = "a capture is in mm";
    return input;
}

Extraction extract_photo(const PhotoView& photo, JointChoice joint) {
    if (joint != JointChoice::automatic && joint != JointChoice::butt) {
        throw InputError("extract: a photograph was given with the joint " +
                         std::string(kJointChoiceNames[static_cast<std::size_t>(joint)]) +
                         "; it shows butt joints of flat sheets only; use --joint butt or auto, or a scan");
    }
    Extraction found;
    const Eigen::Vector2d middle(0.5 * photo.image.width, 0.5 * photo.image.height);
    const auto at = [&](const Eigen::Vector2d& p) { return point_on_plane(photo.camera, photo.camera_from_plane, p); };
    found.spacing_mm = (at(middle) - at(middle + Eigen::Vector2d::UnitX())).norm();
    found.orientation_reason = "the torch comes from the camera's side of the plane";
    const auto line = find_photo_line(photo.image);
    if (!line) {
        found.remarks.push_back("no line crosses the photograph from side to side");
        return found;
    }
    found.seams.push_back(seam_on_plane(*line, photo));
    found.remarks.push_back(
        "the seam was found in a photograph: the deviation is from the line's own edges in it, and "
        "tells nothing of heights, nor whether that line is the seam");
    return found;
}

std::string scan_sha256(const fs::path& file) {
    std::string own = sha256_of_file(file);
    if (!is_capture(file)) {
        return own;
    }
    std::vector<fs::path> images;
    try {
        images = images_of(read_capture(file));
    } catch (const InputError&) {
        return own;  // no scan of any run; what is wrong with it is told when it is read
    }
    std::string all = own;
    for (const fs::path& image : images) {
        all += sha256_of_file(image);
    }
    return sha256(all);
}

std::vector<std::string> compare_with_profiles(const ScanInput& input, const std::vector<Seam>& seams) {
    std::vector<std::string> sentences;
    for (std::size_t i = 0; !input.profiles.empty() && i < seams.size(); ++i) {
        sentences.push_back(comparison(input, seams[i], i));
    }
    return sentences;
}

}  // namespace seampath
