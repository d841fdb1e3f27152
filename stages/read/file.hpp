#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

namespace seampath {

/// The bytes of a file, held in memory: a file that is cut short while it is being read is an error here, where a
/// mapped one would kill the program.
class FileBytes {
public:
    /// Throws InputError for what is missing, no regular file, unreadable, or too large for this machine's memory.
    explicit FileBytes(const std::filesystem::path& file);
    std::string_view view() const { return {bytes_.get(), size_}; }

private:
    std::unique_ptr<char[]> bytes_;
    std::size_t size_ = 0;
};

}  // namespace seampath
