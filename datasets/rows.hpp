#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace seampath {

/// Runs body(row) for each row. Rows must not depend on each other.
inline void for_rows(std::uint32_t rows, unsigned threads, const std::function<void(std::uint32_t)>& body) {
    std::atomic<std::uint32_t> next{0};
    const auto work = [&] {
        for (std::uint32_t row = next++; row < rows; row = next++) {
            body(row);
        }
    };
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; ++i) {
        others.emplace_back(work);
    }
    work();
}

}  // namespace seampath
