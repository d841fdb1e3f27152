#include <clocale>

#include "tests/read/support.hpp"

namespace seampath::read_test {
namespace text_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr auto kText = ScanFormat::text;

const std::vector<Eigen::Vector3d> kTwoPoints{{1, 2, 3}, {4, 5, 6}};

TEST(ReadText, EverySeparatorAndLineEnd) {
    for (const std::string bytes : {"1 2 3\n4 5 6\n", "1,2,3\n4, 5 ,6", "1;2;3;\n4;5;6;\n", "1\t2\t3\r\n4\t5\t6\r\n",
                                    "  1  2  3 \n\n\t4 5 6\n\n", "\357\273\2771,2,3\n4,5,6\n",
                                    "# a comment\n// X Y Z\n1 2 3\n# between\n4 5 6\n", "1.0e0 +2. .3e1\n4 5 6\n"}) {
        SCOPED_TRACE(bytes);
        const Scan scan = read_string(bytes, kText);
        EXPECT_EQ(positions(scan), kTwoPoints);
        EXPECT_EQ(scan.format, "text");
        expect_invariants(scan);
    }
}

TEST(ReadText, AHeaderNamesTheColumns) {
    for (const std::string bytes : {"x,y,z\n1,2,3\n4,5,6\n", "seam;index;X;\"Y\";z;name\n0;0;1;2;3;a b\n0;1;4;5;6;\n",
                                    "z y x\n3 2 1\n6 5 4\n", "Intensity X Y Z\nlow 1 2 3\nhigh 4 5 6\n"}) {
        SCOPED_TRACE(bytes);
        EXPECT_EQ(positions(read_string(bytes, kText)), kTwoPoints);
    }
    const Scan scan = read_string("nx ny nz x y z\n0 0 2 1 2 3\n0 3 0 4 5 6\n", kText);
    EXPECT_THAT(scan.normals, ElementsAre(Eigen::Vector3f(0, 0, 1), Eigen::Vector3f(0, 1, 0)));
    EXPECT_TRUE(read_string("x y z nx ny\n1 2 3 0 1\n", kText).normals.empty());
}

TEST(ReadText, SixColumnsAreNormalsWhereAllHaveLengthOne) {
    const Scan scan = read_string("1 2 3 0 0 1\n4 5 6 0.6 0 -0.799\n", kText);
    EXPECT_THAT(scan.normals.size(), 2U);
    expect_invariants(scan);
    const Scan colours = read_string("1 2 3 0 0 1\n4 5 6 255 0 0\n", kText);
    EXPECT_EQ(positions(colours), kTwoPoints);
    EXPECT_TRUE(colours.normals.empty());
    EXPECT_TRUE(read_string("1 2 3 0 0 1 9\n4 5 6 0 0 1 9\n", kText).normals.empty()) << "seven columns";
}

TEST(ReadText, AColourFarDownTheFileShowsThatNoneIsANormal) {
    std::string bytes;
    for (int i = 0; i < 50'000; ++i) {
        bytes += std::to_string(i) + (i == 49'000 ? " 2 3 9 9 9\n" : " 2 3 0 0 1\n");
    }
    const Scan scan = read_string(bytes, kText);
    EXPECT_EQ(scan.points.size(), 50'000U);
    EXPECT_TRUE(scan.normals.empty());
}

TEST(ReadText, FarFromZeroKeepsItsDigits) {
    const Scan scan = read_string("5000123.4567 -7000000.1234 12.5\n5000223.4567 -7000000.4321 12.25\n", kText);
    EXPECT_LT((scan.position(0) - Eigen::Vector3d(5000123.4567, -7000000.1234, 12.5)).norm(), 1e-4);
    EXPECT_LT((scan.position(1) - Eigen::Vector3d(5000223.4567, -7000000.4321, 12.25)).norm(), 1e-4);
    const Scan metres = read_string("5000.1234567 0 0\n5000.2234567 0 0\n", kText, {.unit = Unit::m});
    EXPECT_NEAR(metres.position(1).x() - metres.position(0).x(), 100, 1e-4);
    EXPECT_NEAR(metres.position(0).x(), 5000123.4567, 1e-4);
}

TEST(ReadText, OriginIsZeroWhereFloatsAreEnough) {
    EXPECT_EQ(read_string("100 200 300\n150 200 300\n", kText).origin_mm, Eigen::Vector3d(0, 0, 0));
}

TEST(ReadText, NotFiniteAndAbsurdNumbersAreDropped) {
    const Scan scan = read_string("1 2 3\nnan 0 0\n0 -inf 0\n0 0 1e999\n0 0 2e12\n1e-999 5 6\n", kText);
    EXPECT_EQ(scan.dropped_not_finite, 4U);
    EXPECT_THAT(positions(scan), ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0, 5, 6)));
}

TEST(ReadText, TheLocaleChangesNothing) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "C.UTF-8"}) {
        std::setlocale(LC_ALL, name);
        EXPECT_EQ(read_string("1.5 2.5 3.5\n", kText).position(0), Eigen::Vector3d(1.5, 2.5, 3.5)) << name;
    }
    std::setlocale(LC_ALL, before.c_str());
}

TEST(ReadText, ManyRowsKeepTheirOrderAcrossBlocks) {
    std::string bytes = "x,y,z\r\n";
    for (int i = 0; i < 120'000; ++i) {
        bytes += std::to_string(i) + (i % 7 == 0 ? ",2,3\r\n# note\r\n" : ",2,3\r\n");
    }
    const Scan scan = read_string(bytes, kText);
    ASSERT_EQ(scan.points.size(), 120'000U);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        ASSERT_EQ(scan.points[i].x(), static_cast<float>(i));
    }
}

TEST(ReadText, ErrorsSayWhereWhatAndWhatToDo) {
    EXPECT_EQ(error_of("1 2 3\n4 5\n", kText),
              "read: part: line 2: the line has 2 of the 3 values expected; repair or remove this line");
    EXPECT_EQ(error_of("1 2 3\n# note\n4 5 6 7\n", kText),
              "read: part: line 3: the line has more than the 3 values expected; repair or remove this line");
    EXPECT_THAT(error_of("1,2,3\n4,,6\n", kText), HasSubstr("line 2: '' is not a number"));
    EXPECT_THAT(error_of("1,2,3\n4,5,6mm\n", kText), HasSubstr("line 2: '6mm' is not a number"));
    EXPECT_THAT(error_of("1 2 +-3\n", kText), HasSubstr("line 1: neither numbers (with decimal points) nor a header"));
    EXPECT_THAT(error_of("1,5 2,5 3,5\n", kText),
                HasSubstr("line 1: neither numbers (with decimal points) nor a header"));
    EXPECT_THAT(error_of("a b c\n1 2 3\n", kText), HasSubstr("names one column each x, y and z"));
    EXPECT_THAT(error_of("x y z x\n1 2 3 4\n", kText), HasSubstr("names one column each x, y and z"));
    EXPECT_THAT(error_of("# first\n1 2\n", kText), HasSubstr("line 2: '1 2' has 2 columns; expected at least 3"));
    EXPECT_THAT(error_of(std::string("1 2 3\n4 5 \0\n", 12), kText),
                HasSubstr("byte 10: a zero byte; expected plain text"));
    EXPECT_THAT(error_of("# nothing\n\n", kText), HasSubstr("holds no points"));
    EXPECT_THAT(error_of("x y z\n", kText), HasSubstr("holds no points"));
    EXPECT_THAT(error_of("nan nan nan\n", kText), HasSubstr("all 1 points are NaN"));
    EXPECT_EQ(error_of("", kText), "read: part: is empty (0 bytes); expected a scan; export or copy the file again");
}

TEST(ReadText, TheFirstBadLineIsNamedHoweverManyThereAre) {
    std::string bytes;
    for (int i = 1; i <= 100'000; ++i) {
        bytes += i >= 54'321 ? "1 2\n" : "1 2 3\n";
    }
    EXPECT_THAT(error_of(bytes, kText), HasSubstr("line 54321: "));
}

}  // namespace text_test
}  // namespace seampath::read_test
