#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pipeline/report_checks.hpp"
#include "pipeline/result.hpp"

/// What a report says, before it is written as JSON or HTML: both take their numbers from here.
namespace seampath {

/// One number or fact. `name` ends in its unit; `label` is its heading for people; `verdict` is "pass", "fail" or
/// empty; `decimals` is how many places people need to see.
struct ReportRow {
    std::string name;
    std::string label;
    std::variant<double, std::int64_t, bool, std::string> value;
    std::string unit;
    std::string verdict;
    int decimals = 3;
};
using ReportRows = std::vector<ReportRow>;

struct ReportSeam {
    bool pass = false;
    std::string sentence;  ///< the verdict with the numbers behind it
    ReportRows rows;
    std::vector<Characteristic> characteristics;  ///< empty for a nominal part, as are the places
    std::vector<ReportRows> places;               ///< where it is farthest from the scan, worst first
};

struct ReportProgram {
    std::string robot;
    std::string file;
    ReportRows rows;
};

/// One option; values as in the config file.
struct ReportSetting {
    std::string name;  ///< stage.key
    std::string value;
    std::string default_value;
    std::string meaning;
    bool changed = false;
};

struct Report {
    std::string part;
    bool pass = false;
    std::string sentence;
    ReportRows identity;  ///< of scan, options and program
    ReportRows rows;
    ReportRows scan;  ///< empty for a nominal part
    std::vector<std::string> remarks;
    std::vector<ReportSeam> seams;  ///< parallel to PartResult::models
    std::vector<ReportProgram> programs;
    std::vector<ReportSetting> settings;  ///< in the order of the stages
    std::vector<StageTiming> timings;
};

Report report_of(const PartResult& part);

/// Whether there is a row of that name: a nominal part has none that speak of a scan.
bool has_row(const ReportRows& rows, std::string_view name);

/// The row of that name; there must be one.
const ReportRow& find_row(const ReportRows& rows, std::string_view name);

/// A value as people read it, without its unit: `decimals` places, digits in groups, yes or no. A number that is not
/// zero but would show as zero reads "<0.001".
std::string shown(const ReportRow& row);

/// A value as report.json has it, without quotes round a text.
std::string exact(const ReportRow& row);

}  // namespace seampath
