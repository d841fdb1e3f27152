#pragma once

#include <cstdint>

#include "pipeline/report_rows.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/result.hpp"

/// The rows of a report's seams, and the makers of all rows.
namespace seampath {

inline ReportRow number(std::string name, std::string label, double value, std::string unit, int decimals = 3) {
    return {std::move(name), std::move(label), value, std::move(unit), "", decimals};
}

inline ReportRow count(std::string name, std::string label, std::size_t value) {
    return {std::move(name), std::move(label), static_cast<std::int64_t>(value), "", "", 0};
}

inline ReportRow fact(std::string name, std::string label, std::string_view value) {
    return {std::move(name), std::move(label), valid_utf8(value), "", "", 0};
}

inline ReportRow judged(ReportRow row, bool pass) {
    row.verdict = pass ? "pass" : "fail";
    return row;
}

/// Length of the polyline through a seam's points over which they were bridged rather than measured.
double modelled_length(const Seam& seam);

/// Of a seam without a scan, and of one that was found in a scan.
ReportSeam nominal_report(const PartResult& part, std::size_t i);
ReportSeam seam_report(const PartResult& part, std::size_t i);

}  // namespace seampath
