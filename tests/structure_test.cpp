#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

/// Includes point one way: tools -> datasets -> pipeline -> stages/<stage> -> stages/geometry -> stages/*.hpp. A stage
/// never includes another stage, nobody outside a stage includes its private headers, and no header drags PCL, CGAL or
/// OpenCV in.
namespace seampath {
namespace structure_test {

namespace fs = std::filesystem;

// Where a file stands: the folder that rules are about, e.g. "tools", "stages", "stages/plan".
std::string place_of(const std::string& path) {
    const auto first = path.find('/');
    if (first == std::string::npos) {
        return "";
    }
    const auto second = path.find('/', first + 1);
    const bool in_stage = path.starts_with("stages/") && second != std::string::npos;
    return path.substr(0, in_stage ? second : first);
}

// Higher may include lower; equals only their own place.
int height_of(const std::string& place) {
    static const std::array<std::string_view, 6> kFromBelow{"stages",   "stages/geometry", "a stage",
                                                            "pipeline", "datasets",        "tools"};
    const bool stage = place.starts_with("stages/") && place != "stages/geometry";
    const auto found = std::find(kFromBelow.begin(), kFromBelow.end(), stage ? "a stage" : place);
    return found == kFromBelow.end() ? -1 : static_cast<int>(found - kFromBelow.begin());
}

// stages/plan/plan.hpp is what others may know of stages/plan; all of geometry, and of what is no stage, is public.
bool is_public(const std::string& header) {
    const std::string place = place_of(header);
    if (height_of(place) != height_of("stages/plan")) {
        return true;
    }
    const std::string stage = place.substr(place.find('/') + 1);
    return header == place + "/" + stage + ".hpp";
}

// Why `file` may not include `included` (as written, without the brackets or quotes), or nothing.
std::string fault(const std::string& file, const std::string& included, bool angled) {
    if (angled) {
        const bool heavy =
            included.starts_with("pcl/") || included.starts_with("CGAL/") || included.starts_with("opencv");
        return heavy && file.ends_with(".hpp") ? "a header must not include PCL, CGAL or OpenCV" : "";
    }
    const std::string from = place_of(file), to = place_of(included);
    if (height_of(to) < 0) {
        return "quoted includes are written from the root of the repository";
    }
    if (from == to) {
        return "";
    }
    if (height_of(to) >= height_of(from)) {
        return from + " must not know " + to;
    }
    return is_public(included) ? "" : included + " is private to " + to;
}

struct Include {
    std::string name;
    bool angled;
};

std::vector<Include> includes_of(const fs::path& file) {
    std::vector<Include> includes;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with("#include ")) {
            continue;
        }
        const auto open = line.find_first_of("<\"");
        const auto close = line.find_first_of(">\"", open + 1);
        includes.push_back({line.substr(open + 1, close - open - 1), line[open] == '<'});
    }
    return includes;
}

TEST(Structure, IncludesPointOneWay) {
    const fs::path root = SEAMPATH_SOURCE_DIR;
    int files = 0;
    for (const char* folder : {"stages", "pipeline", "datasets", "tools"}) {
        if (!fs::exists(root / folder)) {
            continue;
        }
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".hpp" && extension != ".cpp") {
                continue;
            }
            ++files;
            const std::string file = fs::relative(entry.path(), root).generic_string();
            for (const Include& include : includes_of(entry.path())) {
                EXPECT_EQ(fault(file, include.name, include.angled), "") << file << " includes " << include.name;
            }
        }
    }
    EXPECT_GT(files, 20) << "the sources were found";
}

// The rules themselves, so that the test above can fail.
TEST(Structure, RulesAllowAndForbid) {
    struct Rule {
        const char* file;
        const char* included;
        bool angled;
        bool allowed;
    };
    const std::vector<Rule> rules{
        {"stages/plan/plan.cpp", "stages/plan/air.hpp", false, true},
        {"stages/plan/plan.cpp", "stages/geometry/bspline.hpp", false, true},
        {"stages/plan/plan.hpp", "stages/types.hpp", false, true},
        {"stages/geometry/pose.cpp", "stages/error.hpp", false, true},
        {"stages/options.hpp", "stages/types.hpp", false, true},
        {"pipeline/run.cpp", "stages/plan/plan.hpp", false, true},
        {"pipeline/run.cpp", "pipeline/config.hpp", false, true},
        {"datasets/scanner.cpp", "stages/geometry/bspline.hpp", false, true},
        {"tools/run.cpp", "datasets/scanner.hpp", false, true},
        {"stages/read/ply.cpp", "pcl/io/ply_io.h", true, true},
        {"stages/plan/plan.hpp", "vector", true, true},
        {"stages/plan/plan.cpp", "stages/fit/fit.hpp", false, false},
        {"stages/geometry/pose.cpp", "stages/plan/plan.hpp", false, false},
        {"stages/types.hpp", "stages/geometry/pose.hpp", false, false},
        {"stages/plan/plan.cpp", "pipeline/config.hpp", false, false},
        {"pipeline/run.cpp", "stages/plan/air.hpp", false, false},
        {"pipeline/run.cpp", "datasets/scanner.hpp", false, false},
        {"datasets/scanner.cpp", "tools/cli.hpp", false, false},
        {"tools/run.cpp", "stages/export/format.hpp", false, false},
        {"stages/plan/plan.cpp", "air.hpp", false, false},
        {"stages/plan/plan.cpp", "tests/plan/models.hpp", false, false},
        {"stages/read/read.hpp", "pcl/point_cloud.h", true, false},
        {"pipeline/image.hpp", "opencv2/core.hpp", true, false},
        {"stages/geometry/mesh.hpp", "CGAL/Surface_mesh.h", true, false},
    };
    for (const Rule& rule : rules) {
        EXPECT_EQ(fault(rule.file, rule.included, rule.angled).empty(), rule.allowed)
            << rule.file << " includes " << rule.included;
    }
}

}  // namespace structure_test
}  // namespace seampath
