#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "datasets/dataset.hpp"
#include "tests/test_folder.hpp"

/// Folders and scans for the tests of runs.
namespace seampath {

inline std::string text_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Content of every file below a folder, by its path from there.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) {
            files[entry.path().lexically_relative(folder).string()] = text_of(entry.path());
        }
    }
    return files;
}

/// Names and bytes of all files; a difference is shown by its name, not by megabytes of text.
inline void expect_same_files(const std::filesystem::path& a, const std::filesystem::path& b) {
    const auto files_a = contents(a);
    const auto files_b = contents(b);
    for (const auto& [name, text] : files_a) {
        EXPECT_TRUE(files_b.contains(name)) << name << " is in the first folder only";
        EXPECT_TRUE(!files_b.contains(name) || files_b.at(name) == text) << name << " differs";
    }
    for (const auto& [name, text] : files_b) {
        EXPECT_TRUE(files_a.contains(name)) << name << " is in the second folder only";
    }
}

/// These tests are about runs, not accuracy: the small, coarse tee passes whatever extraction makes of it.
inline constexpr double kLooseToleranceMm = 3;

/// scan.ply and truth.json of a tee small and coarse enough for many runs.
inline void write_small_tee(const std::filesystem::path& folder) {
    SceneOptions scene;
    scene.length_mm = 40;
    scene.margin_mm = 15;
    ScannerOptions scanner;
    scanner.pitch_x_mm = 0.5;
    scanner.pitch_y_mm = 0.5;
    write_dataset(make_dataset(scene, scanner, 1), folder);
}

}  // namespace seampath
