#include "tools/dataset/child_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "stages/error.hpp"

namespace seampath {
namespace {

constexpr int kNotStarted = 127;
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kLimitsMemory = false;  // AddressSanitizer reserves terabytes to begin with
#else
constexpr bool kLimitsMemory = true;
#endif

void limit(int resource, rlim_t most) {
    const rlimit held{most, most};
    setrlimit(static_cast<__rlimit_resource_t>(resource), &held);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words, const std::filesystem::path& log, double memory_mb)
    : start_(std::chrono::steady_clock::now()) {
    std::vector<std::string> copies = words;
    std::vector<char*> arguments;
    for (std::string& word : copies) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    const std::string file = log.string();
    pid_ = fork();
    if (pid_ < 0) {
        throw InputError(std::string("dataset: no process can be started: ") + std::strerror(errno) +
                         "; give the machine more room, or --jobs a smaller number");
    }
    if (pid_ > 0) {
        return;
    }
    // From here on only what is safe between fork and exec.
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // a suite that is killed leaves no process behind
    limit(RLIMIT_CORE, 0);
    if (kLimitsMemory && memory_mb > 0) {
        limit(RLIMIT_DATA, static_cast<rlim_t>(memory_mb * 1024 * 1024));
    }
    const int out = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    setpgid(0, 0);  // Ctrl-C is for the suite, which ends its children itself
    execvp(arguments[0], arguments.data());
    _exit(kNotStarted);
}

ChildProcess::~ChildProcess() {
    if (!end_) {
        kill();
        wait();
    }
}

std::optional<ChildEnd> ChildProcess::reap(int options) {
    if (end_) {
        return end_;
    }
    int raw = 0;
    rusage used{};
    pid_t ended = 0;
    do {
        ended = wait4(pid_, &raw, options, &used);
    } while (ended < 0 && errno == EINTR);
    if (ended == pid_) {
        const int signal = WIFSIGNALED(raw) ? WTERMSIG(raw) : 0;
        end_ = ChildEnd{signal ? 128 + signal : WEXITSTATUS(raw), signal, seconds(),
                        static_cast<double>(used.ru_maxrss) / 1024};
    }
    return end_;
}

std::optional<ChildEnd> ChildProcess::poll() {
    return reap(WNOHANG);
}

ChildEnd ChildProcess::wait() {
    const auto end = reap(0);
    ensure(end.has_value(), "a child that was started can be waited for");
    return *end;
}

void ChildProcess::kill() const {
    ::kill(pid_, SIGKILL);
}

double ChildProcess::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

}  // namespace seampath
