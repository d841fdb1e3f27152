#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace seampath {

/// How a process ended.
struct ChildEnd {
    int status = 0;  ///< exit status, or 128 + signal
    int signal = 0;  ///< that ended it, or 0
    double seconds = 0;
    double memory_mb = 0;  ///< most that it had
};

/// A program in a process of its own, with what it prints in a file. Ended by force when this object goes.
class ChildProcess {
public:
    /// Begins it: `words` are the program, looked for in PATH, and its arguments. Its data may have at most `memory_mb`
    /// where that is above 0; more is a failed allocation there. Throws InputError when there is no process to be had.
    ChildProcess(const std::vector<std::string>& words, const std::filesystem::path& log, double memory_mb = 0);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// How it ended, or nothing while it runs.
    std::optional<ChildEnd> poll();

    /// Waits for the end.
    ChildEnd wait();

    /// Ends it by force.
    void kill() const;

    double seconds() const;

private:
    std::optional<ChildEnd> reap(int options);

    pid_t pid_ = -1;
    std::chrono::steady_clock::time_point start_;
    std::optional<ChildEnd> end_;
};

}  // namespace seampath
