#pragma once

#include <string>
#include <vector>

#include "stages/extract/around.hpp"
#include "stages/extract/extract.hpp"
#include "stages/extract/rims.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// Joints in which two smooth surfaces meet in a line, and the registration of the views that their flanks tell of.
struct Folds {
    std::vector<Seam> seams;
    double registration_mm = 0;
    std::vector<std::string> remarks;
};

/// Fillets (`concave`) and corners (`convex`), of which plates' rims are left out, that do not lie on `taken`, the
/// tracks of joints found before.
Folds find_folds(const Around& around, bool concave, bool convex, const ExtractOptions& options,
                 const std::vector<Track>& taken);

/// The measured places of joints along the tracks, each at least as long as asked (0: as tells a joint from chance); of
/// the others a remark says why they are none.
std::vector<Fold> measure_all(const Tracker& tracker, const std::vector<Track>& tracks, double min_length_mm,
                              std::vector<std::string>& remarks);

}  // namespace seampath::detail
