#include "pipeline/groove_columns.hpp"

namespace seampath {

std::vector<Measured> groove_values(const Seam& seam, const GrooveColumn& column) {
    std::vector<Measured> values;
    for (const GrooveStation& station : seam.groove) {
        const Measured& number = station.*column.number;
        values.push_back({column.per_unit * number.value, column.per_unit * number.sigma});
    }
    return values;
}

}  // namespace seampath
