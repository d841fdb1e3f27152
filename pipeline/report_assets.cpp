#include "pipeline/report_assets.hpp"

// First byte and one past the last of each file, from report_assets.S.in.
extern "C" {
extern const char seampath_viewer_begin[], seampath_viewer_end[];
extern const char seampath_page_begin[], seampath_page_end[];
extern const char seampath_sort_begin[], seampath_sort_end[];
extern const char seampath_style_begin[], seampath_style_end[];
extern const char seampath_three_begin[], seampath_three_end[];
}

namespace seampath {

std::string_view viewer_script() {
    return {seampath_viewer_begin, seampath_viewer_end};
}
std::string_view page_script() {
    return {seampath_page_begin, seampath_page_end};
}
std::string_view sort_script() {
    return {seampath_sort_begin, seampath_sort_end};
}
std::string_view report_style() {
    return {seampath_style_begin, seampath_style_end};
}
std::string_view three_gzip() {
    return {seampath_three_begin, seampath_three_end};
}

}  // namespace seampath
