#pragma once

#include <filesystem>
#include <optional>

#include "stages/nominal/nominal.hpp"
#include "stages/types.hpp"

/// `seampath saddle --from`: saddles that an earlier run fitted to its scan.
namespace seampath {

struct SaddleFrom {
    std::filesystem::path folder;
    std::optional<int> seam;  ///< without: all saddles of the run
    std::filesystem::path out;
    bool json = false;
};

/// Dimensions of the one saddle that is asked for. Throws InputError when the run has none, or several and no `seam`
/// says which.
SaddleDimensions fitted_dimensions(const SaddleFrom& from);

/// Every saddle against the nominal one: prints the differences and leaves them as saddle_difference.json, .csv and
/// .svg in `out`. Throws InputError when the run has no saddle, and as saddle_difference() does.
int compare_with_nominal(const SaddleFrom& from, const SaddleDimensions& nominal);

}  // namespace seampath
