#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace seampath {

/// The content of a regular file of at most so many bytes. Throws InputError, beginning with `who`, when there is none,
/// it can't be read, or it is larger.
std::string read_file(const std::filesystem::path& file, std::size_t max_bytes, const std::string& who);

/// When a file was last written, to the minute: "2026-03-31 14:05 UTC". Empty when there is no such file.
std::string time_written(const std::filesystem::path& file);

/// A folder that one run writes into. Every file appears whole or not at all: it is written under a temporary name in
/// the same folder, synchronised and renamed. A failed or killed write never leaves a file that looks finished.
class RunFolder {
public:
    /// Creates the folder, locks it against a second run, and removes temporary files that a killed run left.
    /// Throws InputError when it can't be created or written to, or another run holds it.
    explicit RunFolder(std::filesystem::path folder);
    ~RunFolder();
    RunFolder(const RunFolder&) = delete;
    RunFolder& operator=(const RunFolder&) = delete;

    /// Writes one file; folders in `name` are created. Throws InputError when the disk is full or refuses.
    void write(const std::filesystem::path& name, std::string_view content) const;

    /// Removes a file or folder of an earlier run; nothing happens if there is none.
    void remove(const std::filesystem::path& name) const;

    const std::filesystem::path& path() const { return folder_; }

private:
    std::filesystem::path folder_;
    int lock_ = -1;
};

}  // namespace seampath
