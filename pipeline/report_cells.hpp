#pragma once

#include <string>
#include <string_view>

#include "pipeline/report_rows.hpp"

/// The small pieces that the report's page is put together from.
namespace seampath {

/// A value with the path of its row in report.json and its unrounded value, so that any copy can be checked.
std::string value_attributes(const ReportRow& row, const std::string& path);

/// A cell of a table with the row of that name; the path is that of `rows` in report.json.
std::string cell(const ReportRows& rows, const std::string& path, std::string_view name);

/// A cell with the number at a JSON pointer of report.json.
std::string cell_at(const std::string& pointer, double value, int decimals);

std::string heading(std::string_view text, bool number);
std::string badge(bool pass);

/// The beginning of a page up to its opened body: title, style, and the rule that nothing is loaded from anywhere.
std::string page_head(std::string_view title);

/// JSON inside a script element: "</script" and "<!--" in a text must not end or open anything.
std::string data_script(std::string_view id, const std::string& json);

/// What is behind a path below the page itself, safe in an address: all but letters, digits and "-._/" is escaped.
std::string address(std::string_view path);

}  // namespace seampath
