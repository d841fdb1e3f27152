#pragma once

#include <functional>
#include <string>

namespace seampath {

/// Calls `act` and turns what it throws into an exit status; the message goes to stderr, each line after `prefix`.
int guarded(const std::function<int()>& act, const std::string& prefix = {});

}  // namespace seampath
