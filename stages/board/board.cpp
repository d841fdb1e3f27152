#include "stages/board/board.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

/// Eight bits are all that OpenCV's detectors take; what a picture has more does not matter for finding the board.
cv::Mat eight_bits(const GreyImage& image) {
    cv::Mat mat(image.height, image.width, CV_8U);
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            mat.at<std::uint8_t>(row, column) =
                static_cast<std::uint8_t>(std::lround(255 * image.at(column, row) / image.white));
        }
    }
    return mat;
}

std::vector<SeenPoint> all_of(const Board& board, const std::vector<cv::Point2f>& pixels) {
    const auto points = points_of(board);
    std::vector<SeenPoint> seen;
    for (std::size_t i = 0; i < points.size() && pixels.size() == points.size(); ++i) {
        seen.push_back({points[i], Vector2d(pixels[i].x, pixels[i].y)});
    }
    return seen;
}

/// Of the two points that lie nearest to each other.
double nearest_distance(const std::vector<cv::Point2f>& pixels) {
    double nearest = INFINITY;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        for (std::size_t k = i + 1; k < pixels.size(); ++k) {
            nearest = std::min(nearest, cv::norm(pixels[i] - pixels[k]));
        }
    }
    return pixels.size() > 1 ? nearest : 0;
}

/// Sub-pixel corners (W. Foerstner and E. Guelch, 1987) in windows of `reach` pixels to all sides.
void refine(const cv::Mat& image, double reach, std::vector<cv::Point2f>& pixels) {
    const int size = std::max(2, static_cast<int>(reach));
    cv::cornerSubPix(image, pixels, {size, size}, {-1, -1},
                     {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 1e-3});
}

/// Whether the squares diagonal to the first corner are the dark ones, as the board's frame has them.
bool begins_dark(const GreyImage& image, const Board& board, const std::vector<cv::Point2f>& pixels) {
    const cv::Point2f first = pixels[0], x = 0.5F * (pixels[1] - first);
    const cv::Point2f y = 0.5F * (pixels[static_cast<std::size_t>(board.columns)] - first);
    const auto grey = [&](const cv::Point2f& p) {
        return image.clamped(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y)));
    };
    return grey(first + x + y) + grey(first - x - y) < grey(first + x - y) + grey(first - x + y);
}

std::vector<SeenPoint> chessboard(const GreyImage& picture, const cv::Mat& image, const Board& board) {
    std::vector<cv::Point2f> pixels;
    cv::findChessboardCornersSB(image, {board.columns, board.rows}, pixels,
                                cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY);
    if (!pixels.empty() && !begins_dark(picture, board, pixels)) {
        std::reverse(pixels.begin(), pixels.end());
    }
    if (!pixels.empty()) {  // the detector's own are drawn to the lighter side of tilted boards
        refine(image, 0.4 * nearest_distance(pixels), pixels);
    }
    return all_of(board, pixels);
}

/// Centre of a dark blob about `start`: of what its grey values lack to white, in the circle of half the distance to
/// the next blob. OpenCV's own is that of contours, which lie on whole pixels.
Vector2d dark_centre(const GreyImage& image, const Vector2d& start, double reach) {
    constexpr int kRounds = 3;
    Vector2d centre = start;
    for (int round = 0; round < kRounds; ++round) {
        float white = 0;
        Vector2d sum(0, 0);
        double dark = 0;
        const auto for_pixels = [&](const auto& f) {
            for (int row = static_cast<int>(centre.y() - reach); row <= centre.y() + reach; ++row) {
                for (int column = static_cast<int>(centre.x() - reach); column <= centre.x() + reach; ++column) {
                    if ((Vector2d(column, row) - centre).norm() <= reach) {
                        f(column, row, image.clamped(column, row));
                    }
                }
            }
        };
        std::vector<float> greys;
        for_pixels([&](int, int, float grey) { greys.push_back(grey); });
        std::sort(greys.begin(), greys.end());
        const float ink = greys[greys.size() / 20];
        white = greys[greys.size() - 1 - greys.size() / 20];
        for_pixels([&](int column, int row, float grey) {
            // Below a tenth of the contrast it is the paper's noise.
            const double lacks = white - grey > 0.1F * (white - ink) ? white - grey : 0;
            sum += lacks * Vector2d(column, row);
            dark += lacks;
        });
        if (!(dark > 0)) {
            return start;
        }
        centre = sum / dark;
    }
    return centre;
}

/// Whether a homography takes the board to the pixels, but for the lens: a grid that was read wrongly has points where
/// their neighbours belong.
bool lies_flat(const Board& board, const std::vector<cv::Point2f>& pixels) {
    constexpr double kLens = 0.3;  // of the distance of neighbours
    std::vector<cv::Point2f> flat, seen;
    for (const Vector2d& p : points_of(board)) {
        flat.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    }
    const cv::Mat H = cv::findHomography(flat, pixels);
    if (H.empty()) {
        return false;
    }
    cv::perspectiveTransform(flat, seen, H);
    double furthest = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        furthest = std::max(furthest, cv::norm(seen[i] - pixels[i]));
    }
    return furthest < kLens * nearest_distance(pixels);
}

std::vector<SeenPoint> circles(const GreyImage& image, const cv::Mat& mat, const Board& board) {
    cv::SimpleBlobDetector::Params params;
    params.maxArea = static_cast<float>(mat.total());
    params.minDistBetweenBlobs = 5;
    std::vector<cv::Point2f> pixels;
    const auto detector = cv::SimpleBlobDetector::create(params);
    const int grid = cv::CALIB_CB_ASYMMETRIC_GRID;
    // Clustering finds more boards, but is led astray by other blobs and by strong tilts.
    for (const int way : {grid, grid | cv::CALIB_CB_CLUSTERING}) {
        if (cv::findCirclesGrid(mat, {board.columns, board.rows}, pixels, way, detector) && lies_flat(board, pixels)) {
            break;
        }
        pixels.clear();
    }
    std::vector<SeenPoint> seen = all_of(board, pixels);
    std::vector<Vector2d> refined;
    for (const SeenPoint& point : seen) {
        double nearest = INFINITY;
        for (const SeenPoint& other : seen) {
            const double d = (other.pixel - point.pixel).norm();
            nearest = d > 0 && d < nearest ? d : nearest;
        }
        refined.push_back(dark_centre(image, point.pixel, 0.5 * nearest));
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
        seen[i].pixel = refined[i];
    }
    return seen;
}

std::vector<SeenPoint> charuco(const cv::Mat& image, const Board& board) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(board.dictionary);
    const auto pattern = cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.pitch_mm),
                                                         static_cast<float>(board.size_mm), dictionary);
    std::vector<int> markers, numbers;
    std::vector<std::vector<cv::Point2f>> corners;
    cv::aruco::detectMarkers(image, dictionary, corners, markers);
    std::vector<cv::Point2f> pixels;
    if (!markers.empty()) {
        cv::aruco::interpolateCornersCharuco(corners, markers, image, pattern, pixels, numbers);
    }
    const auto points = points_of(board);
    std::vector<SeenPoint> seen;
    if (!pixels.empty()) {  // once more: the corners are half a pixel off in some versions
        // Within the white about a corner, whose narrowest part is between two markers' corners.
        const double margin = 0.5 * (1 - board.size_mm / board.pitch_mm), side = nearest_distance(pixels);
        refine(image, 0.8 * margin * side, pixels);
    }
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        seen.push_back({points[static_cast<std::size_t>(numbers[i])], Vector2d(pixels[i].x, pixels[i].y)});
    }
    return seen;
}

double grey_at(const GreyImage& image, const Vector2d& p) {
    const int column = static_cast<int>(std::floor(p.x())), row = static_cast<int>(std::floor(p.y()));
    const double x = p.x() - column, y = p.y() - row;
    return (1 - y) * ((1 - x) * image.clamped(column, row) + x * image.clamped(column + 1, row)) +
           y * ((1 - x) * image.clamped(column, row + 1) + x * image.clamped(column + 1, row + 1));
}

/// How far beyond p, along n, black ends and white begins: what lacks to white within `reach` px tells it, whatever the
/// blur.
double edge_beyond(const GreyImage& image, const Vector2d& p, const Vector2d& n, double reach) {
    constexpr int kSteps = 16;
    std::array<double, 2 * kSteps + 1> grey;
    double sum = 0;
    for (int i = -kSteps; i <= kSteps; ++i) {
        grey[static_cast<std::size_t>(i + kSteps)] = grey_at(image, p + reach * i / kSteps * n);
        sum += grey[static_cast<std::size_t>(i + kSteps)] / (2 * kSteps + 1);
    }
    const double black = (grey[0] + grey[1] + grey[2]) / 3,
                 white = (grey[2 * kSteps] + grey[2 * kSteps - 1] + grey[2 * kSteps - 2]) / 3;
    return white > black ? reach * (1 - 2 * (sum - black) / (white - black)) : 0;
}

/// The corners where a marker's sides meet, each a line through the edges along it: a corner's own grey values are
/// drawn inwards by blur.
std::vector<Vector2d> marker_corners(const GreyImage& image, const std::vector<cv::Point2f>& pixels, double reach) {
    constexpr int kRounds = 3, kPlaces = 12;
    std::vector<Vector2d> corners;
    for (const cv::Point2f& p : pixels) {
        corners.emplace_back(p.x, p.y);
    }
    const Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    for (int round = 0; round < kRounds; ++round) {
        std::array<Vector2d, 4> at, along;
        for (std::size_t k = 0; k < 4; ++k) {
            const Vector2d from = corners[k], side = corners[(k + 1) % 4] - from, d = side.normalized();
            Vector2d n(d.y(), -d.x());
            n *= n.dot(from - middle) > 0 ? 1 : -1;
            Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
            Vector2d b(0, 0);
            for (int i = 0; i < kPlaces; ++i) {
                const double share = 0.15 + 0.7 * i / (kPlaces - 1);
                const Vector2d row(1, share - 0.5);
                A += row * row.transpose();
                b += edge_beyond(image, from + share * side, n, reach) * row;
            }
            const Vector2d c = A.inverse() * b;
            at[k] = from + 0.5 * side + c[0] * n;
            along[k] = side + c[1] * n;
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t before = (k + 3) % 4;
            Eigen::Matrix2d A;
            A << along[before], -along[k];
            corners[k] = at[before] + (A.inverse() * (at[k] - at[before])).x() * along[before];
        }
    }
    return corners;
}

std::vector<SeenPoint> aruco(const GreyImage& picture, const cv::Mat& image, const Board& board) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(board.dictionary);
    std::vector<int> markers;
    std::vector<std::vector<cv::Point2f>> found;
    cv::aruco::detectMarkers(image, dictionary, found, markers);
    const auto points = points_of(board);
    std::vector<SeenPoint> seen;
    for (std::size_t i = 0; i < markers.size(); ++i) {
        const int place = markers[i] - board.first_marker;
        if (place < 0 || place >= board.columns * board.rows) {
            continue;
        }
        // Within the black border, which is one cell wide, and the white between markers.
        const double side = nearest_distance(found[i]), cell = side / (dictionary->markerSize + 2),
                     white = side * (board.pitch_mm / board.size_mm - 1);
        const auto corners = marker_corners(picture, found[i], 0.5 * std::min(cell, white));
        for (std::size_t k = 0; k < 4; ++k) {
            seen.push_back({points[4 * static_cast<std::size_t>(place) + k], corners[k]});
        }
    }
    return seen;
}

}  // namespace

std::vector<SeenPoint> find_board(const GreyImage& image, const Board& board) {
    const cv::Mat mat = eight_bits(image);
    switch (board.kind) {
        case BoardKind::chessboard:
            return chessboard(image, mat, board);
        case BoardKind::charuco:
            return charuco(mat, board);
        case BoardKind::circles:
            return circles(image, mat, board);
        case BoardKind::aruco:
            return aruco(image, mat, board);
    }
    throw InternalError("every board can be looked for");
}

MarkerCells marker_cells(int dictionary, int number) {
    const auto markers = cv::aruco::getPredefinedDictionary(dictionary);
    if (number >= markers->bytesList.rows) {
        throw InputError("board: the dictionary " +
                         std::string(kMarkerDictionaryNames.at(static_cast<std::size_t>(dictionary))) + " has " +
                         std::to_string(markers->bytesList.rows) + " markers; the board needs more; name a larger one");
    }
    MarkerCells cells{markers->markerSize + 2, {}};
    cv::Mat mat;
    cv::aruco::drawMarker(markers, number, cells.side, mat, 1);
    for (int i = 0; i < cells.side * cells.side; ++i) {
        cells.white.push_back(mat.at<std::uint8_t>(i / cells.side, i % cells.side) > 0);
    }
    return cells;
}

}  // namespace seampath
