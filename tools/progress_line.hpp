#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "pipeline/run.hpp"

namespace seampath {

/// One line a stage on stderr; on a terminal a bar and the elapsed time show the stage that is at work.
class ProgressLine {
public:
    /// `prefix` begins each line, e.g. with the part's name.
    explicit ProgressLine(std::string prefix);

    /// Callbacks into this object, which must outlive them.
    Progress progress();

private:
    void begin(std::string_view stage);
    void end(const StageTiming& timing);
    void draw(const std::stop_token& stop, const std::string& stage, std::size_t done);

    std::string prefix_;
    bool terminal_ = false;
    std::size_t done_ = 0;
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::jthread drawer_;  ///< last: it is stopped before what it uses goes
};

}  // namespace seampath
