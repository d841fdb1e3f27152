#pragma once

#include <string>
#include <vector>

#include "datasets/regression/results.hpp"

namespace seampath {

/// One metric of one case in two results, over the seeds that both have.
struct PairedDifference {
    std::string id;
    std::string metric;
    std::size_t seeds = 0;
    double before = 0;  ///< means over the seeds
    double after = 0;
    double difference = 0;  ///< mean of after - before, seed by seed
    double deviation = 0;   ///< standard deviation of those differences; 0 of one seed
    double share = 0;       ///< of the difference in the larger of both values
};

/// Every metric that differs, the largest share first. A value that only one has, or that is not finite in one of both,
/// has an infinite difference and comes first.
std::vector<PairedDifference> compare_results(const SuiteResults& before, const SuiteResults& after);

/// The same as a table, of at most so many rows; one sentence when nothing differs.
std::string comparison_text(const std::vector<PairedDifference>& differences, std::size_t rows);

}  // namespace seampath
