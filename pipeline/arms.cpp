#include "pipeline/arms.hpp"

#include <algorithm>
#include <filesystem>

#include "pipeline/files.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/geometry/urdf.hpp"

// Where each file begins, and where the last one ends, from arms.S.in.
extern "C" {
extern const char* const seampath_arms[];
}

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxUrdfBytes = std::size_t{1} << 24;

// Of kArmNames, in their order.
constexpr std::array<std::string_view, kArmNames.size()> kArmRobots{"abb", "abb", "ur", "kuka", "fanuc"};

}  // namespace

std::string robot_of_arm(std::string_view name_or_file) {
    const auto known = std::find(kArmNames.begin(), kArmNames.end(), name_or_file);
    return std::string(known == kArmNames.end() ? "" : kArmRobots[static_cast<std::size_t>(known - kArmNames.begin())]);
}

ArmFile load_arm(const std::string& given) {
    const auto known = std::find(kArmNames.begin(), kArmNames.end(), given);
    if (known != kArmNames.end()) {
        const auto i = known - kArmNames.begin();
        std::string text(seampath_arms[i], seampath_arms[i + 1]);
        Arm arm = arm_from_urdf(text, given);
        return {std::move(text), std::move(arm)};
    }
    if (!fs::is_regular_file(given)) {
        throw InputError("arm: plan.arm is \"" + given + "\", which is neither a file nor one of " + join(kArmNames) +
                         hint(given, kArmNames) + "; name one of them or a URDF file");
    }
    std::string text = read_file(given, kMaxUrdfBytes, "arm");
    Arm arm = arm_from_urdf(text, given);
    return {std::move(text), std::move(arm)};
}

}  // namespace seampath
