#include "tests/read/support.hpp"

namespace seampath::read_test {
namespace ply_test {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr auto kPly = ScanFormat::ply;

std::string header(const std::string& encoding, const std::string& rest) {
    return "ply\nformat " + encoding + " 1.0\ncomment made by a test\n" + rest + "end_header\n";
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string two_points() {
    return header("binary_little_endian", "element vertex 2\n" + kXyz) + packed(1.5F, 2.F, 3.F, -4.F, 5.F, 6.25F);
}

TEST(ReadPly, AsciiWithOtherPropertiesAndElements) {
    const std::string text = header("ascii",
                                    "element camera 1\nproperty float f\nelement vertex 2\nproperty uchar red\n"
                                    "property list uchar int tags\nproperty double z\nproperty double y\n"
                                    "property double x\nelement face 1\nproperty list uchar int vertex_indices\n") +
                             "7.5\n255 2 8 9 3 2 1\n0 0 6 5 4\n3 0 1 0\n";
    const Scan scan = read_string(text, kPly);
    EXPECT_THAT(positions(scan), ::testing::ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
    EXPECT_EQ(scan.format, "ply ascii");
    EXPECT_EQ(scan.points_in_file, 2U);
    EXPECT_EQ(scan.name, "part");
    EXPECT_TRUE(scan.normals.empty());
    EXPECT_FALSE(scan.sensor_mm);
    expect_invariants(scan);
}

TEST(ReadPly, LineEndsAndBlankLinesAndNumberForms) {
    const std::string text =
        "ply\r\nformat ascii 1.0\r\nobj_info made by a test\r\nelement vertex 3\r\nproperty float x\r\n"
        "property float y\r\nproperty float z\r\nend_header\r\n+1.0 2e1 -3.5E-1\r\n\r\n 4\t5  6 \r\n"
        "nan 1 inf";
    const Scan scan = read_string(text, kPly);
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points[0], Eigen::Vector3f(1, 20, -0.35F));
    EXPECT_EQ(scan.points[1], Eigen::Vector3f(4, 5, 6));
    EXPECT_EQ(scan.dropped_not_finite, 1U);
    EXPECT_EQ(scan.points_in_file, 3U);
}

TEST(ReadPly, BinaryFloatsAreKeptBitForBit) {
    const Scan scan = read_string(two_points(), kPly);
    EXPECT_EQ(scan.origin_mm, Eigen::Vector3d(0, 0, 0));
    EXPECT_THAT(scan.points, ::testing::ElementsAre(Eigen::Vector3f(1.5F, 2, 3), Eigen::Vector3f(-4, 5, 6.25F)));
    EXPECT_EQ(scan.format, "ply binary_little_endian");
}

template <class T>
class ReadPlyScalar : public ::testing::Test {};
using Scalars = ::testing::Types<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t, std::uint32_t,
                                 std::int64_t, std::uint64_t, float, double>;
TYPED_TEST_SUITE(ReadPlyScalar, Scalars);

template <class T>
std::vector<std::string> type_names() {
    if constexpr (std::is_floating_point_v<T>) {
        return sizeof(T) == 4 ? std::vector<std::string>{"float", "float32"}
                              : std::vector<std::string>{"double", "float64"};
    } else {
        const std::string sign = std::is_signed_v<T> ? "" : "u";
        std::vector<std::string> names{sign + "int" + std::to_string(8 * sizeof(T))};
        if (sizeof(T) < 8) {
            names.push_back(sign + (sizeof(T) == 1 ? "char" : sizeof(T) == 2 ? "short" : "int"));
        }
        return names;
    }
}

TYPED_TEST(ReadPlyScalar, EveryTypeInBothByteOrders) {
    const auto first = static_cast<TypeParam>(100);
    const auto other = static_cast<TypeParam>(std::is_signed_v<TypeParam> ? -7 : 7);
    for (const std::string& type : type_names<TypeParam>()) {
        for (const bool big : {false, true}) {
            SCOPED_TRACE(type + (big ? " big" : " little"));
            std::string rest = "element vertex 2\nproperty uchar before\n";
            for (const char axis : {'z', 'x', 'y'}) {
                rest += "property " + type + " " + axis + "\n";
            }
            std::string bytes = header(big ? "binary_big_endian" : "binary_little_endian", rest);
            for (int i = 0; i < 2; ++i) {
                bytes +=
                    '\x7f' + bytes_of(first, big) + bytes_of(other, big) + bytes_of(static_cast<TypeParam>(i), big);
            }
            const Scan scan = read_string(bytes, kPly);
            const auto x = static_cast<double>(other);
            EXPECT_THAT(positions(scan),
                        ::testing::ElementsAre(Eigen::Vector3d(x, 0, 100), Eigen::Vector3d(x, 1, 100)));
        }
    }
}

TEST(ReadPly, ListsInTheVertexElementAndElementsAroundIt) {
    for (const bool big : {false, true}) {
        std::string bytes = header(big ? "binary_big_endian" : "binary_little_endian",
                                   "element strip 2\nproperty list ushort short values\nelement vertex 2\n"
                                   "property list uchar float first\nproperty float x\nproperty float y\n"
                                   "property list int uchar middle\nproperty double z\nproperty list char char last\n"
                                   "element empty 7\nelement face 1\nproperty list uchar uint vertex_indices\n");
        const auto add = [&](auto value) { bytes += bytes_of(value, big); };
        add(std::uint16_t{2}), add(std::int16_t{5}), add(std::int16_t{6}), add(std::uint16_t{0});
        add(std::uint8_t{1}), add(9.F), add(1.F), add(2.F), add(std::int32_t{0}), add(3.0), add(std::int8_t{1}),
            add('c');
        add(std::uint8_t{0}), add(4.F), add(5.F), add(std::int32_t{2}), add('a'), add('b'), add(6.0),
            add(std::int8_t{0});
        add(std::uint8_t{3}), add(std::uint32_t{0}), add(std::uint32_t{1}), add(std::uint32_t{0});
        const Scan scan = read_string(bytes, kPly);
        EXPECT_THAT(positions(scan), ::testing::ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
    }
}

TEST(ReadPly, NormalsAreMadeUnitOrLeftOut) {
    const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
    const std::string head = header("binary_little_endian", "element vertex 2\n" + kXyz + normals);
    const Scan scan = read_string(head + packed(1.F, 2.F, 3.F, 0.F, 0.F, 2.F, 4.F, 5.F, 6.F, -3.F, 0.F, 4.F), kPly);
    EXPECT_THAT(scan.normals, ::testing::ElementsAre(Eigen::Vector3f(0, 0, 1), Eigen::Vector3f(-0.6F, 0, 0.8F)));
    expect_invariants(scan);
    const Scan none = read_string(head + packed(1.F, 2.F, 3.F, 0.F, 0.F, 2.F, 4.F, 5.F, 6.F, 0.F, 0.F, 0.F), kPly);
    EXPECT_EQ(none.points.size(), 2U);
    EXPECT_TRUE(none.normals.empty());
    const std::string partly = header("binary_little_endian", "element vertex 1\n" + kXyz + "property float nx\n");
    EXPECT_TRUE(read_string(partly + packed(1.F, 2.F, 3.F, 1.F), kPly).normals.empty());
}

TEST(ReadPly, ADroppedRecordTakesItsNormalWithIt) {
    const std::string bytes =
        header("ascii", "element vertex 3\n" + kXyz + "property float nx\nproperty float ny\nproperty float nz\n") +
        "1 2 3 1 0 0\nnan 0 0 0 1 0\n4 5 6 0 0 1\n";
    const Scan scan = read_string(bytes, kPly);
    EXPECT_THAT(scan.normals, ::testing::ElementsAre(Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 0, 1)));
}

TEST(ReadPly, ErrorsSayWhereWhatAndWhatToDo) {
    const std::string body = packed(1.F, 2.F, 3.F);
    const auto binary = [&](const std::string& rest) { return header("binary_little_endian", rest) + body; };
    EXPECT_EQ(error_of("plx\n", kPly),
              "read: part: byte 0: the file does not begin with the line 'ply'; is it another format "
              "under this name?");
    EXPECT_EQ(error_of("ply\nformat ascii 1.0\nelement vertex 1\n", kPly),
              "read: part: byte 38: the PLY header does not end; expected 'end_header' within its first 64 KiB; export "
              "or copy "
              "the file again");
    EXPECT_EQ(error_of(two_points() + "x", kPly),
              "read: part: byte 162: 1 bytes follow the last element; expected the end of "
              "the file; export or copy the file again");
    const std::string cut = two_points().substr(0, two_points().size() - 1);
    EXPECT_EQ(error_of(cut, kPly),
              "read: part: byte 138: element 'vertex' promises 2 records of 12 bytes, but only 23 bytes are "
              "left; export or copy the file again");
    EXPECT_THAT(error_of(header("utf8", "element vertex 1\n" + kXyz), kPly),
                StartsWith("read: part: line 2: format 'utf8' '1.0'; expected ascii, binary_little_endian"));
    EXPECT_THAT(
        error_of(binary("element vertex -1\n" + kXyz), kPly),
        StartsWith("read: part: line 4: element 'vertex' has count '-1'; expected a whole number of 0 or more"));
    EXPECT_THAT(error_of(binary("element vertex 99999999999999999999\n" + kXyz), kPly), HasSubstr("line 4: element"));
    EXPECT_THAT(error_of(binary("element vertex 18446744073709551615\n" + kXyz), kPly),
                HasSubstr("promises 18446744073709551615 records of 12 bytes, but only 12 bytes are left"));
    EXPECT_THAT(error_of(binary("element vertex 1\nproperty float x\nproperty float y\n"), kPly),
                HasSubstr("element 'vertex' has no property 'z'; a scan needs x, y and z"));
    EXPECT_THAT(error_of(binary("element vertex 1\nproperty quad x\n"), kPly),
                HasSubstr("line 5: 'quad' is no PLY type"));
    EXPECT_THAT(error_of(binary("property float x\n"), kPly), HasSubstr("line 4: a property before any element"));
    EXPECT_THAT(error_of(binary("element vertex 1\nproperty float x\nproperty float x\n"), kPly),
                HasSubstr("line 6: property 'x' stands twice"));
    EXPECT_THAT(error_of(binary("element vertex 1\nproperty list float int a\n"), kPly),
                HasSubstr("line 5: a list whose length is a floating-point number"));
    EXPECT_THAT(error_of(binary("element vertex 1\nproperty float\n"), kPly),
                HasSubstr("line 5: a property without a name"));
    EXPECT_THAT(error_of(binary("elephant\n"), kPly), HasSubstr("line 4: 'elephant' is no word of a PLY header"));
    EXPECT_THAT(error_of(binary("element face 0\n"), kPly), HasSubstr("has 0 elements 'vertex'; expected one"));
    EXPECT_THAT(error_of("ply\nelement vertex 1\n" + kXyz + "end_header\n", kPly), HasSubstr("has no 'format' line"));
    EXPECT_THAT(error_of(header("binary_little_endian", "element vertex 0\n" + kXyz), kPly),
                HasSubstr("holds no points; expected at least one"));
    EXPECT_THAT(error_of(header("binary_little_endian", "element vertex 1\n" + kXyz) + packed(NAN, 0.F, 0.F), kPly),
                HasSubstr("all 1 points are NaN, infinite or beyond 1e12"));
}

TEST(ReadPly, ErrorsInAsciiRows) {
    const std::string head = header("ascii", "element vertex 2\n" + kXyz);
    EXPECT_EQ(error_of(head + "1 2 3\n4 five 6\n", kPly),
              "read: part: line 10: 'five' is not a number; repair or remove this line");
    EXPECT_THAT(error_of(head + "1 2 3\n4 5\n", kPly), HasSubstr("line 10: the line has 2 of the 3 values expected"));
    EXPECT_THAT(error_of(head + "1 2 3 4\n4 5 6\n", kPly),
                HasSubstr("line 9: the line has more than the 3 values expected"));
    EXPECT_THAT(error_of(head + "1 2 3\n", kPly),
                HasSubstr("line 10: the file ends after 1 of 2 lines of element 'vertex'"));
    EXPECT_THAT(error_of(head + "1 2 3\n4 5 6\n7 8 9\n", kPly), HasSubstr("1 lines follow the last element"));
    const std::string list = header("ascii", "element vertex 1\nproperty list uchar int a\n" + kXyz);
    EXPECT_THAT(error_of(list + "9 1 2 3\n", kPly), HasSubstr("the line ends within a list of 9"));
    EXPECT_THAT(error_of(list + "-1 1 2 3\n", kPly), HasSubstr("'-1' is not the length of a list"));
}

TEST(ReadPly, ErrorsInBinaryLists) {
    const std::string head = header(
        "binary_little_endian", "element vertex 1\n" + kXyz + "element face 2\nproperty list int int vertex_indices\n");
    const std::string point = packed(1.F, 2.F, 3.F);
    EXPECT_THAT(error_of(head + point + packed(std::int32_t{-1}, std::int32_t{0}), kPly),
                HasSubstr("list 'vertex_indices' of record 0 has a length of -1"));
    EXPECT_THAT(error_of(head + point + packed(std::int32_t{2000000000}, std::int32_t{0}), kPly),
                HasSubstr("the file ends within record 0 of 2 of element 'face'"));
    EXPECT_THAT(error_of(head + point + packed(std::int32_t{0}), kPly),
                HasSubstr("promises 2 records of at least 4 bytes"));
}

TEST(ReadPly, ManyPointsKeepTheirOrderAcrossBlocks) {
    constexpr std::size_t kCount = 200'003;
    std::string bytes = header("binary_little_endian", "element vertex " + std::to_string(kCount) + "\n" + kXyz);
    std::string text = header("ascii", "element vertex " + std::to_string(kCount) + "\n" + kXyz);
    for (std::size_t i = 0; i < kCount; ++i) {
        const bool hole = i % 1000 == 17;
        const auto x = static_cast<float>(i);
        bytes += packed(hole ? NAN : x, -x, 1.F);
        text += (hole ? "nan" : std::to_string(i)) + " -" + std::to_string(i) + " 1\n";
    }
    const Scan scan = read_string(bytes, kPly);
    ASSERT_EQ(scan.points.size() + scan.dropped_not_finite, kCount);
    EXPECT_EQ(scan.dropped_not_finite, 200U);
    std::size_t next = 0;
    for (const auto& p : scan.points) {
        next += next % 1000 == 17 ? 1 : 0;
        ASSERT_EQ(p, Eigen::Vector3f(static_cast<float>(next), -static_cast<float>(next), 1));
        ++next;
    }
    const Scan from_text = read_string(text, kPly);
    EXPECT_EQ(from_text.origin_mm, scan.origin_mm);
    EXPECT_EQ(from_text.points, scan.points);
}

}  // namespace ply_test
}  // namespace seampath::read_test
