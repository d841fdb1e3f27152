#include <filesystem>
#include <fstream>

#include <sys/stat.h>
#include <unistd.h>

#include "tests/read/support.hpp"

namespace seampath::read_test {
namespace file_test {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class ReadFile : public ::testing::Test {
protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "seampath-read-XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

    static std::string error_of_file(const fs::path& file) {
        try {
            read(file, in_mm());
        } catch (const InputError& error) {
            return error.what();
        }
        ADD_FAILURE() << "no InputError";
        return {};
    }

    fs::path folder_;
};

const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
    "end_header\n1 2 3\n";
const std::string kPcd = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nDATA ascii\n1 2 3\n";
const std::string kStl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\n"
    "endfacet\nendsolid a\n";

TEST_F(ReadFile, TheExtensionNamesTheFormatInAnyCase) {
    EXPECT_EQ(read(write("a.ply", kPly), in_mm()).format, "ply ascii");
    EXPECT_EQ(read(write("a.PCD", kPcd), in_mm()).format, "pcd ascii");
    EXPECT_EQ(read(write("a.Stl", kStl), in_mm()).format, "stl ascii");
    EXPECT_EQ(read(write("a.obj", "v 1 2 3\n"), in_mm()).format, "obj (vertices)");
    for (const std::string name : {"a.xyz", "a.csv", "a.asc", "a.txt"}) {
        EXPECT_EQ(read(write(name, "1 2 3\n"), in_mm()).format, "text");
    }
}

TEST_F(ReadFile, TheContentNamesTheFormatOfAnUnknownExtension) {
    EXPECT_EQ(read(write("a", kPly), in_mm()).format, "ply ascii");
    EXPECT_EQ(read(write("a.dat", kPcd), in_mm()).format, "pcd ascii");
    EXPECT_EQ(read(write("b.dat", kPcd.substr(12)), in_mm()).format, "pcd ascii");
    EXPECT_EQ(read(write("a.3d", kStl), in_mm()).format, "stl ascii");
    const std::string facet = packed(0.F, 0.F, 0.F, 0.F, 0.F, 0.F, 9.F, 0.F, 0.F, 0.F, 9.F, 0.F) + std::string(2, '\0');
    EXPECT_EQ(read(write("b.3d", std::string(80, '\0') + packed(std::uint32_t{1}) + facet), in_mm()).format,
              "stl binary");
    EXPECT_EQ(read(write("a.geo", "# part\no part\nv 1 2 3\n"), in_mm()).format, "obj (vertices)");
    EXPECT_EQ(read(write("a.pts", "-1.5;2;3\n"), in_mm()).format, "text");
    EXPECT_THAT(
        error_of_file(write("a.doc", "Dear Sir\n")),
        HasSubstr("a.doc: extension '.doc' is not known and the content tells no format; expected one of .ply .pcd"));
    EXPECT_THAT(error_of_file(write("a.bin", std::string("1 2\0 3\n", 7))), HasSubstr("the content tells no format"));
}

TEST_F(ReadFile, TheScanIsNamedAfterTheFile) {
    EXPECT_EQ(read(write("part 7.b.ply", kPly), in_mm()).name, "part 7.b");
}

TEST_F(ReadFile, AFileLargerThanABlockIsReadWhole) {
    std::string text;
    for (int i = 0; i < 500'000; ++i) {
        text += std::to_string(i) + " 2 3\n";
    }
    ASSERT_GT(text.size(), std::size_t{1} << 22);
    const Scan scan = read(write("a.xyz", text), in_mm());
    ASSERT_EQ(scan.points.size(), 500'000U);
    EXPECT_EQ(scan.points.back().x(), 499'999);
}

TEST_F(ReadFile, ErrorsNameTheFile) {
    EXPECT_THAT(
        error_of_file(folder_ / "none.ply"),
        EndsWith("none.ply: cannot be opened: No such file or directory; expected a readable scan file; check the "
                 "path and permissions"));
    EXPECT_THAT(error_of_file(folder_), HasSubstr("is a folder; expected a scan file; name the file in it"));
    EXPECT_THAT(error_of_file("/dev/null"), HasSubstr("/dev/null: is no regular file"));
    EXPECT_THAT(error_of_file(write("a.ply", "")),
                EndsWith("a.ply: is empty (0 bytes); expected a scan; export or copy the file "
                         "again"));
    EXPECT_THAT(error_of_file(write("b.ply", kPcd)),
                HasSubstr("b.ply: byte 0: the file does not begin with the line 'ply'"));
    ASSERT_EQ(::mkfifo((folder_ / "pipe.ply").c_str(), 0600), 0);
    EXPECT_THAT(error_of_file(folder_ / "pipe.ply"), HasSubstr("is no regular file"));
}

TEST_F(ReadFile, AnUnreadableFileIsAnError) {
    const fs::path file = write("a.ply", kPly);
    fs::permissions(file, fs::perms::none);
    if (::access(file.c_str(), R_OK) == 0) {
        GTEST_SKIP() << "this user may read every file";
    }
    EXPECT_THAT(error_of_file(file), HasSubstr("cannot be opened: Permission denied"));
}

TEST_F(ReadFile, AFileLargerThanTheMemoryIsRefusedBeforeItIsRead) {
    const fs::path file = write("a.ply", kPly);
    fs::resize_file(file, std::uintmax_t{1} << 43);
    EXPECT_THAT(error_of_file(file), HasSubstr("has 8796093022208 bytes, more than half of this machine's memory"));
}

/// A row of points 0 to `extent` along z.
std::string row_of(double extent, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) {
        text += "0 0 " + std::to_string(extent * i / (count - 1)) + "\n";
    }
    return text;
}

std::string as_pcd(const std::string& rows, int count) {
    return "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH " + std::to_string(count) + "\nDATA ascii\n" + rows;
}

TEST(ReadUnit, FollowsFromTheSizeOfTheScan) {
    const Scan mm = read_string(row_of(20, 11), ScanFormat::text, {});
    EXPECT_EQ(mm.mm_per_unit, 1);
    EXPECT_EQ(mm.unit_reason, "largest extent 20 is 20 or more: millimetres");
    const Scan metres = read_string(row_of(1.9375, 11), ScanFormat::text, {});
    EXPECT_EQ(metres.mm_per_unit, 1000);
    EXPECT_EQ(metres.unit_reason, "largest extent 1.938 is below 2: metres");
    EXPECT_EQ(metres.points.back().z(), 1937.5F);
    const std::string between = row_of(2, 11);
    EXPECT_EQ(error_of(between, ScanFormat::text, {}),
              "read: part: largest extent 2 does not tell its unit; 20 or more is taken as mm and below 2 as m; set "
              "read.unit "
              "to mm, m or inch");
    const Scan pcd = read_string(as_pcd(between, 11), ScanFormat::pcd, {});
    EXPECT_EQ(pcd.mm_per_unit, 1000);
    EXPECT_EQ(pcd.unit_reason,
              "largest extent 2 is between 2 and 20 in a PCD file, whose convention is metres: metres");
    EXPECT_THAT(error_of("v 0 0 0\nv 19.9 0 0\nv 0 1 0\nf 1 2 3\n", ScanFormat::obj, {}),
                HasSubstr("largest extent 19.9 does"));
}

TEST(ReadUnit, IsTheOneThatTheOptionNames) {
    const std::string rows = row_of(5, 11);
    const Scan mm = read_string(rows, ScanFormat::text, {.unit = Unit::mm});
    EXPECT_EQ(mm.points.back().z(), 5);
    EXPECT_EQ(mm.unit_reason, "read.unit is mm");
    EXPECT_EQ(read_string(rows, ScanFormat::text, {.unit = Unit::m}).points.back().z(), 5000);
    const Scan inch = read_string(rows, ScanFormat::text, {.unit = Unit::inch});
    EXPECT_EQ(inch.points.back().z(), 127);
    EXPECT_EQ(inch.mm_per_unit, 25.4);
    EXPECT_EQ(inch.unit_reason, "read.unit is inch");
}

TEST(ReadUnit, ANamedUnitThatTheSizeSpeaksAgainstIsFlagged) {
    EXPECT_EQ(read_string(row_of(0.5, 11), ScanFormat::text, {.unit = Unit::mm}).unit_reason,
              "read.unit is mm, though largest extent 0.5 is below 2: metres");
    EXPECT_EQ(read_string(row_of(400, 11), ScanFormat::text, {.unit = Unit::m}).unit_reason,
              "read.unit is m, though largest extent 400 is 20 or more: millimetres");
    EXPECT_EQ(read_string(row_of(400, 11), ScanFormat::text, {.unit = Unit::mm}).unit_reason, "read.unit is mm");
    EXPECT_EQ(read_string(row_of(30, 11), ScanFormat::text, {.unit = Unit::inch}).unit_reason, "read.unit is inch");
}

TEST(ReadUnit, AFewStrayReturnsDoNotSpeakForThePart) {
    const std::string part = row_of(0.5, 5000);
    EXPECT_EQ(read_string(part + "900 0 0\n0 -900 0\n", ScanFormat::text, {}).mm_per_unit, 1000);
    EXPECT_EQ(read_string(row_of(0.5, 20) + "900 0 0\n", ScanFormat::text, {}).mm_per_unit, 1)
        << "one of 21 is no stray";
}

TEST(ReadOptionsFields, AreDescribedOnce) {
    ReadOptions options;
    const Fields fields = describe(options);
    ASSERT_EQ(fields.size(), 2U);
    EXPECT_EQ(fields[0].key, "unit");
    const auto& unit = std::get<Choice>(fields[0].value);
    EXPECT_THAT(unit.names, ::testing::ElementsAre("auto", "mm", "m", "inch"));
    unit.set(2);
    EXPECT_EQ(options.unit, Unit::m);
    EXPECT_EQ(fields[1].key, "mesh_spacing_mm");
    EXPECT_EQ(std::get<double*>(fields[1].value), &options.mesh_spacing_mm);
    EXPECT_TRUE(fields[1].bounds.low == 0 && fields[1].bounds.low_open);
}

}  // namespace file_test
}  // namespace seampath::read_test
