#include "stages/board/board.hpp"

#include <algorithm>
#include <cmath>

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
