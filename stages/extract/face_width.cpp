#include "stages/extract/face_width.hpp"

#include <algorithm>
#include <limits>

namespace seampath::detail {

double face_width(const Surfels& surfels, const PointGrid& grid, Eigen::Vector3d p, Eigen::Vector3d d,
                  Eigen::Vector3d n, double most) {
    constexpr double kOff = 0.7;        // cells off the face that still are on it
    constexpr double kHole = 3;         // cells
    constexpr double kSameFace = 0.96;  // cosine of what a face may turn by within a neighbourhood
    const double cell = grid.cell();
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(cell);
    double width = 0;
    for (double u = cell; u < most && u <= width + kHole * cell; u += cell) {
        p += cell * d;
        const Surfel* on_face = nullptr;
        double nearest = std::numeric_limits<double>::infinity();
        grid.for_cells_in_box(p - half, p + half, [&](std::size_t j) {
            const Surfel& s = surfels.at[j];
            const Eigen::Vector3d v = s.p - p;
            if (s.n.squaredNorm() > 0 && std::abs(v.dot(n)) < kOff * cell && v.squaredNorm() < nearest) {
                nearest = v.squaredNorm();
                on_face = &s;
            }
        });
        if (!on_face) {
            continue;
        }
        width = u;
        const Eigen::Vector3d turned = on_face->n.dot(n) < 0 ? Eigen::Vector3d(-on_face->n) : on_face->n;
        if (turned.dot(n) > kSameFace) {
            n = (0.7 * n + 0.3 * turned).normalized();
            d = (d - d.dot(n) * n).normalized();
            p += 0.5 * (on_face->p - p).dot(n) * n;
        }
    }
    return width;
}

}  // namespace seampath::detail
