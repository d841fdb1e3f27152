#include "tools/stop_signal.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <string_view>

#include <unistd.h>

#include "tools/exit_status.hpp"

namespace seampath {
namespace {

std::atomic<bool> asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not wait for a lock");

void on_stop_signal(int) {
    if (asked.exchange(true)) {
        _exit(kInterrupted);
    }
    const int before = errno;
    constexpr std::string_view kText = "\ninterrupted: finishing the stage at work; Ctrl-C again ends at once\n";
    static_cast<void>(!write(STDERR_FILENO, kText.data(), kText.size()));  // there is no other way to say it
    errno = before;
}

}  // namespace

void watch_stop_signals() {
    struct sigaction action = {};
    action.sa_handler = on_stop_signal;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

bool stop_asked() {
    return asked;
}

}  // namespace seampath
