#pragma once

#include <string>

#include "pipeline/result.hpp"

namespace seampath {

std::string report_json(const PartResult& part);
std::string report_html(const PartResult& part);

}  // namespace seampath
