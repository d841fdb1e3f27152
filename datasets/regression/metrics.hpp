#pragma once

#include <string>
#include <utility>
#include <vector>

#include "datasets/scenes.hpp"
#include "pipeline/fixture_calibration.hpp"
#include "pipeline/result.hpp"

/// What a case is judged by. Names end in their unit; those of an angle's or length's error in 1-sigmas in `_sigmas`.
namespace seampath {

struct Measurements {
    std::vector<std::pair<std::string, double>> numbers;  ///< in the order of the tables
    std::vector<std::pair<std::string, std::string>> hashes;

    void add(const std::string& name, double value) { numbers.emplace_back(name, value); }
};

/// What a run tells of itself: seams and nodes with their chord errors (by brute force over all points, not those that
/// the stages state), the deviation from the scan of the worst seam, path and programs, with the SHA-256 of each.
void measure_run(const PartResult& part, Measurements& to);

/// How far its seams, curves and torch are from the truth: score.hpp for what the errors are, of extracted points
/// (`extracted_`), curves (`fitted_`) and weld waypoints (`path_`); `scene`, where there is one, tells the true
/// dimensions of saddles.
void measure_truth(const PartResult& part, const Truth& truth, const SceneOptions* scene, Measurements& to);

/// The same of a fixture's frame.
void measure_fixture(const FixtureCalibration& calibration, const Eigen::Isometry3d& true_base_from_part,
                     Measurements& to);

}  // namespace seampath
