#include "pipeline/frame_files.hpp"

#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/geometry/rigid.hpp"

namespace seampath {
namespace frame_files_test {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

Isometry3d frame(const Vector3d& p, double a_deg, double b_deg, double c_deg) {
    Isometry3d T = Isometry3d::Identity();
    T.linear() =
        (Eigen::AngleAxisd(a_deg * kDegree, Vector3d::UnitZ()) * Eigen::AngleAxisd(b_deg * kDegree, Vector3d::UnitY()) *
         Eigen::AngleAxisd(c_deg * kDegree, Vector3d::UnitX()))
            .toRotationMatrix();
    T.translation() = p;
    return T;
}

// One pose whose numbers in every convention three independent programs (RoboDK's library, Orocos KDL, FreeCAD) agree
// on.
TEST(FrameFiles, KnownPoseInEveryLanguage) {
    const auto files = frame_files(frame({25.1234, 10.5678, -1.25}, -30, -20, -170), "jig 7", 3);
    ASSERT_EQ(files.size(), kFrameFormats.size());
    EXPECT_THAT(files[0].text, HasSubstr("PERS wobjdata w_jig_7:=[FALSE,TRUE,\"\",[[25.1234,10.5678,-1.2500],["));
    EXPECT_THAT(files[0].text, testing::AnyOf(HasSubstr("[0.038134576,-0.951548525,0.239298338,-0.189307857]"),
                                              HasSubstr("[-0.038134576,0.951548525,-0.239298338,0.189307857]")));
    EXPECT_THAT(files[1].text,
                HasSubstr("BASE_DATA[3]={X 25.1234,Y 10.5678,Z -1.2500,A -30.000000,B -20.000000,C -170.000000}"));
    EXPECT_THAT(files[2].text, HasSubstr("PR[3,3]=(-1.2500) ;"));
    EXPECT_THAT(files[2].text, HasSubstr("PR[3,4]=(-170.0000) ;"));
    EXPECT_THAT(files[2].text, HasSubstr("PR[3,6]=(-30.0000) ;"));
    EXPECT_THAT(files[2].text, HasSubstr("UFRAME[3]=PR[3] ;"));
    EXPECT_THAT(files[3].text,
                HasSubstr("p[0.02512340, 0.01056780, -0.00125000, -2.91890963, 0.73405634, -0.58070872]"));
    EXPECT_THAT(files[4].text, HasSubstr("////BUSER 25.123,10.568,-1.250,-170.0000,-20.0000,-30.0000\r\n"));
    EXPECT_THAT(files[6].text, HasSubstr("rpy=\"-2.967059728 -0.349065850 -0.523598776\""));
}

// Straight down, half turns, and where Euler angles lose one of theirs.
TEST(FrameFiles, ReadBackWhereAnglesAreSingular) {
    for (const auto& [a, b, c] : {std::array{0.0, 0.0, 180.0},
                                  {0.0, 180.0, 0.0},
                                  {180.0, 0.0, 0.0},
                                  {30.0, 90.0, 0.0},
                                  {-75.0, -90.0, 40.0},
                                  {0.0, 0.0, 0.0},
                                  {179.99999, 0.0, -179.99999},
                                  {10.0, 89.99999, 20.0}}) {
        EXPECT_NO_THROW(frame_files(frame({1, 2, 3}, a, b, c), "x", 1)) << a << " " << b << " " << c;
    }
}

TEST(FrameFiles, RandomFramesReadBackWithinTheRounding) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 500; ++i) {
        Isometry3d T = Isometry3d::Identity();
        T.linear() = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                         .normalized()
                         .toRotationMatrix();
        T.translation() = 1500 * Vector3d(normal(random), normal(random), normal(random));
        for (const FrameFile& file : frame_files(T, "f", 1)) {
            EXPECT_LE(file.position_error_mm, 1e-3) << file.format;
            EXPECT_LE(file.turn_error_rad, 2e-6) << file.format;
            EXPECT_LT(displacement(read_frame(file.format, file.text), T).norm(), 2e-3);
        }
    }
}

}  // namespace frame_files_test
}  // namespace seampath
