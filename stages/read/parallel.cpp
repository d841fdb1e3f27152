#include "stages/read/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "stages/geometry/parallel.hpp"

namespace seampath {

void for_each_block(std::size_t blocks, const std::function<void(std::size_t)>& work) {
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::size_t failed_block = blocks;
    std::exception_ptr failure;
    const auto worker = [&] {
        for (std::size_t block = next++; block < blocks; block = next++) {
            try {
                work(block);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (block < failed_block) {
                    failed_block = block;
                    failure = std::current_exception();
                }
                // Blocks are handed out in ascending order, so every lower one has been started and will report.
                next = blocks;
            }
        }
    };
    const std::size_t threads = std::min<std::size_t>({usable_processors(), blocks, 16});
    std::vector<std::jthread> helpers;
    try {
        while (helpers.size() + 1 < threads) {
            helpers.emplace_back(worker);
        }
    } catch (const std::system_error&) {
        // No more threads to be had: those there are, this one at least, do all the work.
    }
    worker();
    helpers.clear();
    if (failure) {
        std::rethrow_exception(failure);
    }
}

}  // namespace seampath
