#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "datasets/scanner.hpp"
#include "datasets/scenes.hpp"

/// Scans with known truth.
namespace seampath {

/// One of the views that a scan was put together from.
struct DatasetView {
    std::size_t first_point = 0;  ///< of the scan's points
    /// How the view's registration moved its points, scan frame: what lies at p was reported, noise aside, at error *
    /// p.
    Eigen::Affine3d error = Eigen::Affine3d::Identity();
};

struct Dataset {
    SceneOptions scene;  ///< as made: every dimension set
    ScannerOptions scanner;
    std::uint64_t seed = 0;
    Eigen::Isometry3d scan_from_scene = Eigen::Isometry3d::Identity();  ///< pose of the part
    std::vector<Eigen::Vector3f> points;                                ///< all views in one, mm, scan frame
    std::uint32_t width = 0;  ///< raster of an organised scan, whose gaps are NaN; otherwise 0
    std::uint32_t height = 0;
    std::vector<DatasetView> views;  ///< in the order of their points
    Truth truth;                     ///< scan frame
};

/// A scan of a scene and its truth, all from one seed: the same bytes on any machine and any number of threads
/// (0: as many as the machine has). Options lie within the bounds of describe(). Throws InputError for a part that
/// can't be built or seen.
Dataset make_dataset(const SceneOptions& scene, const ScannerOptions& scanner, std::uint64_t seed,
                     unsigned threads = 0);

/// Writes the scan (`scan.ply`, or `scan.pcd` when it is organised; binary, x y z as 32-bit floats) and `truth.json`
/// into the folder, which is made when it is missing; the scan's numbers are in units of so many mm, the truth is in
/// mm. Returns the scan's path. Throws InputError when a file can't be written.
std::filesystem::path write_dataset(const Dataset& dataset, const std::filesystem::path& folder,
                                    double mm_per_unit = 1);

/// Throws InputError when the file is not a truth file.
Truth read_truth(const std::filesystem::path& file);

}  // namespace seampath
