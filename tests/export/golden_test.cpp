#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "stages/export/export.hpp"
#include "tests/export/plans.hpp"

/// Programs of one small plan, byte for byte. After a change that is meant, run the tests once with
/// SEAMPATH_UPDATE_GOLDEN=1 in the environment, and review the difference of tests/golden as you would review code.
namespace seampath {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

void expect_golden(const std::string& folder, const ExportOptions& options) {
    const fs::path golden = fs::path(SEAMPATH_SOURCE_DIR) / "tests" / "golden" / folder;
    const char* update = std::getenv("SEAMPATH_UPDATE_GOLDEN");
    for (const ProgramFile& file : export_programs(test::golden_plan(), options)) {
        if (update != nullptr && std::string(update) == "1") {
            fs::create_directories(golden);
            std::ofstream(golden / file.file_name, std::ios::binary) << file.content;
        }
        ASSERT_TRUE(fs::exists(golden / file.file_name)) << "make it with SEAMPATH_UPDATE_GOLDEN=1";
        EXPECT_EQ(file.content, content(golden / file.file_name)) << "if meant: SEAMPATH_UPDATE_GOLDEN=1";
    }
}

TEST(Golden, ProgramsThatWeldInAMovedFrame) {
    ExportOptions options;
    options.program_name = "golden";
    options.abb_tool = "tTorch";
    options.abb_work_object = "wPart";
    options.abb_seam_data = "seam1";
    options.abb_weld_data = "weld1";
    options.ur_tcp = {0, -12.5, 380, 0, 0.5, 0};
    options.ur_arc_output = 3;
    options.base_from_scan = {1200, -340, 75.5, 0.5, 0.5, -0.5, 0.5};
    expect_golden("weld", options);
}

TEST(Golden, ProgramsThatOnlyMove) {
    ExportOptions options;
    options.program_name = "golden";
    expect_golden("move", options);
}

}  // namespace
}  // namespace seampath
