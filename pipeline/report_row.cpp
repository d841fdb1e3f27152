#include <algorithm>
#include <cmath>

#include "pipeline/report_rows.hpp"
#include "pipeline/report_text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {

bool has_row(const ReportRows& rows, std::string_view name) {
    return std::any_of(rows.begin(), rows.end(), [&](const ReportRow& r) { return r.name == name; });
}

const ReportRow& find_row(const ReportRows& rows, std::string_view name) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const ReportRow& r) { return r.name == name; });
    ensure(found != rows.end(), "a report shows only rows that it has");
    return *found;
}

std::string shown(const ReportRow& row) {
    if (const auto* yes = std::get_if<bool>(&row.value)) {
        return *yes ? "yes" : "no";
    }
    if (const auto* whole = std::get_if<std::int64_t>(&row.value)) {
        return grouped(*whole);
    }
    if (const auto* text = std::get_if<std::string>(&row.value)) {
        return *text;
    }
    const double value = std::get<double>(row.value);
    const double unit_of_last_place = std::pow(10.0, -row.decimals);
    const bool vanishes = value != 0 && std::abs(value) < 0.5 * unit_of_last_place;
    return vanishes ? '<' + decimal(unit_of_last_place, row.decimals) : decimal(value, row.decimals);
}

std::string exact(const ReportRow& row) {
    if (const auto* yes = std::get_if<bool>(&row.value)) {
        return *yes ? "true" : "false";
    }
    if (const auto* whole = std::get_if<std::int64_t>(&row.value)) {
        return std::to_string(*whole);
    }
    if (const auto* text = std::get_if<std::string>(&row.value)) {
        return *text;
    }
    const double value = std::get<double>(row.value);
    return std::isfinite(value) ? shortest(value) : "null";
}

}  // namespace seampath
