#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "stages/geometry/rigid.hpp"
#include "stages/types.hpp"

/// Where a part or fixture sits in the frame of a sensor or robot ("base"), from features whose nominal place on the
/// part is known; and what that is worth. Covariances of frames are in the order and axes of stages/geometry/rigid.hpp.
/// Nothing hangs on the order of features or points.
namespace seampath {

/// One number measured: how far `point` is from a plane of the part.
struct FrameRow {
    Eigen::Vector3d normal;  ///< unit, part frame
    double offset_mm = 0;    ///< of the plane: normal . q = offset
    Eigen::Vector3d point;   ///< base frame, mm
    double sigma_mm = 0;     ///< 1-sigma of the point along the normal, above 0
};

/// A place of the part, measured in all three directions.
struct FramePoint {
    Eigen::Vector3d nominal;     ///< part frame, mm
    Eigen::Vector3d measured;    ///< base frame, mm
    Eigen::Matrix3d covariance;  ///< of `measured`, mm^2, positive definite
};

/// A thing whose place on the part is known, e.g. a board, measured with all six of its numbers.
struct FramePose {
    Eigen::Isometry3d nominal;            ///< part from thing
    Eigen::Isometry3d measured;           ///< base from thing
    Matrix6 covariance;                   ///< of `measured`, positive definite
    std::vector<Eigen::Vector3d> places;  ///< on the thing, mm: where distances are told
};

/// A ball, touched point, datum plane or board. Features of level 0 settle as much of the frame as they can, those of
/// level 1 what is left, and so on (datum precedence, ISO 5459); features of one level are weighed by their sigmas. A
/// check feature settles nothing; how far it is off is reported.
struct FrameFeature {
    std::string name;
    int level = 0;
    bool check = false;
    std::vector<FramePoint> points;
    std::vector<FrameRow> rows;
    std::vector<FramePose> poses = {};
};

struct WorkPoint {
    std::string name;
    Eigen::Vector3d p;  ///< part frame, mm
};

/// What a direction that the features do not hold leads to: the calibration is refused, or keeps the nominal value.
enum class WeakDirection { refuse, freeze };

struct FrameOptions {
    double limit_mm = 0.1;     ///< largest expanded uncertainty at a work point that passes
    double weak_ratio = 1e-5;  ///< least share that the weakest direction has of the mean information
    WeakDirection weak = WeakDirection::refuse;
    int trials = 2000;  ///< of the Monte-Carlo, at least 1000
    std::uint64_t seed = 1;
};

/// How a feature agrees with the frame, and what the frame would be without it.
struct FeatureResult {
    std::string name;
    bool check = false;
    Eigen::Vector3d place{0, 0, 0};     ///< part frame, mm: the middle of what was measured of it
    double residual_mm = 0;             ///< rms of its distances
    double residual_sigma = 0;          ///< the same over their expected scatter: about 1 or below when all is well
    bool can_be_left_out = false;       ///< the others alone determine the frame
    double leave_one_out_mm = 0;        ///< largest shift of a work point when it is left out
    double without_p_value = 0;         ///< of the others' chi-squared without it; 1 when nothing is left to contradict
    Eigen::Vector3d shift_mm{0, 0, 0};  ///< in the part frame, where the others see it against its nominal place
};

/// A motion that the features do not hold, in the part frame: a shift along `direction`, or a turn about the axis
/// through `centre` along it, which shifts by `pitch_mm` a radian along it.
struct Weakness {
    bool turn = false;
    Eigen::Vector3d direction{0, 0, 1};
    Eigen::Vector3d centre{0, 0, 0};
    double pitch_mm = 0;
    double share = 0;  ///< of the mean information that it has
    std::string text;  ///< "shift along (0, 1, 0)"
};

struct WorkPointResult {
    std::string name;
    Eigen::Vector3d p{0, 0, 0};        ///< part frame, mm
    Eigen::Vector3d in_base{0, 0, 0};  ///< mm
    Eigen::Matrix3d covariance;        ///< base frame, mm^2, of the Monte-Carlo
    double expanded_mm = 0;            ///< the distance that 95 % of the trials keep (GUM Supplement 2)
};

struct FrameResult {
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
    Matrix6 covariance = Matrix6::Zero();
    std::vector<FeatureResult> features;
    std::vector<Weakness> weak;  ///< weakest first; empty when all six are held
    std::vector<WorkPointResult> work_points;
    int redundancy = 0;               ///< numbers measured beyond those needed
    double chi_squared = 0;           ///< over the redundancy about 1 when residuals are as large as the sigmas say
    double p_value = 1;               ///< of a chi-squared at least this large
    std::vector<std::string> moved;   ///< features, one of which was moved: without it the others agree
    std::vector<std::string> notes;   ///< what a reader should know, a sentence each
    std::vector<std::string> faults;  ///< why it does not pass, a sentence each
    bool pass() const { return faults.empty(); }
};

/// Least squares on SE(3), by level. Begins at `start`, or without one at the rigid motion through the points and the
/// poses' places. Throws InputError when there is no feature, a sigma is not above 0, or, without a start, fewer than 3
/// of them.
FrameResult calibrate_frame(std::vector<FrameFeature> features, const std::vector<WorkPoint>& work_points,
                            const FrameOptions& options, const std::optional<Eigen::Isometry3d>& start = {});

/// Three points in the order of the textbook: the first is the origin's, the second gives the direction of X, the third
/// the plane of X and Y, each as far as those before it leave it open. Nominal and measured, in the order given; the
/// rest are check points. Throws InputError for fewer than 3, and for three nominal points on a line.
std::vector<FrameFeature> three_point_features(const std::vector<std::string>& names,
                                               const std::vector<FramePoint>& points);

/// A ball seen in a scan.
struct FoundBall {
    Eigen::Vector3d centre;      ///< mm
    Eigen::Matrix3d covariance;  ///< mm^2
    double scale_mm = 0;         ///< robust 1-sigma of its points
    double free_radius_mm = 0;   ///< what a fit with free radius gives
    int points = 0;
};

/// Every ball of a known radius that the points show a cap of, whatever lies around, from the surest to the least sure.
std::vector<FoundBall> find_balls(const Scan& scan, double radius_mm);

struct NamedPoint {
    std::string name;
    Eigen::Vector3d p;  ///< mm
};

/// Which found ball is which nominal one, by their mutual distances. Throws InputError when fewer than three match,
/// when more than one assignment does within the tolerance, or when only the mirror image matches.
std::vector<std::optional<std::size_t>> match_balls(const std::vector<NamedPoint>& nominal,
                                                    const std::vector<Eigen::Vector3d>& found, double tolerance_mm);

/// A point that was touched on a datum plane.
struct TouchedPoint {
    Eigen::Vector3d nominal;   ///< where it was aimed at, part frame; only the start is taken from it
    Eigen::Vector3d measured;  ///< base frame, mm
    double sigma_mm = 0;       ///< 1-sigma along the plane's normal
};

/// A nominal plane of the part and what was touched on it.
struct DatumPlane {
    std::string name;
    Eigen::Vector3d normal;  ///< unit, part frame
    double offset_mm = 0;    ///< of the plane: normal . q = offset
    std::vector<TouchedPoint> touched;
};

/// Datum planes in the order of their precedence (3-2-1): the first settles as much as it can, the second what is left.
/// Throws InputError for fewer than 3, 2 and 1 points, and for planes that do not stand across each other.
FrameResult calibrate_planes(const std::vector<DatumPlane>& planes, const std::vector<WorkPoint>& work_points,
                             const FrameOptions& options);

/// How a scan is probed in place of touching.
struct ProbeOptions {
    Eigen::Isometry3d near = Eigen::Isometry3d::Identity();  ///< about base_from_part: within 5 degrees
    double patch_mm = 5;                                     ///< radius of what is taken of a plane about each place
    double search_mm = 10;  ///< most that the scan's plane may lie off its nominal place in `near`
};

/// What a scan shows of a datum plane about one of its places.
struct PlaneProbe {
    std::string plane;
    int points = 0;
    double scale_mm = 0;  ///< robust 1-sigma of them
    double sigma_mm = 0;  ///< of the place along the plane's normal
};

/// Sets where each place of the planes was met, and its sigma, by the scan's points about it: a robust plane through
/// the layer that holds most of them, whose error may be shared by neighbours. Planes, places and probes are in the
/// same order. Throws InputError where the scan shows too little of a plane, or another surface, and as
/// calibrate_planes.
std::vector<PlaneProbe> probe_planes(const Scan& scan, std::vector<DatumPlane>& planes, const ProbeOptions& options);

struct BestFitOptions {
    FrameOptions frame;
    double least_share = 0.15;                                         ///< of the nominal surface that the scan shows
    std::optional<Eigen::Vector3d> scan_sensor_mm, nominal_sensor_mm;  ///< about where they were seen from
    std::optional<Eigen::Isometry3d> near;  ///< about base_from_part: poses turned by 45 degrees from it, or shifted by
                                            ///< half the part's size, are none
};

/// A scan laid on a nominal surface. The features of `frame` are the surface's smooth faces.
struct BestFit {
    FrameResult frame;
    double scan_noise_mm = 0;      ///< robust 1-sigma of the scan about its own surface
    double scale_mm = 0;           ///< the same about the nominal surface
    double share_seen = 0;         ///< of the nominal surface
    std::size_t points_taken = 0;  ///< of the scan
    double correlation = 1;        ///< variance of the frame over that of independent points, the largest of six
};

/// The frame that lays a scan on a nominal surface, without a guess: poses by point-pair features, then point-to-plane
/// least squares with Tukey's biweight. Whatever else the scan shows may be around. The nominal surface is evenly
/// spread points with normals (a mesh that was sampled), or a golden scan, which needs `near`: it shows one side of the
/// part, which may look like another. Where the scan's sensor is known, only what it can see of the surface counts, and
/// a pose is none in which it sees past places of the surface that nothing hides. The covariance is that of clustered
/// errors (Liang and Zeger, Biometrika 73, 1986), so that neighbours may share theirs. Faults name the directions that
/// the surface does not hold, and poses that fit as well as the best. `frame.weak_ratio` is not used: a direction that
/// holds less than a five-hundredth of the mean information is held by errors of normals. Throws InputError when a
/// cloud is too small, nothing says from which side it was seen, or a golden scan lacks `near` or the scan's sensor.
BestFit calibrate_surface(const Scan& scan, const Scan& nominal, const std::vector<WorkPoint>& work_points,
                          const BestFitOptions& options);

/// A nominal seam as a polyline.
struct NominalSeam {
    std::string name;
    bool closed = false;                  ///< the last point is joined to the first
    std::vector<Eigen::Vector3d> points;  ///< at least 2, part frame, mm
};

struct MeasuredSeamPoint {
    Eigen::Vector3d p;    ///< base frame, mm
    double sigma_mm = 0;  ///< 1-sigma across the seam, above 0
};

/// The frame in which measured seams lie on the nominal ones, without a guess: pairs of points with their tangents give
/// poses, then point-to-line least squares. Which measured seam is which nominal one follows from the pose; the
/// features are the nominal seams that something lies on. A point says nothing of where along its seam it is, so a
/// straight seam alone leaves its own direction and the turn about it open. Faults name another pose that fits as well.
/// Throws InputError for less than 4 measured points, a nominal seam without length, and when nothing fits.
FrameResult calibrate_seams(const std::vector<NominalSeam>& nominal,
                            const std::vector<std::vector<MeasuredSeamPoint>>& measured,
                            const std::vector<WorkPoint>& work_points, const FrameOptions& options);

}  // namespace seampath
