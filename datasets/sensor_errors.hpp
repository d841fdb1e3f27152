#pragma once

#include <vector>

#include <Eigen/Core>

#include "datasets/rng.hpp"
#include "datasets/scanner.hpp"
#include "datasets/station.hpp"

/// The errors of a sensor that do not depend on what it sees.
namespace seampath {

/// Noise of variance 1 for each pixel, white or tied to its neighbours: along the row and, for a picture that is taken
/// at once, down the column.
std::vector<double> noise_field(const ScannerOptions& o, const Station& station, const Random& random,
                                unsigned threads);

/// Pixels lost in round spots whose diameters are 1 to 5 mm.
std::vector<char> blob_mask(const ScannerOptions& o, const Station& station, const Random& random);

/// p0 face on, growing between 60 and 80 degrees of incidence.
double dropout_share(double p0, double cosine);

/// Error of the robot's path at a row: three waves per axis, each of a third of the amplitude, 20 to 300 mm long.
Eigen::Vector3d path_error(const ScannerOptions& o, const Random& random, std::uint32_t row);

}  // namespace seampath
