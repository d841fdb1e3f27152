#include "stages/photo/photo.hpp"

#include <algorithm>
#include <cmath>

#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/photo/measure.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Rows and columns exchanged.
GreyImage transposed(const GreyImage& image) {
    GreyImage other{image.height, image.width, image.white, {}};
    other.value.resize(image.value.size());
    for (int r = 0; r < image.height; ++r) {
        for (int c = 0; c < image.width; ++c) {
            other.value[static_cast<std::size_t>(c) * static_cast<std::size_t>(image.height) +
                        static_cast<std::size_t>(r)] = image.at(c, r);
        }
    }
    return other;
}

int reduction_of(const GreyImage& image, double longest) {
    return std::max(1, static_cast<int>(std::lround(std::max(image.width, image.height) / longest)));
}

/// What the best line from left to right is worth in a small copy of the picture.
double worth_across(const GreyImage& image) {
    constexpr double kLongest = 400;  // px
    const detail::LineEvidence evidence(image, reduction_of(image, kLongest));
    return evidence.blocks() == 0 ? 0 : detail::choose_line(evidence).worth;
}

/// The line from left to right.
std::optional<PhotoLine> line_across(const GreyImage& image) {
    constexpr double kLongest = 800;  // px: a line of three pixels in a photograph of two thousand is still one
    constexpr double kLeastWorth = 0.7;
    const int reduction = reduction_of(image, kLongest);
    const detail::LineEvidence evidence(image, reduction);
    if (evidence.blocks() == 0) {
        return std::nullopt;
    }
    const detail::ChosenLine chosen = detail::choose_line(evidence);
    if (chosen.path.worth < kLeastWorth) {
        return std::nullopt;
    }
    const auto track = detail::track_line(image, evidence, chosen, reduction);
    PhotoLine line{detail::measure_line(image, track), 0, chosen.between_borders, chosen.worth, chosen.rival_worth};
    std::vector<double> widths;
    for (const detail::TrackPlace& place : track) {
        widths.push_back(place.width);
    }
    line.width_px = quantile(widths, 0.5);
    return line.points.size() < 4 ? std::nullopt : std::optional(line);
}

}  // namespace

std::optional<PhotoLine> find_photo_line(const GreyImage& image) {
    const GreyImage other = transposed(image);
    const bool across = worth_across(image) >= worth_across(other);
    auto line = line_across(across ? image : other);
    for (std::size_t i = 0; line && !across && i < line->points.size(); ++i) {
        PhotoPoint& point = line->points[i];
        point.p = point.p.reverse().eval();
        point.normal = point.normal.reverse().eval();
    }
    return line;
}

Seam seam_on_plane(const PhotoLine& line, const PhotoView& view) {
    const Eigen::Isometry3d& pose = view.camera_from_plane;
    const Vector3d out(0, 0, is_seen_from_above(pose) ? 1 : -1);
    Seam seam;
    seam.kind = JointKind::butt;
    for (const PhotoPoint& point : line.points) {
        const Vector3d p = point_on_plane(view.camera, pose, point.p);
        const Vector3d across = point_on_plane(view.camera, pose, point.p + point.normal) - p;
        Vector6 slope;  // of p across the seam, over the pose's six numbers
        for (int i = 0; i < 6; ++i) {
            const double unit = i < 3 ? 1e-2 : 1e-5;  // mm, rad
            const auto moved = displaced(pose, unit * Vector6::Unit(i), pose.translation());
            slope[i] = (point_on_plane(view.camera, moved, point.p) - p).dot(across.normalized()) / unit;
        }
        const double of_plane = std::sqrt(std::max(0.0, slope.dot(view.covariance * slope)));
        seam.points.push_back({p, out, out, std::hypot(across.norm() * point.sigma_px, of_plane), point.modelled});
    }
    const double whole = line.clarity + line.rival_clarity;
    seam.confidence = whole > 0 ? line.clarity / whole : 0;
    seam.kind_reason = "a line " + fixed(line.width_px, 0) + " px wide" +
                       (line.between_borders ? ", midway between two borders," : "") + " stands out by " +
                       fixed(line.clarity, 1) + " sigmas of texture, the next best elsewhere by " +
                       fixed(line.rival_clarity, 1);
    return seam;
}

}  // namespace seampath
