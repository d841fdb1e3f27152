#pragma once

#include <string_view>

/// Files that the build puts into the program (report_assets.S.in).
namespace seampath {

std::string_view viewer_script();
std::string_view page_script();
std::string_view sort_script();
std::string_view report_style();
std::string_view three_gzip();  ///< three.js, compressed

}  // namespace seampath
