#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/read/support.hpp"

/// Whatever the bytes, a reader gives a whole scan or an InputError, within a second. The files in tests/corpus are the
/// seeds of the fuzzers, and what these found.
namespace seampath::read_test {
namespace hostile_test {

namespace fs = std::filesystem;

struct Seed {
    std::string name;
    ScanFormat format;
    std::string bytes;
};

std::string bytes_in(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<Seed> corpus() {
    const fs::path folder = fs::path(SEAMPATH_SOURCE_DIR) / "tests" / "corpus";
    std::vector<Seed> seeds;
    for (const auto& [name, format] :
         {std::pair{"ply", ScanFormat::ply}, std::pair{"pcd", ScanFormat::pcd}, std::pair{"text", ScanFormat::text},
          std::pair{"stl", ScanFormat::stl}, std::pair{"obj", ScanFormat::obj}}) {
        for (const auto& entry : fs::directory_iterator(folder / name)) {
            seeds.push_back(
                {std::string(name) + "/" + entry.path().filename().string(), format, bytes_in(entry.path())});
        }
    }
    std::sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.name < b.name; });
    return seeds;
}

/// Reads the bytes as they are; true for a scan. The mesh spacing keeps damaged coordinates from making millions of
/// points.
bool is_scan(const std::string& bytes, ScanFormat format, Unit unit = Unit::mm) {
    const ReadOptions options{.unit = unit, .mesh_spacing_mm = 5};
    try {
        expect_invariants(read_string(bytes, format, options));
        return true;
    } catch (const InputError& error) {
        EXPECT_TRUE(std::string_view(error.what()).starts_with("read: part: ")) << error.what();
        return false;
    }
}

TEST(ReadHostile, EveryFileOfTheCorpusIsAScanOrAnErrorWithinASecond) {
    const auto seeds = corpus();
    EXPECT_GE(seeds.size(), 50U);
    for (const Seed& seed : seeds) {
        SCOPED_TRACE(seed.name);
        const auto begin = std::chrono::steady_clock::now();
        const bool scan = is_scan(seed.bytes, seed.format);
        is_scan(seed.bytes, seed.format, Unit::automatic);
        EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(SEAMPATH_SLOWDOWN));
        const std::string_view file = std::string_view(seed.name).substr(seed.name.find('/') + 1);
        if (file.starts_with("good_")) {
            EXPECT_TRUE(scan);
        } else if (file.starts_with("bad_")) {
            EXPECT_FALSE(scan);
        }
    }
}

TEST(ReadHostile, FilesCutAtEveryByte) {
    for (const Seed& seed : corpus()) {
        SCOPED_TRACE(seed.name);
        for (std::size_t size = 0; size < std::min<std::size_t>(seed.bytes.size(), 2000); ++size) {
            SCOPED_TRACE(size);
            is_scan(seed.bytes.substr(0, size), seed.format);
        }
    }
}

TEST(ReadHostile, BinaryFilesCutAnywhereBehindTheHeaderAreErrors) {
    for (const Seed& seed : corpus()) {
        const bool binary = seed.name.find("/good_binary") != std::string::npos;
        for (std::size_t size = seed.bytes.size() / 2; binary && size < seed.bytes.size(); ++size) {
            EXPECT_FALSE(is_scan(seed.bytes.substr(0, size), seed.format)) << seed.name << " cut at " << size;
        }
    }
}

/// Changes, doubles, removes or swaps a few bytes.
std::string mutated(std::string bytes, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return random() % std::max<std::size_t>(1, n); };
    const std::size_t changes = 1 + below(4);
    for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
        const std::size_t at = below(bytes.size());
        const std::size_t length = 1 + below(std::min<std::size_t>(16, bytes.size() - at));
        switch (below(6)) {
            case 0:
                bytes[at] = static_cast<char>(random());
                break;
            case 1:
                bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
                break;
            case 2:
                bytes.erase(at, length);
                break;
            case 3:
                bytes.insert(at, bytes.substr(at, length));
                break;
            case 4:
                std::swap(bytes[at], bytes[below(bytes.size())]);
                break;
            default:
                bytes.replace(at, length, random() % 2 ? "99999999999" : "-1");
                break;
        }
    }
    return bytes;
}

TEST(ReadHostile, ThousandsOfSmallDamages) {
    std::mt19937 random(20'240'517);
    const auto seeds = corpus();
    for (int round = 0; round < 20'000; ++round) {
        const Seed& seed = seeds[random() % seeds.size()];
        const std::string bytes = mutated(seed.bytes, random);
        SCOPED_TRACE(seed.name + ", round " + std::to_string(round));
        is_scan(bytes, seed.format);
        if (::testing::Test::HasFailure()) {
            return;
        }
    }
}

}  // namespace hostile_test
}  // namespace seampath::read_test
