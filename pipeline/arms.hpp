#pragma once

#include <array>
#include <string>
#include <string_view>

#include "stages/geometry/arm.hpp"

namespace seampath {

/// The arms whose data files (pipeline/arms/NAME.urdf) are in the program, in the order of arms.S.in.
inline constexpr std::array<std::string_view, 5> kArmNames{"abb-irb-1600-6-1.2", "abb-irb-1600-8-1.45", "ur10e",
                                                           "kuka-kr-16-2", "fanuc-m-10ia"};

/// An arm and the URDF text that it follows from.
struct ArmFile {
    std::string text;
    Arm arm;
};

/// The robot of kRobotNames whose controller has the axes of an arm of kArmNames; empty for a file's.
std::string robot_of_arm(std::string_view name_or_file);

/// By a name of kArmNames, or from a URDF file. Throws InputError for neither, and as arm_from_urdf() does.
ArmFile load_arm(const std::string& name_or_file);

}  // namespace seampath
