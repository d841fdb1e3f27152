#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "stages/geometry/camera.hpp"
#include "stages/geometry/quadric.hpp"
#include "stages/geometry/rigid.hpp"

/// What a camera and a laser plane are, from pictures of a flat board.
namespace seampath {

/// A point of a board (mm, in its plane) and where the camera sees it.
struct BoardSight {
    Eigen::Vector2d on_board;
    Eigen::Vector2d pixel;
};

struct BoardView {
    std::string name;
    std::vector<BoardSight> points;
};

struct CameraOptions {
    int width = 0;  ///< px
    int height = 0;
    double circle_radius_mm = 0;  ///< of a board of circles: what is seen is the middle of their image; 0 for corners
    double limit_percent = 0.1;   ///< largest 1-sigma of a focal length that passes
};

struct ViewResult {
    std::string name;
    int points = 0;
    int dropped = 0;         ///< points that lie far from where the others put them
    double rms_px = 0;       ///< of the points' distances
    double held_out_px = 0;  ///< the same with a camera that was calibrated without this view
    double tilt_rad = 0;     ///< between the board's normal and the camera's axis
    Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
};

/// Mean residual in a part of the picture.
struct ResidualCell {
    Eigen::Vector2d mean_px{0, 0};
    double rms_px = 0;
    int points = 0;
};

/// fx, fy, cx, cy, k1, k2, p1, p2, k3.
inline constexpr int kCameraNumbers = 9;
using CameraCovariance = Eigen::Matrix<double, kCameraNumbers, kCameraNumbers>;

struct CameraCalibration {
    static constexpr std::size_t kMapColumns = 8, kMapRows = 6;
    CameraModel camera;
    CameraCovariance covariance = CameraCovariance::Zero();  ///< in the order of kCameraNumbers; px and 1
    std::vector<ViewResult> views;
    std::array<ResidualCell, kMapColumns * kMapRows> map;  ///< row by row
    double rms_px = 0;
    double held_out_px = 0;
    double sigma_px = 0;              ///< 1-sigma of a point, along each axis
    std::vector<std::string> notes;   ///< a sentence each
    std::vector<std::string> faults;  ///< why it does not pass and what is missing, a sentence each
    bool pass() const { return faults.empty(); }
};

/// The camera and all views' poses by least squares of the distances in the picture (bundle adjustment; Z. Zhang, A
/// flexible new technique for camera calibration, IEEE PAMI 22(11), 2000, section 3.3). k3 stays 0 where the pictures
/// do not show one of three sigmas. Points five robust sigmas off are dropped. Throws InputError for fewer than 3
/// views, or views of fewer than 6 points.
CameraCalibration calibrate_camera(const std::vector<BoardView>& views, const CameraOptions& options);

/// Where one board is.
struct BoardPlace {
    Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
    Matrix6 covariance = Matrix6::Zero();  ///< as in stages/geometry/rigid.hpp, from the residuals
    double rms_px = 0;
};

/// Least squares of the distances in the picture. Throws InputError for fewer than 6 points.
BoardPlace locate_board(const CameraModel& camera, const BoardView& view, double circle_radius_mm);

/// A plane from four or more of its points that a person read off a picture. As so few residuals tell little, a reading
/// is taken to be good to a pixel at best. Throws InputError where the points are fewer, lie on one line, or do not fit
/// one plane to a hundredth of the picture.
BoardPlace locate_plane(const CameraModel& camera, const BoardView& points);

/// A point of a laser's line on a board.
struct LitPoint {
    Eigen::Vector2d pixel;
    Eigen::Vector2d normal;  ///< unit, across the line
    double sigma_px = 0;     ///< along it
};

struct LitView {
    std::string name;
    BoardPlace board;
    std::vector<LitPoint> points;
};

struct LitViewResult {
    std::string name;
    int points = 0;
    double rms_mm = 0;       ///< of the distances of its points from the plane
    double held_out_mm = 0;  ///< mean distance from a plane that was found without this view
};

struct LaserCalibration {
    Plane plane;                                           ///< camera's frame, mm; point: the middle of what was lit
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< turns about u and v through point, rad; shift, mm
    Eigen::Vector3d u, v;                                  ///< unit, in the plane
    double expanded_mm = 0;                                ///< largest error of 95 % where the laser was seen
    double nearest_mm = 0, furthest_mm = 0;                ///< depths where it was seen: where that holds
    double rms_mm = 0;
    std::vector<LitViewResult> views;
    std::vector<std::string> notes;
    std::vector<std::string> faults;
    bool pass() const { return faults.empty(); }
};

/// The plane of a laser from its lines on a board in several places: least squares of the lines' points, where their
/// rays meet the board, the boards moving within their own covariances. Throws InputError for fewer than 2 views, and
/// for lines that lie on one line.
LaserCalibration calibrate_laser(const CameraModel& camera, const std::vector<LitView>& views, double limit_mm);

}  // namespace seampath
