#include "tools/stop_signal.hpp"

#include <atomic>
#include <csignal>

#include <unistd.h>

#include "tools/commands.hpp"

namespace seampath {
namespace {

std::atomic<bool> asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not wait for a lock");

void on_stop_signal(int) {
    if (asked.exchange(true)) {
        _exit(kInterrupted);
    }
}

}  // namespace

void watch_stop_signals() {
    struct sigaction action = {};
    action.sa_handler = on_stop_signal;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    // a file size limit then shows as a failed write with a message, like a full disk
    std::signal(SIGXFSZ, SIG_IGN);
}

bool stop_asked() {
    return asked;
}

}  // namespace seampath
