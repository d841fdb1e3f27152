#include "tools/progress_line.hpp"

#include <chrono>
#include <iostream>

#include <unistd.h>

#include "stages/text.hpp"
#include "tools/stop_signal.hpp"

namespace seampath {
namespace {

constexpr std::size_t kSteps = kStageNames.size() + 1;  // and the report
constexpr std::string_view kClearLine = "\r\033[K";

}  // namespace

ProgressLine::ProgressLine(std::string prefix) : prefix_(std::move(prefix)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress ProgressLine::progress() {
    return {[this](std::string_view stage) { begin(stage); }, [this](const StageTiming& timing) { end(timing); },
            stop_asked};
}

void ProgressLine::begin(std::string_view stage) {
    if (terminal_) {
        drawer_ = std::jthread(
            [this, name = std::string(stage), done = done_](const std::stop_token& stop) { draw(stop, name, done); });
    }
}

void ProgressLine::end(const StageTiming& timing) {
    drawer_ = std::jthread();
    ++done_;
    const std::string name = timing.stage + std::string(timing.stage.size() < 9 ? 9 - timing.stage.size() : 0, ' ');
    std::cerr << prefix_ << name << " " << timing.summary << "; " << fixed(timing.seconds, 2) << " s"
              << (timing.resumed ? " (resumed)" : "") << std::endl;
}

void ProgressLine::draw(const std::stop_token& stop, const std::string& stage, std::size_t done) {
    const auto start = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, stop, std::chrono::milliseconds(200), [&] { return stop.stop_requested(); })) {
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
        std::cerr << kClearLine << prefix_ << "[" << std::string(done, '#') << std::string(kSteps - done, '.') << "] "
                  << stage << " " << fixed(passed.count(), 1) << " s"
                  << (stop_asked() ? ", stopping after this stage" : "") << std::flush;
    }
    std::cerr << kClearLine << std::flush;
}

}  // namespace seampath
