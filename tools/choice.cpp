#include "tools/choice.hpp"

#include <algorithm>

#include "pipeline/text.hpp"
#include "stages/error.hpp"

namespace seampath {

std::size_t choice(const std::string& option, const std::string& word, std::span<const std::string_view> names) {
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) {
        throw InputError(option + ": \"" + word + "\" is unknown; there are " + join(names) + hint(word, names));
    }
    return static_cast<std::size_t>(found - names.begin());
}

}  // namespace seampath
