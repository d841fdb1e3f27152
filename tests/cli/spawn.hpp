#pragma once

#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/pipeline/run_support.hpp"

/// Runs the program itself, as a user does.
namespace seampath {

struct Outcome {
    int status = -1;  ///< exit status, or 128 + signal
    std::string out;
    std::string err;
};

/// The program at work; output goes to files in a folder of its own.
class Process {
public:
    /// `in_child` runs between fork and exec, e.g. to set a limit.
    explicit Process(std::vector<std::string> arguments, const std::function<void()>& in_child = {}) {
        arguments.insert(arguments.begin(), SEAMPATH_PROGRAM);
        std::vector<char*> words;
        words.reserve(arguments.size() + 1);
        for (auto& argument : arguments) {
            words.push_back(argument.data());
        }
        words.push_back(nullptr);
        const std::string out = (folder_.path() / "out").string();
        const std::string err = (folder_.path() / "err").string();
        pid_ = fork();
        if (pid_ == 0) {
            dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
            dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
            if (in_child) {
                in_child();
            }
            execv(words[0], words.data());
            _exit(127);
        }
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    ~Process() {
        if (!ended_) {
            kill(pid_, SIGKILL);
            wait();
        }
    }

    void signal(int number) const { kill(pid_, number); }

    /// What it has written to stderr so far.
    std::string err() const { return text_of(folder_.path() / "err"); }

    /// Waits until `text` stands on stderr; false if it ends or half a minute passes before.
    bool wait_for_err(const std::string& text) {
        for (int i = 0; i < 6000 * SEAMPATH_SLOWDOWN && err().find(text) == std::string::npos; ++i) {
            if (waitpid(pid_, &raw_status_, WNOHANG) == pid_) {
                ended_ = true;
                return err().find(text) != std::string::npos;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return err().find(text) != std::string::npos;
    }

    Outcome wait() {
        if (!ended_) {
            while (waitpid(pid_, &raw_status_, 0) < 0 && errno == EINTR) {
            }
            ended_ = true;
        }
        const int status = WIFEXITED(raw_status_) ? WEXITSTATUS(raw_status_) : 128 + WTERMSIG(raw_status_);
        return {status, text_of(folder_.path() / "out"), err()};
    }

private:
    TestFolder folder_;
    pid_t pid_ = -1;
    int raw_status_ = 0;
    bool ended_ = false;
};

inline Outcome seampath_program(std::vector<std::string> arguments, const std::function<void()>& in_child = {}) {
    return Process(std::move(arguments), in_child).wait();
}

/// A small tee in a folder of its own, made once for all tests of a program.
inline const std::filesystem::path& small_tee() {
    static const TestFolder folder;
    static const std::filesystem::path scan = [] {
        write_small_tee(folder.path());
        return folder.path() / "scan.ply";
    }();
    return scan;
}

/// The command line that runs the small tee into a folder.
inline std::vector<std::string> run_small_tee(const std::filesystem::path& out, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"run", small_tee(), "--out", out};
    words.insert(words.end(), {"--set", "validate.tolerance_mm=" + std::to_string(kLooseToleranceMm)});
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

inline bool holds_temporary_files(const std::filesystem::path& folder) {
    for (const auto& [name, text] : contents(folder)) {
        if (name.find(".tmp.") != std::string::npos) {
            return true;
        }
    }
    return false;
}

}  // namespace seampath
