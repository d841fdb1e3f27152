#include "tools/output.hpp"

#include "pipeline/files.hpp"
#include "stages/error.hpp"

namespace seampath {

void write_output(const std::filesystem::path& file, std::string_view content) {
    if (!file.has_filename() || std::filesystem::is_directory(file)) {
        throw InputError("--out: \"" + file.string() + "\" is no file name; name the file to write");
    }
    RunFolder(std::filesystem::absolute(file).parent_path()).write(file.filename(), content);
}

}  // namespace seampath
