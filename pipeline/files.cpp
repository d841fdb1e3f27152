#include "pipeline/files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stages/error.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannot_write(const fs::path& what, int error) {
    throw InputError(
        "output: cannot write " + what.string() + ": " + std::strerror(error) +
        "; a folder with write permission and free space was needed; free some space or choose another --out");
}

/// A descriptor that closes itself.
class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() { close(fd_); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

/// Writes and synchronises; returns 0 or the error number.
int write_synchronised(const fs::path& file, std::string_view content) {
    const Descriptor out(open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    if (out.get() < 0) {
        return errno;
    }
    while (!content.empty()) {
        const ssize_t written = ::write(out.get(), content.data(), content.size());
        if (written < 0 && errno != EINTR) {
            return errno;
        }
        content.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
    }
    return fsync(out.get()) == 0 ? 0 : errno;
}

/// Makes a rename durable. Some file systems can't synchronise a folder; the file itself is safe then, too.
void synchronise_folder(const fs::path& folder) {
    const Descriptor in(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    fsync(in.get());
}

/// "report.json.tmp.1234", as write() names its temporary files.
bool is_temporary(const fs::path& file) {
    const std::string name = file.filename().string();
    const auto at = name.rfind(".tmp.");
    return at != std::string::npos && at + 5 < name.size() &&
           name.find_first_not_of("0123456789", at + 5) == std::string::npos;
}

void remove_temporaries(const fs::path& folder) {
    std::error_code ignored;
    std::vector<fs::path> left;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        if (entry.is_regular_file(ignored) && is_temporary(entry.path())) {
            left.push_back(entry.path());
        }
    }
    for (const auto& file : left) {
        fs::remove(file, ignored);
    }
}

}  // namespace

std::string time_written(const fs::path& file) {
    struct stat status {};
    std::tm utc{};
    if (stat(file.c_str(), &status) != 0 || gmtime_r(&status.st_mtime, &utc) == nullptr) {
        return "";
    }
    char text[40];
    return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc)};
}

std::string read_file(const fs::path& file, std::size_t max_bytes, const std::string& who) {
    std::error_code error;
    const auto status = fs::status(file, error);
    if (!fs::exists(status)) {
        throw InputError(who + ": there is no file " + file.string() + "; check the path");
    }
    if (!fs::is_regular_file(status)) {
        throw InputError(who + ": " + file.string() + " is no regular file; a file was needed; check the path");
    }
    std::ifstream in(file, std::ios::binary);
    const auto size = fs::file_size(file, error);
    if (!in || error) {
        throw InputError(who + ": cannot read " + file.string() + ": " + std::strerror(errno) +
                         "; check its permissions");
    }
    if (size > max_bytes) {
        throw InputError(who + ": " + file.string() + " holds " + std::to_string(size) + " bytes; at most " +
                         std::to_string(max_bytes) + " were expected; check that it is the right file");
    }
    std::string text(size, '\0');
    in.read(text.data(), static_cast<std::streamsize>(size));
    text.resize(static_cast<std::size_t>(in.gcount()));
    return text;
}

RunFolder::RunFolder(fs::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) {
        cannot_write(folder_, error.value());
    }
    lock_ = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0 || access(folder_.c_str(), W_OK | X_OK) != 0) {
        const int reason = errno;
        close(lock_);
        cannot_write(folder_, reason);
    }
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        close(lock_);
        throw InputError("output: another run is writing into " + folder_.string() +
                         "; a folder of its own was needed; wait for it or choose another --out");
    }
    remove_temporaries(folder_);
    for (const auto& entry : fs::directory_iterator(folder_ / "programs", error)) {
        remove_temporaries(entry.path());
    }
}

RunFolder::~RunFolder() {
    close(lock_);
}

void RunFolder::write(const fs::path& name, std::string_view content) const {
    const fs::path file = folder_ / name;
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error) {
        cannot_write(file.parent_path(), error.value());
    }
    const fs::path temporary = file.string() + ".tmp." + std::to_string(getpid());
    int failure = write_synchronised(temporary, content);
    if (failure == 0 && rename(temporary.c_str(), file.c_str()) != 0) {
        failure = errno;
    }
    if (failure != 0) {
        unlink(temporary.c_str());
        cannot_write(file, failure);
    }
    synchronise_folder(file.parent_path());
}

void RunFolder::remove(const fs::path& name) const {
    std::error_code error;
    fs::remove_all(folder_ / name, error);
    if (error) {
        cannot_write(folder_ / name, error.value());
    }
}

}  // namespace seampath
