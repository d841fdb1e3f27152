#pragma once

#include <array>
#include <string>
#include <vector>

#include "pipeline/result.hpp"

/// The picture in the report: what is shown of a part, and from where.
namespace seampath {

/// Scan points as they are shown: fewer, and relative to the scene's centre, mm.
struct ViewCloud {
    std::vector<Eigen::Vector3f> points;
    std::vector<Eigen::Vector3f> normals;  ///< one per point, of either sign; zero where the neighbours define none
    float spacing_mm = 1;                  ///< typical distance of the points that were kept
};

/// Where the picture is taken from. The camera looks along -toward.
struct ViewCamera {
    Eigen::Vector3d toward{0, 0, 1};  ///< unit, from the centre to the camera
    Eigen::Vector3d up{0, 1, 0};      ///< unit, at right angles to `toward`
};

/// Sample of a seam in the picture.
struct ViewSample {
    Eigen::Vector3d p;  ///< relative to the scene's centre, mm
    double station_mm = 0;
    double distance_mm = 0;
    double sigma_mm = 0;
    bool covered = false;
    bool modelled = false;
    double flank1_mm = 0;  ///< signed distances to the flanks, as in DeviationSample
    double flank2_mm = 0;
};

struct ViewSeam {
    std::vector<ViewSample> samples;     ///< a closed seam ends with its first sample again
    std::vector<Eigen::Vector3d> nodes;  ///< relative to the centre
    double tolerance_mm = 0;
    ViewCamera camera;  ///< shows this seam best
};

/// One torch pose: tool centre point relative to the centre, and the unit direction of the torch into the joint.
struct ViewTorch {
    Eigen::Vector3d p;
    Eigen::Vector3d axis;
};

/// A named place, and an arrow from it as it is drawn.
struct ViewMark {
    std::string text;
    Eigen::Vector3d p;  ///< relative to the centre
    Eigen::Vector3d arrow{0, 0, 0};
    bool good = true;
};

/// An ellipsoid as it is drawn: its half axes are columns, each longer than 0.
struct ViewEllipsoid {
    std::string text;
    Eigen::Vector3d p;  ///< relative to the centre
    Eigen::Matrix3d half_axes;
    bool good = true;
};

struct ViewScene {
    bool nominal = false;             ///< there is no scan
    Eigen::Vector3d centre{0, 0, 0};  ///< scan frame, mm
    double radius_mm = 1;             ///< of a sphere around the centre that holds all seams (or the scan)
    ViewCamera camera;
    std::array<ViewCloud, 2> clouds;  ///< near the seams, and the rest: sparser
    std::vector<ViewSeam> seams;
    std::vector<ViewTorch> torch;
    std::vector<ViewMark> marks;
    std::vector<ViewEllipsoid> ellipsoids;
    double scale_mm = 0;  ///< deviation at the end of the colour scale: the largest tolerance
};

ViewScene view_scene(const PartResult& part);

/// Colours of deviations from 0 to scale_mm in equal steps (viridis: safe for the colour-blind, and ordered in grey),
/// then for what is out of tolerance, and for what was not checked against the scan.
inline constexpr std::array<const char*, 9> kDeviationColours{"#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c",
                                                              "#28ae80", "#5ec962", "#addc30", "#fde725"};
/// Colours of signed distances from -scale_mm to scale_mm in equal steps: blue, white, orange, which the colour-blind
/// tell apart, the ends being of one darkness.
inline constexpr std::array<const char*, 5> kSignedColours{"#1f5fbf", "#8fb4e3", "#f7f7f7", "#f0a860", "#c2570c"};
inline constexpr const char* kOutOfToleranceColour = "#e3122f";
inline constexpr const char* kUncheckedColour = "#7d8794";

/// The scene as JSON for viewer.js: coordinates relative to the centre in mm; cloud positions as base64 of
/// little-endian 16-bit steps between two corners, normals as base64 of signed bytes.
std::string view_json(const ViewScene& scene);

/// The 3D view of the page with its legend, layers and still picture.
std::string view_section(const ViewScene& scene);

/// A still picture of the scene (parallel projection) for pages without WebGL or scripts.
std::string view_svg(const ViewScene& scene);

}  // namespace seampath
