#include <liblzf/lzf.h>

#include "tests/read/support.hpp"

namespace seampath::read_test {
namespace pcd_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr auto kPcd = ScanFormat::pcd;

struct Layout {
    std::string fields = "x y z";
    std::string size = "4 4 4";
    std::string type = "F F F";
    std::string count = "1 1 1";
    std::string width = "2";
    std::string height = "1";
    std::string points = "2";
    std::string viewpoint = "0 0 0 1 0 0 0";
};

std::string header(const std::string& data, const Layout& l = {}) {
    return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + l.fields + "\nSIZE " + l.size +
           "\nTYPE " + l.type + "\nCOUNT " + l.count + "\nWIDTH " + l.width + "\nHEIGHT " + l.height + "\nVIEWPOINT " +
           l.viewpoint + "\nPOINTS " + l.points + "\nDATA " + data + "\n";
}

std::string compressed(const std::string& plain) {
    std::string out(plain.size() * 2 + 64, '\0');
    out.resize(
        lzf_compress(plain.data(), static_cast<unsigned>(plain.size()), out.data(), static_cast<unsigned>(out.size())));
    return packed(static_cast<std::uint32_t>(out.size()), static_cast<std::uint32_t>(plain.size())) + out;
}

const std::vector<Eigen::Vector3d> kTwoPoints{{1, 2, 3}, {4, 5, 6}};

TEST(ReadPcd, Ascii) {
    const Scan scan = read_string(header("ascii") + "1 2 3\n4 5 6\n", kPcd);
    EXPECT_EQ(positions(scan), kTwoPoints);
    EXPECT_EQ(scan.format, "pcd ascii");
    EXPECT_EQ(scan.width, 0U);
    EXPECT_TRUE(scan.pixel.empty());
    EXPECT_FALSE(scan.sensor_mm);
}

TEST(ReadPcd, BinaryOfEveryType) {
    const Layout layout{.fields = "pad z normal y x", .size = "1 8 2 4 4", .type = "U F I I F", .count = "3 1 2 1 1"};
    const auto record = [](double z, std::int32_t y, float x) {
        return std::string("abc") + packed(z, std::int16_t{9}, std::int16_t{9}, y, x);
    };
    const Scan scan = read_string(header("binary", layout) + record(3, 2, 1) + record(6, 5, 4), kPcd);
    EXPECT_EQ(positions(scan), kTwoPoints);
    EXPECT_EQ(scan.format, "pcd binary");
    const Layout small{.size = "1 2 8", .type = "I U I"};
    const std::string two = packed(std::int8_t{-1}, std::uint16_t{65535}, std::int64_t{3}) +
                            packed(std::int8_t{4}, std::uint16_t{5}, std::int64_t{-6});
    EXPECT_THAT(positions(read_string(header("binary", small) + two, kPcd)),
                ElementsAre(Eigen::Vector3d(-1, 65535, 3), Eigen::Vector3d(4, 5, -6)));
    const Layout unsigned_types{.size = "1 4 8", .type = "U U U"};
    const std::string ones = packed(std::uint8_t{1}, std::uint32_t{2}, std::uint64_t{3}) +
                             packed(std::uint8_t{4}, std::uint32_t{5}, std::uint64_t{6});
    EXPECT_EQ(positions(read_string(header("binary", unsigned_types) + ones, kPcd)), kTwoPoints);
}

TEST(ReadPcd, CompressedStandsFieldByField) {
    const Layout layout{.fields = "label x y z", .size = "2 4 4 8", .type = "U F F F", .count = "2 1 1 1"};
    const std::string plain = "aabbccdd" + packed(1.F, 4.F) + packed(2.F, 5.F) + packed(3.0, 6.0);
    const std::string bytes = header("binary_compressed", layout) + compressed(plain);
    const Scan scan = read_string(bytes, kPcd);
    EXPECT_EQ(positions(scan), kTwoPoints);
    EXPECT_EQ(scan.format, "pcd binary_compressed");
    EXPECT_EQ(positions(read_string(bytes + std::string(4096, '\0'), kPcd)), kTwoPoints);
}

TEST(ReadPcd, CompressedWithLongCopies) {
    constexpr std::size_t kCount = 5000;
    const Layout layout{.width = std::to_string(kCount), .points = std::to_string(kCount)};
    std::string plain;
    for (const float value : {1.F, 2.F, 3.F}) {
        for (std::size_t i = 0; i < kCount; ++i) {
            plain += packed(value);
        }
    }
    const std::string bytes = header("binary_compressed", layout) + compressed(plain);
    EXPECT_LT(bytes.size(), plain.size() / 10);
    EXPECT_EQ(positions(read_string(bytes, kPcd)), std::vector<Eigen::Vector3d>(kCount, {1, 2, 3}));
}

TEST(ReadPcd, NormalsComeFromTheirThreeFields) {
    const Layout layout{.fields = "x y z normal_x normal_y normal_z curvature",
                        .size = "4 4 4 4 4 4 4",
                        .type = "F F F F F F F",
                        .count = "1 1 1 1 1 1 1"};
    const Scan scan = read_string(header("ascii", layout) + "1 2 3 0 0 2 9\n4 5 6 0 1 0 9\n", kPcd);
    EXPECT_THAT(scan.normals, ElementsAre(Eigen::Vector3f(0, 0, 1), Eigen::Vector3f(0, 1, 0)));
    EXPECT_TRUE(read_string(header("ascii", layout) + "1 2 3 nan 0 2 9\n4 5 6 0 1 0 9\n", kPcd).normals.empty());
}

TEST(ReadPcd, ARasterStaysOneAndItsHolesAreCounted) {
    const Layout layout{.width = "3", .height = "2", .points = "6"};
    const std::string ascii = header("ascii", layout) + "1 2 3\nnan nan nan\n4 5 6\n7 8 9\n1 inf 1\n2 2 2\n";
    const std::string binary = header("binary", layout) +
                               packed(1.F, 2.F, 3.F, NAN, 0.F, 0.F, 4.F, 5.F, 6.F, 7.F, 8.F, 9.F) +
                               packed(1.F, -INFINITY, 1.F, 2.F, 2.F, 2.F);
    for (const std::string& bytes : {ascii, binary}) {
        const Scan scan = read_string(bytes, kPcd);
        EXPECT_EQ(scan.width, 3U);
        EXPECT_EQ(scan.height, 2U);
        EXPECT_THAT(scan.pixel, ElementsAre(0, 2, 3, 5));
        EXPECT_EQ(scan.points[1], Eigen::Vector3f(4, 5, 6));
        EXPECT_EQ(scan.dropped_not_finite, 2U);
        EXPECT_EQ(scan.points_in_file, 6U);
        EXPECT_EQ(scan.sensor_mm, Eigen::Vector3d(0, 0, 0));
        expect_invariants(scan);
    }
}

TEST(ReadPcd, TheViewpointIsWhereTheSensorStood) {
    const Layout layout{.viewpoint = "0.5 -1 2 1 0 0 0"};
    const ReadOptions metres{.unit = Unit::m};
    EXPECT_EQ(read_string(header("ascii", layout) + "1 2 3\n4 5 6\n", kPcd, metres).sensor_mm,
              Eigen::Vector3d(500, -1000, 2000));
    const Layout turned{.viewpoint = "0 0 0 0 1 0 0"};
    EXPECT_EQ(read_string(header("ascii", turned) + "1 2 3\n4 5 6\n", kPcd).sensor_mm, Eigen::Vector3d(0, 0, 0));
}

TEST(ReadPcd, OldAndShortHeaders) {
    const std::string old =
        "# .PCD v.5\r\nVERSION .5\r\nCOLUMNS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nPOINTS 2\r\nDATA ascii\r\n";
    EXPECT_EQ(positions(read_string(old + "1 2 3\r\n4 5 6\r\n", kPcd)), kTwoPoints);
    const std::string no_points = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 2\nDATA binary\n";
    const Scan scan = read_string(no_points + packed(1.F, 2.F, 3.F, 4.F, 5.F, 6.F), kPcd);
    EXPECT_EQ(positions(scan), kTwoPoints);
    EXPECT_TRUE(scan.pixel.empty()) << "one column is no raster";
}

TEST(ReadPcd, ErrorsSayWhereWhatAndWhatToDo) {
    const std::string points = packed(1.F, 2.F, 3.F, 4.F, 5.F, 6.F);
    const auto error = [&](const Layout& layout) { return error_of(header("binary", layout) + points, kPcd); };
    EXPECT_EQ(error_of(header("ascii") + "1 2 3\n", kPcd),
              "read: part: line 13: the file ends after 1 lines of data; the header promises 2; export or copy the "
              "file again");
    EXPECT_EQ(error_of(header("ascii") + "1 2 3\n4 5 6\n7 8 9\n", kPcd),
              "read: part: line 15: the file ends after 3 lines of data; the header promises 2; export or copy the "
              "file again");
    EXPECT_THAT(error_of(header("ascii") + "1 2 3\n4 5\n", kPcd), HasSubstr("line 13: the line has 2 of the 3 values"));
    EXPECT_THAT(error_of(header("binary") + points.substr(1), kPcd),
                HasSubstr("promises 2 points of 12 bytes, but only 23 bytes are left"));
    EXPECT_THAT(error_of(header("binary") + points + "x", kPcd), HasSubstr("1 bytes follow the last point"));
    EXPECT_THAT(error_of(header("binary_zipped") + points, kPcd), HasSubstr("DATA is 'binary_zipped'; expected ascii"));
    EXPECT_THAT(error_of("FIELDS x y z\n", kPcd), HasSubstr("byte 13: the PCD header does not end"));
    EXPECT_THAT(error_of("ply\n", kPcd), HasSubstr("line 1: 'ply' is no word of a PCD header"));
    EXPECT_THAT(error({.type = "F F Q"}), HasSubstr("field 'z' has TYPE 'Q' and SIZE 4; expected F with 4 or 8"));
    EXPECT_THAT(error({.size = "4 4 3"}), HasSubstr("field 'z' has TYPE 'F' and SIZE 3"));
    EXPECT_THAT(error({.size = "4 4"}), HasSubstr("line 4: SIZE has 2 values for the 3 fields before it"));
    EXPECT_THAT(error({.size = "4 4 -4"}), HasSubstr("line 4: SIZE is '-4'; expected a whole number"));
    EXPECT_THAT(error({.count = "1 1 0"}), HasSubstr("field 'z' has COUNT 0; expected 1 to 65536"));
    EXPECT_THAT(error({.count = "1 1 18446744073709551615"}), HasSubstr("COUNT 18446744073709551615"));
    EXPECT_THAT(error({.count = "1 1 2"}), HasSubstr("FIELDS has 0 fields 'z' of COUNT 1"));
    EXPECT_THAT(error({.fields = "x y y"}), HasSubstr("FIELDS has 2 fields 'y' of COUNT 1"));
    EXPECT_THAT(error({.width = "-2"}), HasSubstr("line 7: WIDTH is '-2'; expected a whole number"));
    EXPECT_THAT(error({.width = "3"}), HasSubstr("WIDTH 3 times HEIGHT 1 is not POINTS 2"));
    EXPECT_THAT(error({.width = "9223372036854775809", .height = "2"}), HasSubstr("times HEIGHT 2 is not POINTS 2"));
    EXPECT_THAT(error({.width = "4000000000", .points = "4000000000"}), HasSubstr("but only 24 bytes are left"));
    EXPECT_THAT(error({.viewpoint = "0 0 0 1 0 0"}),
                HasSubstr("line 9: VIEWPOINT holds ''; expected 7 finite numbers"));
    EXPECT_THAT(error({.viewpoint = "nan 0 0 1 0 0 0"}), HasSubstr("VIEWPOINT holds 'nan'"));
    EXPECT_THAT(error({.width = "0", .points = "0"}), HasSubstr("24 bytes follow the last point"));
    EXPECT_THAT(error_of(header("ascii", {.width = "0", .points = "0"}), kPcd), HasSubstr("holds no points"));
    EXPECT_THAT(error_of("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nDATA ascii\n1 2 3\n", kPcd),
                HasSubstr("neither WIDTH nor POINTS"));
}

TEST(ReadPcd, ErrorsInCompressedData) {
    const std::string head = header("binary_compressed");
    const std::string good = compressed(packed(1.F, 4.F, 2.F, 5.F, 3.F, 6.F));
    EXPECT_THAT(error_of(head + good.substr(0, 7), kPcd), HasSubstr("the file ends before the two sizes"));
    EXPECT_THAT(error_of(head + good.substr(0, good.size() - 1), kPcd), HasSubstr("bytes of compressed data"));
    EXPECT_THAT(error_of(head + good + "x", kPcd), HasSubstr("1 bytes follow the last point"));
    std::string wrong_size = good;
    wrong_size[4] = 25;
    EXPECT_THAT(error_of(head + wrong_size, kPcd),
                HasSubstr("is of 25 bytes; the header promises 2 points of 12 bytes"));
    std::string damaged = good;
    damaged[8] = '\xff';
    EXPECT_THAT(error_of(head + damaged, kPcd), HasSubstr("does not unpack to the 24 bytes promised"));
    // A copy from before the beginning of the output: of the right length, but without content.
    const std::string backwards = packed(std::uint32_t{3}, std::uint32_t{24}) + '\xe0' + '\x0f' + '\x05';
    EXPECT_THAT(error_of(head + backwards, kPcd), HasSubstr("does not unpack to the 24 bytes promised"));
    const Layout bomb{.width = "300000000", .points = "300000000"};
    const std::string claim = packed(std::uint32_t{3}, std::uint32_t{3600000000}) + std::string("\x01zz");
    EXPECT_THAT(error_of(header("binary_compressed", bomb) + claim, kPcd),
                HasSubstr("does not unpack to the 3600000000 bytes promised"));
}

}  // namespace pcd_test
}  // namespace seampath::read_test
