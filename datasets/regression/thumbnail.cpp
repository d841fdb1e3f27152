#include "datasets/regression/thumbnail.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "pipeline/report_text.hpp"
#include "stages/geometry/bspline.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWide = 120, kHigh = 80, kRim = 4;  // CSS pixels
constexpr std::size_t kDots = 350;
constexpr int kPieces = 60;  // of a seam

/// From the scan's frame to the drawing.
class Projection {
public:
    explicit Projection(const std::vector<Vector3d>& points) {
        for (const Vector3d& p : points) {
            centre_ += p / static_cast<double>(points.size());
        }
        Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
        for (const Vector3d& p : points) {
            scatter += (p - centre_) * (p - centre_).transpose();
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
        across_ << solver.eigenvectors().col(2).transpose(), solver.eigenvectors().col(1).transpose();
        double x = 1e-9, y = 1e-9;
        for (const Vector3d& p : points) {
            const Vector2d q = across_ * (p - centre_);
            x = std::max(x, std::abs(q.x()));
            y = std::max(y, std::abs(q.y()));
        }
        scale_ = std::min((kWide / 2 - kRim) / x, (kHigh / 2 - kRim) / y);
    }

    std::string at(const Vector3d& p) const {
        const Vector2d q = scale_ * (across_ * (p - centre_)) + Vector2d(kWide, kHigh) / 2;
        return decimal(q.x(), 1) + " " + decimal(q.y(), 1);
    }

private:
    Vector3d centre_{0, 0, 0};
    Eigen::Matrix<double, 2, 3> across_;
    double scale_ = 1;
};

}  // namespace

std::string thumbnail_svg(const PartResult& part) {
    std::vector<Vector3d> dots;
    const std::size_t step = std::max<std::size_t>(1, part.scan.points.size() / kDots);
    for (std::size_t i = 0; i < part.scan.points.size(); i += step) {
        dots.push_back(part.scan.position(i));
    }
    std::string svg = "<svg class=\"thumb\" viewBox=\"0 0 " + decimal(kWide, 0) + " " + decimal(kHigh, 0) +
                      "\" role=\"img\" aria-label=\"scan and seams\">";
    if (dots.empty()) {
        return svg + "</svg>";
    }
    const Projection projection(dots);
    svg += "<path class=\"dots\" d=\"";
    for (const Vector3d& p : dots) {
        svg += "M" + projection.at(p) + "h0";
    }
    svg += "\"/>";
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        const CubicBSpline& curve = part.models[i].curve;
        const double first = first_parameter(curve), last = last_parameter(curve);
        svg += std::string("<path class=\"") + (part.deviations[i].pass ? "seam" : "seam out") + "\" d=\"";
        for (int k = 0; k <= kPieces; ++k) {
            svg += (k ? "L" : "M") + projection.at(position(curve, first + (last - first) * k / kPieces));
        }
        svg += "\"/>";
    }
    return svg + "</svg>";
}

}  // namespace seampath
