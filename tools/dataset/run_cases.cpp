#include "tools/dataset/run_cases.hpp"

#include <csignal>
#include <cstring>
#include <fstream>
#include <iostream>
#include <list>
#include <map>
#include <thread>

#include <unistd.h>

#include "pipeline/digest.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"
#include "tools/dataset/child_process.hpp"
#include "tools/dataset/suite_commands.hpp"
#include "tools/stop_signal.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "/proc/self/exe";
constexpr const char* kResultFile = "result.json";
constexpr std::string_view kClear = "\r\033[K";

std::string name_of(const CaseJob& job) {
    return job.entry->id + " seed " + std::to_string(job.seed);
}

std::string last_line(const fs::path& file) {
    std::ifstream in(file);
    std::string last;
    for (std::string line; std::getline(in, line);) {
        last = line.empty() ? last : line;
    }
    return last;
}

/// What the process that ran the job left.
CaseRun ended_run(const CaseJob& job, const ChildEnd& end, bool too_long) {
    CaseRun run;
    run.id = job.entry->id;
    run.seed = job.seed;
    if (too_long) {
        run.status = RunStatus::time;
        run.message = "took longer than the " + shortest(job.entry->time_s) + " s that the case may";
    } else if (end.status == kChildOutOfMemory) {
        run.status = RunStatus::memory;
        run.message = "needed more than the " + shortest(job.entry->memory_mb) + " MB that the case may have";
    } else if (end.status != 0) {
        const std::string said = last_line(job.folder / "log.txt");
        run.status = RunStatus::crashed;
        run.message = end.signal ? std::string("ended by a signal: ") + strsignal(end.signal)
                                 : "ended with exit status " + std::to_string(end.status);
        run.message += said.empty() ? "" : "; its last line: " + said;
    } else {
        return read_case_run(job.folder / kResultFile);
    }
    return run;
}

/// Bar and lines on stderr.
class SuiteProgress {
public:
    explicit SuiteProgress(std::size_t all) : all_(all), terminal_(isatty(STDERR_FILENO) == 1) {}

    void ended(const std::string& name, const std::string& how, double seconds) {
        ++done_;
        std::cerr << (terminal_ ? kClear : "") << "[" << done_ << "/" << all_ << "] " << name << ": " << how << "; "
                  << fixed(seconds, 1) << " s" << std::endl;
    }

    void draw(const std::string& at_work) const {
        if (terminal_) {
            constexpr std::size_t kWidth = 30;
            const std::size_t full = all_ ? kWidth * done_ / all_ : kWidth;
            std::cerr << kClear << "[" << std::string(full, '#') << std::string(kWidth - full, '.') << "] " << done_
                      << "/" << all_ << " " << at_work << std::flush;
        }
    }

    void clear() const { std::cerr << (terminal_ ? kClear : "") << std::flush; }

private:
    std::size_t all_, done_ = 0;
    bool terminal_;
};

struct RunningCase {
    std::size_t index;
    bool too_long = false;
    ChildProcess process;

    RunningCase(std::size_t i, const std::vector<std::string>& words, const fs::path& log, double memory_mb)
        : index(i), process(words, log, memory_mb) {}
};

/// A run that is done already; nothing where there is none of this key.
std::optional<CaseRun> stored_run(const CaseJob& job) {
    const fs::path file = job.folder / kResultFile;
    if (!fs::exists(file)) {
        return std::nullopt;
    }
    try {
        CaseRun run = read_case_run(file);
        return run.key == run_key(*job.entry, job.seed, build_id()) ? std::optional(std::move(run)) : std::nullopt;
    } catch (const InputError&) {  // half written, or of another build
        return std::nullopt;
    }
}

class Runner {
public:
    Runner(const fs::path& suite_file, const std::vector<CaseJob>& jobs, bool resume)
        : suite_file_(suite_file), jobs_(jobs), resume_(resume), runs_(jobs.size()), progress_(jobs.size()) {}

    std::vector<CaseRun> run(std::size_t at_once) {
        while (next_ < jobs_.size() || !running_.empty()) {
            while (next_ < jobs_.size() && running_.size() < at_once) {
                begin(next_++);
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            if (stop_asked()) {
                progress_.clear();
                throw Interrupted();
            }
            poll();
        }
        progress_.clear();
        return std::move(runs_);
    }

private:
    void begin(std::size_t i) {
        const CaseJob& job = jobs_[i];
        CaseRun& run = runs_[i];
        run.id = job.entry->id;
        run.seed = job.seed;
        run.message = problem_of(*job.entry);
        if (!run.message.empty()) {
            run.status = RunStatus::data;
            progress_.ended(name_of(job), run.message, 0);
            return;
        }
        if (auto stored = resume_ ? stored_run(job) : std::nullopt) {
            run = std::move(*stored);
            progress_.ended(name_of(job), run.outcome + " (resumed)", 0);
            return;
        }
        fs::remove_all(job.folder);
        fs::create_directories(job.folder);
        const std::vector<std::string> words{
            kProgram, "dataset",          "case", suite_file_.string(), job.entry->id, std::to_string(job.seed),
            "--out",  job.folder.string()};
        running_.emplace_back(i, words, job.folder / "log.txt", job.entry->memory_mb);
    }

    void poll() {
        std::string at_work;
        for (auto one = running_.begin(); one != running_.end();) {
            const CaseJob& job = jobs_[one->index];
            if (!one->too_long && one->process.seconds() > job.entry->time_s) {
                one->too_long = true;
                one->process.kill();
            }
            if (const auto end = one->process.poll()) {
                CaseRun& run = runs_[one->index] = ended_run(job, *end, one->too_long);
                progress_.ended(name_of(job), run.status == RunStatus::done ? run.outcome : run.message, end->seconds);
                one = running_.erase(one);
            } else {
                at_work += (at_work.empty() ? "" : ", ") + name_of(job) + " " + fixed(one->process.seconds(), 0) + " s";
                ++one;
            }
        }
        progress_.draw(at_work);
    }

    /// Files are read once a case.
    const std::string& problem_of(const SuiteCase& entry) {
        const auto [found, fresh] = problems_.try_emplace(entry.id);
        if (fresh) {
            found->second = data_problem(entry);
        }
        return found->second;
    }

    const fs::path& suite_file_;
    const std::vector<CaseJob>& jobs_;
    bool resume_;
    std::vector<CaseRun> runs_;
    SuiteProgress progress_;
    std::size_t next_ = 0;
    std::list<RunningCase> running_;
    std::map<std::string, std::string> problems_;
};

}  // namespace

std::vector<CaseRun> run_cases(const fs::path& suite_file, const std::vector<CaseJob>& jobs, int at_once, bool resume) {
    return Runner(suite_file, jobs, resume).run(static_cast<std::size_t>(at_once));
}

}  // namespace seampath
