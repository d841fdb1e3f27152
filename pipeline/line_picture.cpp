#include "pipeline/line_picture.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "pipeline/report_text.hpp"

namespace seampath {
namespace {

constexpr double kPictureMargin = 6;  // CSS pixels

/// Rows: across and up in the picture.
using PicturePlane = Eigen::Matrix<double, 2, 3>;

/// Seen from above rather than from below, and with x or y to the right rather than to the left.
PicturePlane nearest_plane(std::span<const PictureLine> lines) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (const PictureLine& line : lines) {
        for (const Eigen::Vector3d& p : line.points) {
            sum += p;
            ++count;
        }
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const PictureLine& line : lines) {
        for (const Eigen::Vector3d& p : line.points) {
            const Eigen::Vector3d d = p - sum / std::max(count, 1.0);
            spread += d * d.transpose();
        }
    }
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
    Eigen::Vector3d across = axes.col(2), toward = axes.col(0);
    across *= across.sum() < 0 ? -1 : 1;
    toward *= toward.z() < 0 ? -1 : 1;
    PicturePlane plane;
    plane << across.transpose(), toward.cross(across).transpose();
    return plane;
}

}  // namespace

std::string line_picture(std::span<const PictureLine> lines, double width, double height, std::string_view title) {
    const PicturePlane plane = nearest_plane(lines);
    Eigen::AlignedBox2d box;
    for (const PictureLine& line : lines) {
        for (const Eigen::Vector3d& p : line.points) {
            box.extend(plane * p);
        }
    }
    std::string svg = "<svg class=\"picture\" role=\"img\" width=\"" + decimal(width, 0) + "\" height=\"" +
                      decimal(height, 0) + "\" viewBox=\"0 0 " + decimal(width, 0) + ' ' + decimal(height, 0) +
                      "\"><title>" + escape_html(title) + "</title>";
    if (box.isEmpty()) {
        return svg + "</svg>";
    }
    const Eigen::Vector2d room(width - 2 * kPictureMargin, height - 2 * kPictureMargin);
    const double scale = room.cwiseQuotient(box.sizes().cwiseMax(1e-3)).minCoeff();
    for (const PictureLine& line : lines) {
        svg += "<path class=\"" + line.style + "\" d=\"";
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            const Eigen::Vector2d q = scale * (plane * line.points[i] - box.center());
            svg += (i == 0 ? 'M' : 'L') + decimal(width / 2 + q.x(), 1) + ' ' + decimal(height / 2 - q.y(), 1);
        }
        svg += "\"/>";
    }
    return svg + "</svg>";
}

}  // namespace seampath
