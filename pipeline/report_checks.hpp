#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/result.hpp"

/// What an inspection sheet lists of a seam: its characteristics against what was asked of them, and its worst places.
namespace seampath {

/// One characteristic. What is not there was not asked for or is not known; `name` ends in the unit.
struct Characteristic {
    std::string name;
    std::string label;
    std::string unit;
    double actual = 0;
    std::optional<double> nominal;
    std::optional<double> uncertainty;       ///< what the verdict adds for it, or the 1-sigma of a dimension
    std::optional<double> tolerance;         ///< most that the actual may differ from the nominal
    std::optional<double> out_of_tolerance;  ///< by how much more it does, uncertainty included; 0: not at all
    int decimals = 3;

    std::optional<double> deviation() const;  ///< of the actual from the nominal
    std::string verdict() const;              ///< "pass", "fail", or empty without a tolerance
};

/// Of seam i of a part with a scan: what its verdict was taken on, then those dimensions of its model that
/// the options of the fit know beforehand.
std::vector<Characteristic> characteristics(const PartResult& part, std::size_t i);

/// Deviation with its guard over the tolerance: above 1 a seam fails.
double tolerance_used(const Deviation& deviation);

/// Indices of the samples where the seam is farthest from the scan, worst first: at most three checked ones, each the
/// worst within a tenth of the seam's length to both sides.
std::vector<std::size_t> worst_samples(const Deviation& deviation, const SeamModel& model);

}  // namespace seampath
