#include "pipeline/report_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/report_thin.hpp"
#include "tests/report/example_part.hpp"

namespace seampath::test {
namespace report_view_test {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::Not;

std::size_t total(const ViewScene& scene) {
    return scene.clouds[0].points.size() + scene.clouds[1].points.size();
}

/// A plane of so many points, 0.1 mm apart, with a seam along its first row.
PartResult wide_plane(int rows, int columns) {
    PartResult part = part_without_seams();
    part.scan.points.clear();
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            part.scan.points.emplace_back(0.1F * static_cast<float>(c), 0.1F * static_cast<float>(r), 0);
        }
    }
    return part;
}

TEST(ReportView, ShowsEveryPointOfASmallScanOnceAndWhereItIs) {
    const PartResult part = example_part();
    const ViewScene scene = view_scene(part);
    ASSERT_EQ(total(scene), part.scan.points.size());
    Vector3d sum = Vector3d::Zero(), shown = Vector3d::Zero();
    for (std::size_t i = 0; i < part.scan.points.size(); ++i) {
        sum += part.scan.position(i);
    }
    for (const ViewCloud& cloud : scene.clouds) {
        for (const Eigen::Vector3f& p : cloud.points) {
            shown += p.cast<double>() + scene.centre;
        }
    }
    EXPECT_LT((sum - shown).norm() / static_cast<double>(total(scene)), 1e-4);
}

TEST(ReportView, ThinsLargeScansLessNearTheSeams) {
    const PartResult plane = wide_plane(1000, 1000);
    Seam seam;
    for (int i = 0; i <= 100; ++i) {
        seam.points.push_back(
            {plane.scan.origin_mm + Vector3d(i, 0, 0), Vector3d::UnitZ(), Vector3d::UnitY(), 0.01, false});
    }
    const auto clouds = thin_scan(plane.scan, {seam}, plane.scan.origin_mm);
    const auto near = static_cast<double>(clouds[0].points.size()), far = static_cast<double>(clouds[1].points.size());
    EXPECT_LE(near + far, 200000);
    EXPECT_GT(near + far, 180000);
    EXPECT_LT(clouds[0].spacing_mm, 0.6F * clouds[1].spacing_mm);
    // Half the spacing that a share of the plane leaves would be far too dense, double far too sparse.
    EXPECT_NEAR(clouds[1].spacing_mm, 100 * std::sqrt((1 - 0.12) / far), 0.15);
    for (const Eigen::Vector3f& p : clouds[0].points) {
        ASSERT_LT(p.y(), 20);
    }
    const auto again = thin_scan(plane.scan, {seam}, plane.scan.origin_mm);
    EXPECT_EQ(again[0].points, clouds[0].points);
}

TEST(ReportView, NormalsStandOnTheSurfaces) {
    const ViewScene scene = view_scene(example_part());
    std::size_t plate = 0, upright = 0;
    for (std::size_t i = 0; i < scene.clouds[1].points.size(); ++i) {
        const Vector3d p = scene.clouds[1].points[i].cast<double>() + scene.centre - Vector3d(1200, -350, 480);
        if (p.y() > 45) {  // nothing but the plate
            ++plate;
            upright += std::abs(scene.clouds[1].normals[i].z()) > 0.95F ? 1 : 0;
        }
    }
    EXPECT_GT(plate, 5000U);
    EXPECT_GT(static_cast<double>(upright), 0.99 * static_cast<double>(plate));
}

TEST(ReportView, LooksFromTheAirSideWithTheSharedFlankUpright) {
    const PartResult part = example_part();
    const ViewScene scene = view_scene(part);
    EXPECT_GT(scene.camera.toward.z(), 0.2);
    EXPECT_NEAR(scene.camera.toward.norm(), 1, 1e-12);
    EXPECT_NEAR(scene.camera.toward.dot(scene.camera.up), 0, 1e-12);
    EXPECT_GT(scene.camera.up.z(), 0.3);  // most flanks are the plate
    const Seam& rib = part.extraction.seams[1];
    EXPECT_GT(scene.seams[1].camera.toward.dot(rib.points[0].n1), 0.2);
    EXPECT_GT(scene.seams[1].camera.toward.dot(rib.points[0].n2), 0.2);
}

// A wall that hides a seam from the direction that would otherwise be best must turn the camera away.
TEST(ReportView, LooksPastWhatHidesTheSeam) {
    PartResult part = wide_plane(300, 300);
    Seam seam;
    for (int i = 0; i <= 60; ++i) {
        seam.points.push_back(
            {part.scan.origin_mm + Vector3d(0.5 * i, 0, 0), Vector3d::UnitZ(), Vector3d::UnitY(), 0.01, false});
    }
    part.extraction.seams = {seam};
    part.nodes.resize(1);
    part.models.resize(1);
    part.deviations.resize(1);
    const Vector3d open = view_scene(part).camera.toward;
    for (int a = 0; a < 200; ++a) {
        for (int b = 0; b < 200; ++b) {  // a screen of 20 mm across that direction, 12 mm in front of the seam's middle
            const Vector3d u = open.unitOrthogonal(), v = open.cross(u);
            const Vector3d p = Vector3d(15, 0, 0) + 12 * open + 0.1 * (a - 100) * u + 0.1 * (b - 100) * v;
            part.scan.points.push_back(p.cast<float>());
        }
    }
    const Vector3d past = view_scene(part).camera.toward;
    EXPECT_LT(past.dot(open), 0.97);
    EXPECT_GT(past.dot(Vector3d::UnitZ()), 0);
    EXPECT_GT(past.dot(Vector3d::UnitY()), 0);
}

TEST(ReportView, StrayPointsDoNotMoveThePictureOfAScanWithoutSeams) {
    PartResult part = part_without_seams();
    const ViewScene clean = view_scene(part);
    for (int i = 0; i < 20; ++i) {
        part.scan.points.emplace_back(5000, 5000, 5000);
    }
    const ViewScene stray = view_scene(part);
    EXPECT_LT((stray.centre - clean.centre).norm(), 1);
    EXPECT_NEAR(stray.radius_mm, clean.radius_mm, 1);
}

TEST(ReportView, PayloadHoldsThePointsAtMicrometres) {
    const ViewScene scene = view_scene(example_part());
    const auto json = nlohmann::json::parse(view_json(scene));
    const auto& cloud = json.at("clouds")[0];
    const std::size_t count = scene.clouds[0].points.size();
    EXPECT_EQ(cloud.at("count"), count);
    EXPECT_EQ(cloud.at("positions").get<std::string>().size(), (6 * count + 2) / 3 * 4);
    EXPECT_EQ(cloud.at("normals").get<std::string>().size(), (3 * count + 2) / 3 * 4);
    EXPECT_EQ(json.at("seams")[0].at("nodes").size(), 30U);
    EXPECT_TRUE(json.at("seams")[0].at("samples")[44][4].is_null());  // not covered
    EXPECT_GT(json.at("torch").size(), 20U);
    EXPECT_DOUBLE_EQ(json.at("scale").get<double>(), 0.1);
}

TEST(ReportView, StillPictureShowsCloudAndSeams) {
    const std::string svg = view_svg(view_scene(example_part(false)));
    EXPECT_THAT(svg, HasSubstr(kOutOfToleranceColour));
    EXPECT_THAT(svg, HasSubstr(kUncheckedColour));
    EXPECT_THAT(svg, HasSubstr("class=\"dots shade1\" d=\"M"));
    EXPECT_THAT(view_svg(view_scene(example_part(true))), Not(HasSubstr(kOutOfToleranceColour)));
}

}  // namespace report_view_test
}  // namespace seampath::test
