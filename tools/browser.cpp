#include "tools/browser.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pipeline/files.hpp"
#include "pipeline/report_cells.hpp"
#include "stages/error.hpp"
#include "tools/stop_signal.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kBrowsers{"chromium", "chromium-browser", "google-chrome",
                                                    "google-chrome-stable"};
constexpr std::chrono::seconds kPatience{120};
constexpr std::size_t kMostPdfBytes = std::size_t{1} << 28;

fs::path find_browser() {
    const char* value = std::getenv("PATH");
    const std::string paths = value == nullptr ? "" : value;
    for (const std::string_view name : kBrowsers) {
        for (std::size_t from = 0; from < paths.size();) {
            const std::size_t end = std::min(paths.find(':', from), paths.size());
            fs::path candidate = fs::path(paths.substr(from, end - from)) / name;
            if (access(candidate.c_str(), X_OK) == 0 && fs::is_regular_file(candidate)) {
                return candidate;
            }
            from = end + 1;
        }
    }
    throw InputError(
        "report: no browser to print with was found: chromium, chromium-browser, google-chrome or google-chrome-stable "
        "on the PATH was needed; install one (Debian: apt install chromium), or open report.html and print it there");
}

/// A folder that vanishes with its content.
class ScratchFolder {
public:
    ScratchFolder() {
        std::string pattern = (fs::temp_directory_path() / "seampath-print-").string() + std::string(6, 'X');
        if (mkdtemp(pattern.data()) == nullptr) {
            throw InputError("report: cannot create a folder in " + fs::temp_directory_path().string() +
                             "; a writable one was needed; set TMPDIR");
        }
        path_ = pattern;
    }
    ~ScratchFolder() {
        std::error_code ignored;  // the browser's last processes may still write there
        fs::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

/// In a process group of its own, quiet.
pid_t start(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (auto& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        setpgid(0, 0);
        const int nowhere = open("/dev/null", O_RDWR);
        for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
            dup2(nowhere, stream);
        }
        execv(arguments[0], arguments.data());
        _exit(127);
    }
    return child;
}

/// Its exit status; ends it, with all that it started, when time is up or the program is asked to stop.
int wait_for(pid_t child) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
        const bool late = std::chrono::steady_clock::now() > end;
        if (late || stop_asked()) {
            kill(-child, SIGKILL);
            waitpid(child, &status, 0);
            if (!late) {
                throw Interrupted();
            }
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return status;
}

}  // namespace

std::string print_page(const fs::path& page) {
    const fs::path browser = find_browser();
    const ScratchFolder scratch;
    const fs::path pdf = scratch.path() / "page.pdf";
    std::vector<std::string> words{browser.string(),
                                   "--headless",
                                   "--use-angle=swiftshader",
                                   "--enable-unsafe-swiftshader",
                                   "--disable-background-networking",
                                   "--no-first-run",
                                   "--no-pdf-header-footer",
                                   "--blink-settings=preferredColorScheme=1",  // light
                                   "--virtual-time-budget=15000",  // for the 3D view; not a time that passes
                                   "--user-data-dir=" + (scratch.path() / "profile").string(),
                                   "--print-to-pdf=" + pdf.string()};
    if (geteuid() == 0) {
        words.emplace_back("--no-sandbox");  // Chromium refuses root without it
    }
    words.push_back("file://" + address(fs::absolute(page).string()));
    const int status = wait_for(start(std::move(words)));
    std::string bytes = fs::is_regular_file(pdf) ? read_file(pdf, kMostPdfBytes, "report") : std::string();
    if (!bytes.starts_with("%PDF-")) {
        throw InputError("report: " + browser.string() + " made no PDF of " + page.string() + " (its exit status is " +
                         std::to_string(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status)) +
                         "); a Chromium that can print was needed; open the page and print it there");
    }
    return bytes;
}

}  // namespace seampath
