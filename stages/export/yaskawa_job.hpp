#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "stages/export/text.hpp"

/// Private to Yaskawa's reader: a job as a controller has it when it is loaded.
namespace seampath::exporting {

struct YaskawaJob {
    std::string name, frame, comments;
    std::map<double, std::array<double, 6>> poses;  // x, y, z mm, Rx, Ry, Rz deg
    std::map<double, std::array<double, 6>> pulses;
    std::vector<Scanner> lines;
};

double whole_number(Scanner& scan);

/// By the rules of the job data format. Throws InternalError naming file and line for what it does not understand.
YaskawaJob load_yaskawa(const TextFile& file);

}  // namespace seampath::exporting
