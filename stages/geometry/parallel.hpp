#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <sched.h>

namespace seampath {

/// Processors that this process may run on, at least 1. std::thread::hardware_concurrency() counts those of the machine
/// also where the process is bound to some of them.
inline unsigned usable_processors() {
    cpu_set_t own;
    return sched_getaffinity(0, sizeof own, &own) == 0 ? static_cast<unsigned>(std::max(1, CPU_COUNT(&own)))
                                                       : std::max(1u, std::thread::hardware_concurrency());
}

/// Calls f(i) for i in [0, n) on all processors, in blocks of `block`. Deterministic as long as f(i) writes only to
/// places that belong to i. The first exception is rethrown.
template <class F>
void parallel_for(std::size_t n, std::size_t block, F&& f) {
    const std::size_t threads = std::min<std::size_t>(usable_processors(), (n + block - 1) / block);
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_guard;
    const auto work = [&] {
        try {
            for (std::size_t begin = next.fetch_add(block); begin < n; begin = next.fetch_add(block)) {
                for (std::size_t i = begin; i < std::min(n, begin + block); ++i) {
                    f(i);
                }
            }
        } catch (...) {
            const std::lock_guard lock(failure_guard);
            failure = failure ? failure : std::current_exception();
            next = n;
        }
    };
    std::vector<std::jthread> others;
    for (std::size_t k = 1; k < threads; ++k) {
        others.emplace_back(work);
    }
    work();
    others.clear();
    if (failure) {
        std::rethrow_exception(failure);
    }
}

/// Calls f(c, begin, end) for each of `chunks` equal runs of [0, n), on all processors. Sums over a run do not hang on
/// the number of threads.
template <class F>
void parallel_chunks(std::size_t n, std::size_t chunks, F&& f) {
    parallel_for(chunks, 1, [&](std::size_t c) { f(c, c * n / chunks, (c + 1) * n / chunks); });
}

}  // namespace seampath
