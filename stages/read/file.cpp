#include "stages/read/file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stages/error.hpp"
#include "stages/read/parallel.hpp"

namespace seampath {
namespace {

constexpr std::size_t kBlockBytes = 1 << 22;

[[noreturn]] void fail_on(const std::filesystem::path& file, const std::string& what) {
    throw InputError("read: " + file.string() + ": " + what);
}

std::string reason(int error) {
    return std::generic_category().message(error);
}

class Descriptor {
public:
    explicit Descriptor(const std::filesystem::path& file)
        : fd_(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
        if (fd_ < 0) {
            fail_on(file, "cannot be opened: " + reason(errno) +
                              "; expected a readable scan file; check the path and permissions");
        }
    }
    ~Descriptor() { ::close(fd_); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

/// Scan and points together take up to about twice the size of the file.
void check_fits_memory(const std::filesystem::path& file, std::size_t size) {
    const long pages = ::sysconf(_SC_PHYS_PAGES);
    const long page = ::sysconf(_SC_PAGESIZE);
    if (pages > 0 && page > 0 && size / 2 > static_cast<std::size_t>(pages) / 4 * static_cast<std::size_t>(page)) {
        fail_on(file, "has " + std::to_string(size) +
                          " bytes, more than half of this machine's memory; thin or split the scan");
    }
}

void read_block(const std::filesystem::path& file, int fd, char* to, std::size_t begin, std::size_t end) {
    while (begin < end) {
        const ssize_t got = ::pread(fd, to + begin, end - begin, static_cast<off_t>(begin));
        if (got < 0 && errno != EINTR) {
            fail_on(file,
                    "cannot be read at byte " + std::to_string(begin) + ": " + reason(errno) + "; check the disk");
        }
        if (got == 0) {
            fail_on(file, "became shorter while it was read; wait until it is written and run again");
        }
        begin += got > 0 ? static_cast<std::size_t>(got) : 0;
    }
}

}  // namespace

FileBytes::FileBytes(const std::filesystem::path& file) {
    const Descriptor fd(file);
    struct stat status {};
    if (::fstat(fd.get(), &status) != 0) {
        fail_on(file, "cannot be examined: " + reason(errno) + "; check the path and permissions");
    }
    if (S_ISDIR(status.st_mode)) {
        fail_on(file, "is a folder; expected a scan file; name the file in it");
    }
    if (!S_ISREG(status.st_mode)) {
        fail_on(file, "is no regular file; expected a scan file on a disk; save it first");
    }
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ == 0) {
        fail_on(file, "is empty (0 bytes); expected a scan; export or copy the file again");
    }
    check_fits_memory(file, size_);
    bytes_ = std::make_unique_for_overwrite<char[]>(size_);
    for_each_block((size_ + kBlockBytes - 1) / kBlockBytes, [&](std::size_t block) {
        read_block(file, fd.get(), bytes_.get(), block * kBlockBytes, std::min(size_, (block + 1) * kBlockBytes));
    });
}

}  // namespace seampath
