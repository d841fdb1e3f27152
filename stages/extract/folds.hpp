#pragma once

#include <string>
#include <vector>

#include "stages/extract/around.hpp"
#include "stages/extract/extract.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// Joints in which two smooth surfaces meet in a line, and the registration of the views that their flanks tell of.
struct Folds {
    std::vector<Seam> seams;
    double registration_mm = 0;
    std::vector<std::string> remarks;
};

/// Fillets (`concave`) and corners (`convex`), of which plates' rims are left out.
Folds find_folds(const Around& around, bool concave, bool convex, const ExtractOptions& options);

}  // namespace seampath::detail
