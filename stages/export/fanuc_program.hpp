#pragma once

#include <map>
#include <string>
#include <vector>

#include "stages/export/text.hpp"

/// Private to FANUC's reader: a TP program as a controller has it when it is loaded.
namespace seampath::exporting {

struct FanucPosition {
    Target target;  // pose or axes
    double user_frame = 0, tool = 0;
    std::string configuration;  // of a pose
};

struct FanucInstruction {
    Scanner at;  // behind the line number
};

struct FanucProgram {
    std::string name;
    std::vector<FanucInstruction> instructions;
    std::map<double, FanucPosition> positions;
    bool welds = false;  // the application's section was there
};

/// A whole number in brackets.
double fanuc_index(Scanner& scan);

/// By the rules of the ASCII upload. Throws InternalError naming file and line for what it does not understand.
FanucProgram load_fanuc(const TextFile& file);

}  // namespace seampath::exporting
