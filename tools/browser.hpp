#pragma once

#include <filesystem>
#include <string>

namespace seampath {

/// A page on A4 as a Chromium prints it, the bytes of a PDF. The browser is the first of chromium, chromium-browser,
/// google-chrome and google-chrome-stable on the PATH; it runs without a window and in a profile of its own. Throws
/// InputError when there is none, or it makes no PDF within two minutes; Interrupted when the program is asked to stop.
std::string print_page(const std::filesystem::path& page);

}  // namespace seampath
