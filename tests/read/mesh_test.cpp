#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/read/support.hpp"

namespace seampath::read_test {
namespace mesh_test {

using ::testing::HasSubstr;

constexpr auto kStl = ScanFormat::stl;
constexpr auto kObj = ScanFormat::obj;

using Triangle = std::array<Eigen::Vector3f, 3>;

std::string binary_stl(const std::vector<Triangle>& triangles, const std::string& title = "made by a test") {
    std::string bytes =
        title + std::string(80 - title.size(), ' ') + packed(static_cast<std::uint32_t>(triangles.size()));
    for (const auto& t : triangles) {
        bytes += packed(9.F, 9.F, 9.F);
        for (const auto& p : t) {
            bytes += packed(p.x(), p.y(), p.z());
        }
        bytes += packed(std::uint16_t{0});
    }
    return bytes;
}

const Triangle kLower{Eigen::Vector3f(0, 0, 5), Eigen::Vector3f(40, 0, 5), Eigen::Vector3f(0, 30, 5)};
const Triangle kUpper{Eigen::Vector3f(40, 30, 5), Eigen::Vector3f(0, 30, 5), Eigen::Vector3f(40, 0, 5)};

const std::string kAsciiStl =
    "solid part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 5\n   vertex 4e1 0 5\n   vertex 0 30 5\n  endloop\n"
    " endfacet\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 40 30 5\nVERTEX 0 30 5\nVERTEX 40 0 5\nENDLOOP\nENDFACET\n"
    "endsolid part\n";

const std::string kObjPlate =
    "# made by a test\nmtllib a.mtl\no plate\nv 0 0 5\nv 40 0 5 1.0\nv 40 30 5 0.5 0.5 0.5\n"
    "v 0 30 5\nvt 0 0\nvn 0 0 1\nusemtl steel\ns off\n";

/// Largest distance from a point of the 40 x 30 plate to its nearest sample.
double largest_gap(const Scan& scan, double step) {
    double gap = 0;
    for (double x = 0; x <= 40; x += step) {
        for (double y = 0; y <= 30; y += step) {
            double nearest = 1e9;
            for (const auto& p : scan.points) {
                nearest = std::min(nearest, std::hypot(static_cast<double>(p.x()) - x, static_cast<double>(p.y()) - y));
            }
            gap = std::max(gap, nearest);
        }
    }
    return gap;
}

void expect_plate(const Scan& scan) {
    expect_invariants(scan);
    EXPECT_EQ(scan.points.size(), 1200U) << "40 mm x 30 mm at 1 mm";
    EXPECT_EQ(scan.normals.size(), 1200U);
    EXPECT_EQ(scan.points_in_file, 2U);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Eigen::Vector3f& p = scan.points[i];
        ASSERT_TRUE(p.x() >= 0 && p.x() <= 40 && p.y() >= 0 && p.y() <= 30);
        ASSERT_EQ(p.z(), 5);
        ASSERT_EQ(scan.normals[i], Eigen::Vector3f(0, 0, 1));
    }
    EXPECT_LT(largest_gap(scan, 1.3), 1.7);
}

TEST(ReadMesh, APlateInEveryFormatIsSampledEvenly) {
    const ReadOptions options{.unit = Unit::mm, .mesh_spacing_mm = 1};
    const Scan ascii = read_string(kAsciiStl, kStl, options);
    expect_plate(ascii);
    EXPECT_EQ(ascii.format, "stl ascii");
    const Scan binary = read_string(binary_stl({kLower, kUpper}), kStl, options);
    expect_plate(binary);
    EXPECT_EQ(binary.format, "stl binary");
    EXPECT_EQ(binary.points, ascii.points);
    for (const std::string faces : {"f 1 2 3 4\n", "f -4 -3 -2 -1\n", "f 1/1 2/1 3/1 4/1\n",
                                    "f 1//1 2//1 3//1\nf 1/1/1 3/1/1 4/1/1", "f 2 3 4\r\nf 1 2 4\r\n"}) {
        SCOPED_TRACE(faces);
        const Scan obj = read_string(kObjPlate + faces, kObj, options);
        expect_plate(obj);
        EXPECT_EQ(obj.format, "obj");
    }
}

TEST(ReadMesh, ABinaryStlMayCallItselfSolid) {
    EXPECT_EQ(read_string(binary_stl({kLower}, "solid part"), kStl).format, "stl binary");
}

TEST(ReadMesh, SpacingIsInMillimetresWhateverTheUnit) {
    const Scan scan = read_string(binary_stl({kLower, kUpper}), kStl, {.unit = Unit::inch, .mesh_spacing_mm = 25.4});
    EXPECT_EQ(scan.points.size(), 1200U);
    EXPECT_EQ(scan.mm_per_unit, 25.4);
    EXPECT_FLOAT_EQ(scan.points[0].z(), 5 * 25.4F);
}

TEST(ReadMesh, SliversOfACylinderGetTheirShare) {
    constexpr int kSides = 720;
    constexpr double kRadius = 10;
    constexpr double kLength = 50;
    std::vector<Triangle> triangles;
    const auto at = [&](int side, double z) {
        const double angle = 2 * std::numbers::pi * side / kSides;
        return Eigen::Vector3d(kRadius * std::cos(angle), kRadius * std::sin(angle), z).cast<float>().eval();
    };
    for (int side = 0; side < kSides; ++side) {
        triangles.push_back({at(side, 0), at(side + 1, 0), at(side + 1, kLength)});
        triangles.push_back({at(side, 0), at(side + 1, kLength), at(side, kLength)});
    }
    const Scan scan = read_string(binary_stl(triangles), kStl, {.unit = Unit::mm, .mesh_spacing_mm = 0.5});
    const double area = 2 * std::numbers::pi * kRadius * kLength;
    EXPECT_NEAR(static_cast<double>(scan.points.size()), area / 0.25, 2);
    // Points in patches of 2 mm x 2 mm: 16 each, nowhere empty and nowhere double.
    constexpr std::size_t kAround = 31;
    constexpr std::size_t kAlong = 25;
    std::array<int, kAround * kAlong> count{};
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Eigen::Vector3d p = scan.position(i);
        const double turn = (std::atan2(p.y(), p.x()) + std::numbers::pi) / (2 * std::numbers::pi);
        const auto around = std::min(kAround - 1, static_cast<std::size_t>(turn * kAround));
        const auto along = std::min(kAlong - 1, static_cast<std::size_t>(p.z() / kLength * kAlong));
        ++count[around * kAlong + along];
        ASSERT_GT(scan.normals[i].cast<double>().dot(Eigen::Vector3d(p.x(), p.y(), 0).normalized()), 0.9999);
    }
    EXPECT_GE(*std::min_element(count.begin(), count.end()), 8);
    EXPECT_LE(*std::max_element(count.begin(), count.end()), 26);
}

TEST(ReadMesh, FacesWithCornersThatAreNotFiniteAreDropped) {
    const Triangle hole{Eigen::Vector3f(0, 0, NAN), kLower[1], kLower[2]};
    const Scan scan = read_string(binary_stl({hole, kUpper}), kStl, {.unit = Unit::mm, .mesh_spacing_mm = 1});
    EXPECT_EQ(scan.points.size(), 600U);
    EXPECT_EQ(scan.points_in_file, 2U);
    EXPECT_EQ(scan.dropped_not_finite, 1U);
}

TEST(ReadMesh, AnObjWithoutFacesIsAScan) {
    const Scan scan = read_string("v 1 2 3\nvn 0 0 2\nv 4 5 6\nvn 1 0 0\nv nan 1 1\nvn 0 1 0\n", kObj);
    EXPECT_THAT(positions(scan), ::testing::ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
    EXPECT_THAT(scan.normals, ::testing::ElementsAre(Eigen::Vector3f(0, 0, 1), Eigen::Vector3f(1, 0, 0)));
    EXPECT_EQ(scan.dropped_not_finite, 1U);
    EXPECT_EQ(scan.format, "obj (vertices)");
    EXPECT_TRUE(read_string("v 1 2 3\nv 4 5 6\nvn 1 0 0\n", kObj).normals.empty());
}

TEST(ReadMesh, ErrorsInStl) {
    const std::string good = binary_stl({kLower});
    EXPECT_EQ(error_of(good + "x", kStl),
              "read: part: byte 80: the header promises a file of 134 bytes, but it has 135; export "
              "or copy the file again");
    EXPECT_THAT(error_of(good.substr(0, 133), kStl), HasSubstr("promises a file of 134 bytes, but it has 133"));
    EXPECT_THAT(error_of(good.substr(0, 83), kStl), HasSubstr("byte 83: the file ends within the 84 bytes"));
    std::string huge = good;
    huge.replace(80, 4, packed(std::uint32_t{0xffffffff}));
    EXPECT_THAT(error_of(huge, kStl), HasSubstr("promises a file of 214748364834 bytes, but it has 134"));
    EXPECT_THAT(error_of(binary_stl({}), kStl), HasSubstr("holds no points"));
    EXPECT_THAT(error_of(kAsciiStl.substr(0, kAsciiStl.find("endfacet")), kStl),
                HasSubstr("the file ends where 'endfacet' was expected"));
    std::string swapped = kAsciiStl;
    swapped.replace(swapped.find("endloop"), 7, "vertex ");
    EXPECT_THAT(error_of(swapped, kStl),
                HasSubstr("line 7: 'vertex' where 'endloop' was expected; export the file again"));
    std::string letters = kAsciiStl;
    letters.replace(letters.find("4e1"), 3, "abc");
    EXPECT_THAT(error_of(letters, kStl), HasSubstr("line 5: 'abc' is not a number; expected 'vertex x y z'"));
    EXPECT_THAT(error_of("solid empty\nendsolid empty\n", kStl), HasSubstr("holds no points"));
}

TEST(ReadMesh, ErrorsInObj) {
    const std::string three = "v 0 0 0\nv 40 0 0\nv 0 30 0\n";
    EXPECT_EQ(error_of(three + "f 1 2 999999999\n", kObj),
              "read: part: line 4: vertex index 999999999 in a file of 3 vertices; export or copy the file again");
    EXPECT_THAT(error_of(three + "f 1 2 0\n", kObj), HasSubstr("line 4: vertex index 0 with 3 vertices before it"));
    EXPECT_THAT(error_of(three + "f 1 2 -4\n", kObj), HasSubstr("line 4: vertex index -4 with 3 vertices before it"));
    EXPECT_THAT(error_of(three + "f 1 2 4294967297\n", kObj), HasSubstr("vertex index 4294967297 with 3"));
    EXPECT_THAT(error_of(three + "f 1 2 99999999999999999999\n", kObj), HasSubstr("is no corner of a face"));
    EXPECT_THAT(error_of(three + "f abc 1 2\n", kObj), HasSubstr("line 4: 'abc' is no corner of a face"));
    EXPECT_THAT(error_of(three + "f 1/x 1 2\n", kObj), HasSubstr("line 4: '1/x' is no corner of a face"));
    EXPECT_THAT(error_of(three + "f 1 2\n", kObj), HasSubstr("line 4: a face with 2 corners; expected at least 3"));
    EXPECT_THAT(error_of("v 1 2\n", kObj), HasSubstr("line 1: '' is not a number; expected three"));
    EXPECT_THAT(error_of("hello world\n", kObj), HasSubstr("line 1: 'hello' is no word of an OBJ file"));
    EXPECT_THAT(error_of("# nothing\n", kObj), HasSubstr("holds no points"));
}

TEST(ReadMesh, TooManyPointsOrNoneAreRefused) {
    EXPECT_THAT(
        error_of(binary_stl({kLower, kUpper}), kStl, {.unit = Unit::mm, .mesh_spacing_mm = 0.001}),
        HasSubstr("more than 20000000 points at read.mesh_spacing_mm; expected fewer; raise read.mesh_spacing_mm"));
    EXPECT_THAT(error_of(binary_stl({kLower, kUpper}), kStl, {.unit = Unit::mm, .mesh_spacing_mm = 100}),
                HasSubstr("2 faces have too little area for one point at read.mesh_spacing_mm"));
    const Triangle point{kLower[0], kLower[0], kLower[0]};
    EXPECT_THAT(error_of(binary_stl({point}), kStl), HasSubstr("1 faces have too little area"));
}

}  // namespace mesh_test
}  // namespace seampath::read_test
