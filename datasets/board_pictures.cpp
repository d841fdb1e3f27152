#include "datasets/board_pictures.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/fixture_draws.hpp"
#include "datasets/portable_math.hpp"
#include "stages/board/board.hpp"
#include "stages/geometry/rigid.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

enum BoardStream : std::uint64_t { kBoardNoise = 970, kBoardPlaces };

/// What is printed: the squares or circles, and a white margin of one pitch.
class Print {
public:
    explicit Print(const Board& board) : board_(board) {
        const auto points = points_of(board);
        last_ = points.back();
        for (const Vector2d& p : points) {
            last_ = last_.cwiseMax(p);
        }
        const int squares = board.columns * board.rows;
        const int markers = board.kind == BoardKind::aruco     ? squares
                            : board.kind == BoardKind::charuco ? squares / 2
                                                               : 0;
        for (int i = 0; i < markers; ++i) {
            markers_.push_back(marker_cells(board.dictionary, board.first_marker + i));
        }
    }

    /// The corners of what is printed, from the frame's origin.
    Vector2d low() const { return Vector2d::Constant(-2 * board_.pitch_mm); }
    Vector2d high() const { return last_ + Vector2d::Constant(2 * board_.pitch_mm); }

    double grey(const Vector2d& p, const BoardLight& light) const {
        if ((p - low()).minCoeff() < 0 || (high() - p).minCoeff() < 0) {
            return light.ground;
        }
        return dark(p) ? light.black : light.white;
    }

private:
    bool dark(const Vector2d& p) const {
        if (board_.kind == BoardKind::circles) {
            return in_circle(p);
        }
        if (board_.kind == BoardKind::aruco) {
            const Vector2d q = p / board_.pitch_mm;
            const int column = static_cast<int>(std::floor(q.x())), row = static_cast<int>(std::floor(q.y()));
            return column >= 0 && row >= 0 && column < board_.columns && row < board_.rows &&
                   in_marker(row * board_.columns + column, q - Vector2d(column, row), 0);
        }
        // Squares begin one pitch before the first inner corner, with a dark one.
        const Vector2d q = p / board_.pitch_mm + Vector2d(1, 1);
        const int column = static_cast<int>(std::floor(q.x())), row = static_cast<int>(std::floor(q.y()));
        const bool chessboard = board_.kind == BoardKind::chessboard;
        const int columns = board_.columns + chessboard, rows = board_.rows + chessboard;
        if (column < 0 || row < 0 || column >= columns || row >= rows) {
            return false;
        }
        if ((column + row) % 2 == 0) {
            return true;
        }
        return !chessboard && in_marker((row * columns + column) / 2, q - Vector2d(column, row),
                                        0.5 * (1 - board_.size_mm / board_.pitch_mm));
    }

    bool in_circle(const Vector2d& p) const {
        const int row = static_cast<int>(std::lround(p.y() / board_.pitch_mm));
        const double first = std::abs(row % 2);
        const int column = static_cast<int>(std::lround((p.x() / board_.pitch_mm - first) / 2));
        const Vector2d centre(board_.pitch_mm * (2 * column + first), board_.pitch_mm * row);
        return row >= 0 && row < board_.rows && column >= 0 && column < board_.columns &&
               (p - centre).norm() < board_.size_mm / 2;
    }

    /// `at` in the square, 0 to 1, in which the marker begins at `margin`.
    bool in_marker(int number, const Vector2d& at, double margin) const {
        const MarkerCells& marker = markers_[static_cast<std::size_t>(number)];
        const double share = board_.size_mm / board_.pitch_mm;
        const Vector2d cell = (at - Vector2d::Constant(margin)) / share * marker.side;
        const auto column = static_cast<std::ptrdiff_t>(std::floor(cell.x())),
                   row = static_cast<std::ptrdiff_t>(std::floor(cell.y()));
        const bool inside = column >= 0 && row >= 0 && column < marker.side && row < marker.side;
        return inside && !marker.white[static_cast<std::size_t>(row * marker.side + column)];
    }

    Board board_;
    Vector2d last_;
    std::vector<MarkerCells> markers_;
};

/// Where the corners of all pixels lie on the board, row by row, one more than pixels each way.
std::vector<Vector2d> corners_on_board(const CameraModel& camera, const Isometry3d& camera_from_board) {
    const Isometry3d board_from_camera = camera_from_board.inverse();
    const Vector3d eye = board_from_camera.translation();
    std::vector<Vector2d> corners;
    for (int row = 0; row <= camera.height; ++row) {
        for (int column = 0; column <= camera.width; ++column) {
            const auto direction = direction_of(camera, Vector2d(column - 0.5, row - 0.5));
            const Vector3d ray = board_from_camera.linear() * direction.value_or(Vector3d::UnitZ());
            corners.push_back((eye - eye.z() / ray.z() * ray).head<2>());
        }
    }
    return corners;
}

/// Gaussian blur along rows (step 1) or columns (step width).
void blur(GreyImage& image, double sigma, bool along_rows) {
    const int reach = static_cast<int>(std::ceil(4 * sigma));
    std::vector<double> weight;
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) {
        weight.push_back(portable::exp(-0.5 * k * k / (sigma * sigma)));
        sum += weight.back();
    }
    const GreyImage sharp = image;
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            double grey = 0;
            for (int k = -reach; k <= reach; ++k) {
                grey += weight.begin()[k + reach] / sum *
                        (along_rows ? sharp.clamped(column + k, row) : sharp.clamped(column, row + k));
            }
            image.value[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                        static_cast<std::size_t>(column)] = static_cast<float>(grey);
        }
    }
}

}  // namespace

GreyImage draw_board(const Board& board, const CameraModel& camera, const Isometry3d& camera_from_board,
                     const BoardLight& light, std::uint64_t seed) {
    constexpr int kParts = 4;  // of a pixel, each way
    const Print print(board);
    const auto corners = corners_on_board(camera, camera_from_board);
    const auto corner = [&](int column, int row) {
        return corners[static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width + 1) +
                       static_cast<std::size_t>(column)];
    };
    GreyImage image{camera.width, camera.height, 255, {}};
    for (int row = 0; row < camera.height; ++row) {
        for (int column = 0; column < camera.width; ++column) {
            const Vector2d a = corner(column, row), b = corner(column + 1, row), c = corner(column, row + 1),
                           d = corner(column + 1, row + 1);
            double grey = 0;
            for (int i = 0; i < kParts * kParts; ++i) {
                const int part_row = i / kParts;
                const double x = (i % kParts + 0.5) / kParts, y = (part_row + 0.5) / kParts;
                grey += print.grey((1 - y) * ((1 - x) * a + x * b) + y * ((1 - x) * c + x * d), light);
            }
            image.value.push_back(static_cast<float>(grey / (kParts * kParts)));
        }
    }
    blur(image, light.blur_px, true);
    blur(image, light.blur_px, false);
    const Random noise(seed, kBoardNoise);
    for (std::size_t i = 0; i < image.value.size(); ++i) {
        const double grey = image.value[i] + light.noise * noise.normal(i);
        image.value[i] = static_cast<float>(std::clamp(std::floor(grey + 0.5), 0.0, 255.0));
    }
    return image;
}

std::vector<Isometry3d> board_places(const Board& board, const CameraModel& camera, int count, double tilt_deg,
                                     std::uint64_t seed) {
    Draws draws(seed, kBoardPlaces);
    const Print print(board);
    const Vector2d middle = 0.5 * (print.low() + print.high()), size = print.high() - print.low();
    // So near that it fills two thirds of the picture's height, or a little less.
    const double near = 1.5 * size.y() * camera.focal_px.y() / camera.height;
    std::vector<Isometry3d> places;
    for (int i = 0; i < count; ++i) {
        const double side = draws.uniform(0, 2 * portable::kPi), lean = draws.uniform(0.5, 1) * tilt_deg;
        const double roll = draws.uniform(-0.2, 0.2), z = draws.uniform(1, 1.3) * near;
        Isometry3d T = Isometry3d::Identity();
        T.linear() = (turn_by(portable::radians(lean) * Vector3d(portable::cos(side), portable::sin(side), 0)) *
                      turn_by(Vector3d(0, 0, roll)))
                         .toRotationMatrix();
        // The corners of the picture in turn.
        const Vector2d free = 0.5 * Vector2d(camera.width, camera.height) - 0.36 * size * camera.focal_px.x() / z;
        const Vector2d at(i % 2 == 0 ? -1 : 1, i / 2 % 2 == 0 ? -1 : 1);
        const Vector2d pixel = draws.uniform(0.4, 1) * at.cwiseProduct(free.cwiseMax(0));
        T.translation() = Vector3d(pixel.x() * z / camera.focal_px.x(), pixel.y() * z / camera.focal_px.y(), z) -
                          T.linear() * Vector3d(middle.x(), middle.y(), 0);
        places.push_back(T);
    }
    return places;
}

std::vector<Vector2d> line_on_board(const Board& board, const CameraModel& camera, const Isometry3d& camera_from_board,
                                    const Plane& laser) {
    const Print print(board);
    const Vector3d n = camera_from_board.linear().transpose() * laser.normal;  // the plane on the board: m.p = d
    const double d = laser.normal.dot(laser.point - camera_from_board.translation());
    const Vector2d m = n.head<2>();
    const Vector2d foot = d / m.squaredNorm() * m, along = Vector2d(-m.y(), m.x()).normalized();
    const double reach = (print.high() - print.low()).norm();
    std::vector<Vector2d> line;
    for (int k = -2000; k <= 2000; ++k) {
        const Vector2d p = foot + k / 2000.0 * reach * along;
        if ((p - print.low()).minCoeff() > 0 && (print.high() - p).minCoeff() > 0) {
            line.push_back(pixel_of(camera, camera_from_board * Vector3d(p.x(), p.y(), 0)));
        }
    }
    return line;
}

}  // namespace seampath
