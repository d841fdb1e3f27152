#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "stages/export/format.hpp"

/// Private to the export stage: as much of YAML as messages in text need.
namespace seampath::exporting {

/// In flow style: a number, a word, a map or a list.
struct Yaml {
    double number = std::numeric_limits<double>::quiet_NaN();
    std::string word;
    std::map<std::string, Yaml> members;
    std::vector<Yaml> items;

    /// Throws InternalError when there is no such member.
    const Yaml& operator[](const std::string& name) const;
};

/// Keys at the margin, each with a value in flow style or a list of lines that begin with a dash. Throws InternalError
/// naming file and line for anything else.
Yaml yaml_document(const TextFile& file);

}  // namespace seampath::exporting
