#pragma once

#include <string>
#include <string_view>

#include "stages/geometry/arm.hpp"

namespace seampath {

/// The arm that a URDF text describes (Unified Robot Description Format: XML; metres, rad): the six revolute or
/// continuous joints between its root and its tip, which is the link `tool0`, else `flange`, else the only end of the
/// longest chain; fixed joints in between count. A continuous joint may turn by 2 pi either way. `file` is for
/// messages. Throws InputError, with line or joint, for text that is no such XML, a xacro that was not expanded, a tree
/// without one such chain, a joint without what it needs, and an arm without closed form.
Arm arm_from_urdf(std::string_view text, const std::string& file);

}  // namespace seampath
