#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "stages/geometry/camera.hpp"
#include "stages/geometry/grey_image.hpp"
#include "stages/types.hpp"

/// Laser stripes in a picture, to a fraction of a pixel.
namespace seampath {

/// One point of the middle of a stripe.
struct StripePoint {
    Eigen::Vector2d p;       ///< px: x to the right, y down, from the middle of the first pixel
    Eigen::Vector2d normal;  ///< unit, across the stripe, downwards
    double width_px = 0;     ///< of the stripe at half of its height
    double sigma_px = 0;     ///< 1-sigma of p along the normal
};

/// At most one point a column, from left to right. Columns without one are gaps: nothing is filled in.
struct Stripe {
    std::vector<StripePoint> points;
    double contrast = 0;  ///< median height over what lies beside it, grey values
};

/// The middles of the brightest stripes that cross the picture from side to side, at most 60 degrees from its rows; at
/// most `count` of them, the brightest first. Empty where there is none.
///
/// Candidates are bars, brighter than what lies on either side of them, over a range of widths (the grey gravity of a
/// column would be drawn to everything else that shines); they are linked from column to column with hysteresis, and
/// those chains that say most make up the stripes. In them alone the ridge is sought: C. Steger, An unbiased detector
/// of curvilinear structures, IEEE PAMI 20(2), 1998, section 3: derivatives with Gaussians, the direction n across the
/// line from the Hessian, and the middle at t n, t = -(r_x n_x + r_y n_y) / (r_xx n_x^2 + 2 r_xy n_x n_y + r_yy n_y^2).
/// The Gaussian is as wide as the stripe itself there, which is more than Steger's least width, half the stripe's over
/// sqrt(3).
///
/// Fails: where stripes cross, their middles are drawn together over about two widths, and which is which beyond the
/// crossing follows from nearness only. A second reflection closer than a stripe's width draws the middle towards it.
std::vector<Stripe> find_stripes(const GreyImage& image, int count);

/// What the points of a profile are worth; all in the unit of the points.
struct ProfileScale {
    double sigma = 0;       ///< 1-sigma of a point across the profile
    double correlated = 1;  ///< how many neighbours share one error
    double band = 0;        ///< width of the stripe: so far from corners and ends the middle is not the surface's
};

/// Where a seam crosses a profile.
struct ProfileFeature {
    Eigen::Vector2d p{0, 0};
    double sigma = 0;     ///< 1-sigma, from those of the flanks
    double bend_rad = 0;  ///< between the flanks' directions
};

/// Points of a profile in order of x, y out of the material, and the 1-sigma of each.
struct ProfilePoints {
    std::span<const Eigen::Vector2d> p;
    std::span<const double> sigma;
};

/// The seam's place in one profile. Never the lowest point: straight flanks are fitted and carried on to where they
/// meet (M. Cibicik, L. Tingelstad, O. Egeland, Sensors 21(14) 4791, 2021). Fillet, corner and saddle: where the two
/// meet between which the profile bends most, hollow or outwards; V-groove: where the bevels meet, or the middle of
/// their lower ends when these stand apart; lap: the foot of the step; butt: the middle of the two edges. Where a flank
/// ends, half of the light of its stripe is left, and with it half of the ridge's sharpness, to which the points'
/// sigmas are inverse. Empty where the profile does not show such a joint.
std::optional<ProfileFeature> find_feature(const ProfilePoints& points, const ProfileScale& scale, JointKind kind);

/// The plane that a laser lights: n p = distance for its points p, in the camera's frame, mm.
struct LaserPlane {
    Eigen::Vector3d normal{0, 0, 1};  ///< unit
    double distance_mm = 0;           ///< of the camera from it; not 0
};

/// A stripe in space. One entry a point, from left to right in the picture.
struct Profile {
    std::vector<Eigen::Vector3d> points;  ///< mm, camera's frame
    std::vector<double> sigma_mm;         ///< 1-sigma of each, across the stripe in the laser's plane
    std::vector<int> column;              ///< of the picture, ascending
    ProfileScale scale;                   ///< mm
};

/// Where the rays of a stripe's points meet the laser's plane; those that do not meet it before the camera are left
/// out.
Profile triangulate(const Stripe& stripe, const CameraModel& camera, const LaserPlane& plane);

/// find_feature() in the laser's plane, seen from the camera.
struct ProfileSeamPoint {
    Eigen::Vector3d p;  ///< mm, camera's frame
    double sigma_mm = 0;
};
std::optional<ProfileSeamPoint> find_seam_point(const Profile& profile, const LaserPlane& plane, JointKind kind);

/// Profiles as one scan in the base's frame: a raster of `columns` a row and a row a profile. Profiles may be empty,
/// but not all of them.
struct StripeScan {
    Scan scan;
    std::vector<float> sigma_mm;  ///< one a point of the scan
};
StripeScan scan_of_profiles(std::span<const Profile> profiles, std::span<const Eigen::Isometry3d> base_from_camera,
                            int columns);

}  // namespace seampath
