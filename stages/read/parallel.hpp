#pragma once

#include <cstddef>
#include <functional>

namespace seampath {

/// Calls work(0) ... work(blocks - 1), on as many threads as the machine has. `work` must write to places of its own
/// only, so that the result is the same on one thread and on many. If calls throw, the exception of the lowest block is
/// rethrown.
void for_each_block(std::size_t blocks, const std::function<void(std::size_t)>& work);

}  // namespace seampath
