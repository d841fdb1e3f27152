#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/portable_math.hpp"
#include "stages/error.hpp"
#include "tests/datasets/scene_laws.hpp"

/// What the scenes of plates are, beyond the laws of every scene.
namespace seampath {
namespace plate_joints_test {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

SceneOptions of(SceneKind kind, Course course = Course::straight) {
    SceneOptions o;
    o.kind = kind;
    o.course = course;
    return o;
}

double length(const TruthSeam& seam) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < seam.points.size(); ++i) {
        sum += (seam.points[i + 1].p - seam.points[i].p).norm();
    }
    return sum;
}

TEST(PlateJoints, CoursesHaveTheLengthAndEndsThatGeometryGives) {
    for (const SceneKind kind : {SceneKind::lap, SceneKind::butt, SceneKind::v_groove, SceneKind::corner}) {
        for (const Course course : {Course::straight, Course::arc}) {
            SceneOptions o = of(kind, course);
            o.length_mm = 150;
            o.course_radius_mm = 200;
            const TruthSeam seam = make_scene(resolved(o, 1)).truth.seams.at(0);
            EXPECT_NEAR(length(seam), course == Course::arc ? 400 * std::asin(0.375) : 150, 1e-4) << name(kind);
            EXPECT_NEAR(std::abs(seam.points.front().p.x()), 75, 1e-12);
            EXPECT_NEAR(std::abs(seam.points.back().p.x()), 75, 1e-12);
        }
    }
    SceneOptions lap = of(SceneKind::lap, Course::s_curve);
    lap.amplitude_mm = 20;
    lap.wavelength_mm = 100;
    const TruthSeam wave = make_scene(resolved(lap, 1)).truth.seams.at(0);
    for (const TruthPoint& point : wave.points) {
        ASSERT_NEAR(point.p.y(), 20 * std::sin(2 * M_PI * point.p.x() / 100), 1e-12);
        ASSERT_EQ(point.p.z(), 0);
    }
}

TEST(PlateJoints, SeamsAreOfTheirKind) {
    const std::pair<SceneKind, JointKind> kinds[]{{SceneKind::tee, JointKind::fillet},
                                                  {SceneKind::box_on_plate, JointKind::fillet},
                                                  {SceneKind::pipe_on_plate, JointKind::saddle},
                                                  {SceneKind::pipe_on_pipe, JointKind::saddle},
                                                  {SceneKind::lap, JointKind::lap},
                                                  {SceneKind::butt, JointKind::butt},
                                                  {SceneKind::v_groove, JointKind::v_groove},
                                                  {SceneKind::corner, JointKind::corner},
                                                  {SceneKind::spatter, JointKind::fillet}};
    for (const auto& [scene, joint] : kinds) {
        for (const TruthSeam& seam : make_scene(resolved(of(scene), 1)).truth.seams) {
            EXPECT_EQ(seam.kind, joint) << name(scene);
            EXPECT_EQ(seam.groove.has_value(), joint == JointKind::butt || joint == JointKind::v_groove);
        }
    }
    std::vector<JointKind> kinds_of_multi;
    for (const TruthSeam& seam : make_scene(resolved(of(SceneKind::multi), 1)).truth.seams) {
        kinds_of_multi.push_back(seam.kind);
    }
    EXPECT_THAT(kinds_of_multi, testing::ElementsAre(JointKind::lap, JointKind::fillet, JointKind::fillet,
                                                     JointKind::saddle, JointKind::corner));
}

TEST(PlateJoints, UsualSizesAreThoseOfTheTrade) {
    const auto range = [](SceneOptions o, std::optional<double> SceneOptions::*size) {
        Eigen::AlignedBox<double, 1> all;
        for (std::uint64_t seed = 1; seed <= 400; ++seed) {
            all.extend(Eigen::Matrix<double, 1, 1>(*(resolved(o, seed).*size)));
        }
        return all;
    };
    const auto expect = [&](SceneOptions o, std::optional<double> SceneOptions::*size, double low, double high) {
        const auto all = range(o, size);
        const double slack = 0.02 * (high - low);  // 400 draws do not reach the very ends
        EXPECT_GE(all.min()[0], low - 1e-9);
        EXPECT_LE(all.min()[0], low + slack);
        EXPECT_LE(all.max()[0], high + 1e-9);
        EXPECT_GE(all.max()[0], high - slack);
    };
    expect(of(SceneKind::lap), &SceneOptions::thickness_mm, 1.5, 10);
    expect(of(SceneKind::butt), &SceneOptions::gap_mm, 0.3, 2);
    expect(of(SceneKind::butt), &SceneOptions::mismatch_mm, 0, 1.5);
    expect(of(SceneKind::v_groove), &SceneOptions::gap_mm, 0, 3);
    expect(of(SceneKind::v_groove), &SceneOptions::root_face_mm, 0, 3);
    expect(of(SceneKind::v_groove), &SceneOptions::included_angle_deg, 50, 90);
    expect(of(SceneKind::spatter), &SceneOptions::spatter_per_100mm, 0, 10);
}

TEST(PlateJoints, GrooveNumbersAreThoseAskedFor) {
    SceneOptions o = of(SceneKind::v_groove);
    o.plate_thickness_mm = 10;
    o.gap_mm = 2;
    o.root_face_mm = 3;
    o.mismatch_mm = 0;
    o.included_angle_deg = 60;
    const Groove v = make_scene(resolved(o, 1)).truth.seams.at(0).groove.value();
    EXPECT_EQ(v.gap_mm, 2);
    EXPECT_EQ(v.mismatch_mm, 0);
    EXPECT_NEAR(v.depth_mm, 7, 1e-12);
    EXPECT_NEAR(v.root_face_mm, 3, 1e-12);
    EXPECT_NEAR(v.bevel_1_deg, 30, 1e-12);
    EXPECT_NEAR(v.bevel_2_deg, 30, 1e-12);
    EXPECT_NEAR(v.included_angle_deg, 60, 1e-12);
    EXPECT_NEAR(v.area_mm2, 2 * 10 + 7 * 7 * std::tan(M_PI / 6), 1e-9);
    o.single_bevel = true;
    const Groove single = make_scene(resolved(o, 1)).truth.seams.at(0).groove.value();
    EXPECT_NEAR(single.bevel_1_deg, 60, 1e-12);
    EXPECT_EQ(single.bevel_2_deg, 0);
    EXPECT_NEAR(single.area_mm2, 2 * 10 + 7 * 7 * std::tan(M_PI / 3) / 2, 1e-9);
    o.kind = SceneKind::butt;
    o.mismatch_mm = 1;
    const Groove butt = make_scene(resolved(o, 1)).truth.seams.at(0).groove.value();
    EXPECT_NEAR(butt.area_mm2, 20, 1e-12);
    EXPECT_EQ(butt.mismatch_mm, 1);
    EXPECT_EQ(butt.depth_mm, 0);
    EXPECT_EQ(butt.root_face_mm, 10);
    EXPECT_EQ(butt.included_angle_deg, 0);
}

TEST(PlateJoints, GrooveAreaIsThatOfTheAirBetweenThePlates) {
    for (const bool single : {false, true}) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            SceneOptions o = of(SceneKind::v_groove);
            o.single_bevel = single;
            o = resolved(o, seed);
            const Scene scene = make_scene(o);
            const Groove groove = scene.truth.seams.at(0).groove.value();
            const double t = *o.plate_thickness_mm;
            const double reach = groove.depth_mm * std::tan(portable::radians(*o.included_angle_deg)) + groove.gap_mm;
            // Of all points between the lines that join the tops' edges and the undersides' edges, those in the air.
            const double right = -groove.gap_mm / 2 - groove.depth_mm * std::tan(portable::radians(groove.bevel_1_deg));
            const double left = groove.gap_mm / 2 + groove.depth_mm * std::tan(portable::radians(groove.bevel_2_deg));
            const double h = *o.mismatch_mm;
            const double kStep = 0.02;
            double area = 0;
            for (double y = -reach; y < reach; y += kStep) {
                const double top = h * (y - right) / (left - right);
                const double bottom = h * std::clamp(y / std::max(groove.gap_mm, 1e-9) + 0.5, 0.0, 1.0) - t;
                for (double z = -t; z < h; z += kStep) {
                    area += z < top && z > bottom && part_value(scene, {0.123, y, z}) > 0 ? kStep * kStep : 0;
                }
            }
            EXPECT_NEAR(area / groove.area_mm2, 1, 0.01) << single << ' ' << seed;
        }
    }
}

TEST(PlateJoints, NormalsOfAGrooveEncloseItsAngle) {
    for (const Course course : {Course::straight, Course::arc}) {
        for (const bool single : {false, true}) {
            SceneOptions o = of(SceneKind::v_groove, course);
            o.single_bevel = single;
            const TruthSeam seam = make_scene(resolved(o, 3)).truth.seams.at(0);
            for (const TruthPoint& point : seam.points) {
                const double angle = M_PI - std::acos(point.n1.dot(point.n2));
                ASSERT_NEAR(angle, portable::radians(seam.groove->included_angle_deg), 1e-9);
            }
        }
    }
}

TEST(PlateJoints, GrooveMayCloseAtTheRoot) {
    for (const Course course : {Course::straight, Course::arc}) {
        SceneOptions o = of(SceneKind::v_groove, course);
        o.gap_mm = 0;
        o.root_face_mm = 0;
        o.mismatch_mm = 0;
        const Scene scene = make_scene(resolved(o, 2));
        for (const TruthPoint& point : scene.truth.seams.at(0).points) {
            ASSERT_NEAR(point.p.z(), -*resolved(o, 2).plate_thickness_mm, 1e-9);
        }
        const TruthPoint& at = scene.truth.seams[0].points[700];
        const auto hit = first_hit(scene.surfaces, {at.p + 50 * Vector3d::UnitZ(), -Vector3d::UnitZ()});
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->t, 50, 1e-9);
    }
}

TEST(PlainPlate, HasHolesAndStepsAndNoSeam) {
    const SceneOptions o = resolved(of(SceneKind::plain), 1);
    const Scene scene = make_scene(o);
    EXPECT_TRUE(scene.truth.seams.empty());
    int through = 0, low = 0, high = 0;
    for (double x = -*o.length_mm / 2 + 1; x < *o.length_mm / 2; x += 2) {
        for (double y = -*o.width_mm / 2 + 1; y < *o.width_mm / 2; y += 2) {
            const auto hit = first_hit(scene.surfaces, {{x, y, 50}, -Vector3d::UnitZ()});
            const double z = hit ? 50 - hit->t : -1;
            through += hit ? 0 : 1;
            low += hit && std::abs(z) < 1e-9 ? 1 : 0;
            high += hit && std::abs(z - *o.step_mm) < 1e-9 ? 1 : 0;
            EXPECT_TRUE(!hit || std::abs(z) < 1e-9 || std::abs(z - *o.step_mm) < 1e-9);
        }
    }
    const double holes = 4 * M_PI * *o.radius_mm * *o.radius_mm / 4;  // in cells of 2 mm by 2 mm
    EXPECT_NEAR(through, holes, 0.2 * holes);
    EXPECT_GT(low, 1000);
    EXPECT_GT(high, 500);
}

TEST(PlateJoints, ImpossiblePartsAreRefused) {
    const auto refused = [](SceneOptions o, const char* text) {
        EXPECT_THAT([&] { make_scene(resolved(o, 1)); }, ThrowsMessage<InputError>(HasSubstr(text)));
    };
    refused(of(SceneKind::tee, Course::arc), "scene tee has a course of its own");
    refused(of(SceneKind::spatter, Course::arc), "scene spatter has a course of its own");
    for (const SceneKind kind : {SceneKind::butt, SceneKind::v_groove, SceneKind::corner}) {
        refused(of(kind, Course::s_curve), "no S-curved course");
    }
    SceneOptions o = of(SceneKind::lap, Course::arc);
    o.course_radius_mm = 60;
    o.length_mm = 130;
    refused(o, "an arc of radius 60 mm can't be 130 mm long");
    o = of(SceneKind::v_groove);
    o.plate_thickness_mm = 4;
    o.root_face_mm = 4;
    refused(o, "root face 4 mm leaves no groove");
    o = of(SceneKind::v_groove);
    o.single_bevel = true;
    o.included_angle_deg = 80;
    refused(o, "a bevel of 80 deg");
    o = of(SceneKind::v_groove);
    o.margin_mm = 3;
    refused(o, "wider than its plates");
    o = of(SceneKind::butt);
    o.mismatch_mm = -20;
    refused(o, "a mismatch of -20 mm");
    o = of(SceneKind::corner);
    o.margin_mm = 2;
    refused(o, "make margin_mm larger");
    o = of(SceneKind::multi);
    o.radius_mm = 90;
    refused(o, "wider than the plate");
    o = of(SceneKind::plain);
    o.radius_mm = 30;
    refused(o, "holes of radius 30 mm");
}

}  // namespace plate_joints_test
}  // namespace seampath
