#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace seampath {

/// A start tag of an XML text.
struct XmlElement {
    std::string name;
    std::map<std::string, std::string> attributes;
    std::size_t depth = 0;  ///< of the root 0
    std::size_t line = 0;   ///< from 1
};

/// Every element in the order of the text, with its depth: as much of XML as data in attributes needs. Text between
/// tags, comments, processing instructions and declarations are passed over; the five named entities are
/// resolved. Throws InputError with `file` and line for tags that are cut off, wrongly nested or not closed, and for
/// other entities.
std::vector<XmlElement> xml_elements(std::string_view text, const std::string& file);

}  // namespace seampath
