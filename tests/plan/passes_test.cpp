#include "stages/plan/passes.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/nominal/nominal.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace passes_test {

using Eigen::Vector3d;
using planning::Pass;
using planning::passes_of;
using test::kPi;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kDegree = kPi / 180;

PlanOptions fillet(double depth, double bead) {
    PlanOptions options;
    options.groove = GrooveForm::fillet;
    options.groove_depth_mm = depth;
    options.bead_area_mm2 = bead;
    return options;
}

std::vector<Waypoint> welds(const Plan& plan) {
    std::vector<Waypoint> all;
    for (const Waypoint& w : plan.waypoints) {
        if (w.kind == WaypointKind::weld_start || w.kind == WaypointKind::weld || w.kind == WaypointKind::weld_end) {
            all.push_back(w);
        }
    }
    return all;
}

// A right-angled fillet 10 mm deep is 100 mm2: a root bead 5 mm high and three beside each other on it, 25 mm2 each.
// The web stands along +Z (flank 1), the plate lies along +Y (flank 2).
TEST(Passes, FillARightAngledFillet) {
    const SeamModel model = test::model_of(test::line(120), false, 8);
    const auto passes = passes_of(model, 3, fillet(10, 25));
    ASSERT_EQ(passes.size(), 4u);
    const double root = 5, third = 10.0 / 3;  // height of the first layer; of its width, which the others stand on
    const Vector3d up = Vector3d(0, 1, 1).normalized(), across = Vector3d(0, -1, 1).normalized();
    const std::vector<Vector3d> aims{Vector3d::Zero(), root * up - third * across, root * up,
                                     root * up + third * across};
    const std::vector<double> tilts{0, 15 * kDegree, 0, -15 * kDegree};
    const std::vector<int> layers{0, 1, 1, 1}, beads{0, 0, 1, 2};
    for (std::size_t i = 0; i < passes.size(); ++i) {
        const PlannedPass& f = passes[i].facts;
        EXPECT_EQ(f.seam, 3);
        EXPECT_EQ(f.layer, layers[i]);
        EXPECT_EQ(f.bead, beads[i]);
        EXPECT_NEAR(f.area_mm2, 25, 1e-6);
        EXPECT_NEAR(f.up_mm, aims[i].dot(up), 1e-6);
        EXPECT_NEAR(f.across_mm, aims[i].dot(across), 1e-6);
        EXPECT_NEAR(f.tilt_rad, tilts[i], 1e-6);
        for (int k = 0; k <= 10; ++k) {
            const Vector3d p = position(passes[i].model.curve, 12.0 * k);
            EXPECT_LT((p - Vector3d(12 * k, 0, 0) - aims[i]).norm(), 1e-5);
            // The torch's body, out of the joint: leaning towards flank 1 by the tilt.
            const FlankSample flank = flanks_at(passes[i].model, 12.0 * k);
            const Vector3d body = std::cos(tilts[i]) * up + std::sin(tilts[i]) * across;
            EXPECT_LT(((flank.n1 + flank.n2).normalized() - body).norm(), 1e-6);
        }
        EXPECT_NEAR(passes[i].model.length_mm, 120, 1e-6);
    }
    PlanOptions other = fillet(10, 25);
    other.pass_order = PassOrder::flank1;
    EXPECT_GT(passes_of(model, 3, other)[1].facts.across_mm, 0) << "the bead beside flank 1 first";
}

// Round a pipe every pass is a circle.
TEST(Passes, RoundAPipeAreCircles) {
    const SeamModel model = test::model_of(test::circle(40), true, 64);  // flank 1 the plate, flank 2 the pipe
    for (const Pass& pass : passes_of(model, 0, fillet(8, 12))) {
        const double diagonal = std::sqrt(0.5);
        const double radius = 40 + diagonal * (pass.facts.up_mm + pass.facts.across_mm);
        const double height = diagonal * (pass.facts.up_mm - pass.facts.across_mm);
        EXPECT_NEAR(pass.model.length_mm, 2 * kPi * radius, 1e-3);
        for (int k = 0; k < 50; ++k) {
            const Vector3d p = position(pass.model.curve, model.length_mm * k / 50);
            EXPECT_NEAR(std::hypot(p.x(), p.y()), radius, 2e-3);
            EXPECT_NEAR(p.z(), height, 2e-3);
        }
    }
}

struct FormCase {
    GrooveForm form;
    double angle_deg, root_mm, middle_deg, area_mm2;  // the middle from the bisector, towards flank 1
};

TEST(Passes, FormsHaveTheirSections) {
    const SeamModel model = test::model_of(test::line(100), false, 8);
    const auto area = [](double angle_deg, double root) { return 6 * root + 36 * std::tan(0.5 * angle_deg * kDegree); };
    for (const FormCase& c :
         {FormCase{GrooveForm::v, 60, 2, 0, area(60, 2)}, FormCase{GrooveForm::bevel1, 45, 0, -22.5, area(45, 0)},
          FormCase{GrooveForm::bevel2, 50, 1, 20, area(50, 1)}}) {
        PlanOptions options = fillet(6, 5);
        options.groove = c.form;
        options.groove_angle_deg = c.angle_deg;
        options.groove_root_mm = c.root_mm;
        const auto passes = passes_of(model, 0, options);
        double sum = 0;
        for (const Pass& pass : passes) {
            sum += pass.facts.area_mm2;
            EXPECT_LE(std::abs(pass.facts.tilt_rad), 0.5 * c.angle_deg * kDegree + 1e-12);
        }
        EXPECT_NEAR(sum, c.area_mm2, 1e-6);
        const FlankSample root = flanks_at(passes.front().model, 50);
        const Vector3d middle = (root.n1 + root.n2).normalized();
        const double at =
            std::atan2(middle.dot(Vector3d(0, -1, 1).normalized()), middle.dot(Vector3d(0, 1, 1).normalized()));
        EXPECT_NEAR(at / kDegree, c.middle_deg, 1e-6) << kGrooveFormNames[static_cast<std::size_t>(c.form)];
    }
}

// On a saddle the opening changes all along; every pass stays in the air between both walls and within the fill.
TEST(Passes, StayInTheGrooveOfASaddle) {
    const double r = 150, R = 600, depth = 12;
    const SaddleCurve curve = saddle_of({HeaderKind::cylinder, r, R, 0, 0, 75 * kDegree, 60});
    const SeamModel model = nominal_model(curve, PoseLaw::bisector, 0);
    const auto passes = passes_of(model, 0, fillet(depth, 30));
    ASSERT_GT(passes.size(), 3u);
    const Cylinder& branch = curve.branch();
    double worst_sum = 0;
    for (const Pass& pass : passes) {
        EXPECT_GT(pass.facts.most_mm2, 1.3 * pass.facts.least_mm2) << "the opening changes";
        worst_sum += pass.facts.area_mm2;
        for (int k = 0; k < 360; ++k) {
            const Vector3d p = position(pass.model.curve, model.length_mm * k / 360);
            const Vector3d from = p - branch.point;
            const double off_branch = (from - from.dot(branch.axis) * branch.axis).norm() - r;
            const double off_header = std::hypot(p.x(), p.z()) - R;
            EXPECT_GE(off_branch, -0.15) << "walls bend away from the section's straight sides by little";
            EXPECT_GE(off_header, -0.15);
            const double off = (p - position(model.curve, nearest_parameter(model.curve, p))).norm();
            EXPECT_LE(off, depth * 2.5);
        }
    }
    // Against a brute-force mean of h^2 tan(psi / 2).
    double mean = 0;
    for (int k = 0; k < 5000; ++k) {
        mean += depth * depth * std::tan(0.5 * curve.at(curve.theta(curve.length() * (k + 0.5) / 5000)).opening) / 5000;
    }
    EXPECT_NEAR(worst_sum, mean, 1e-3 * mean);
}

// Laws: more beads for smaller ones, equal shares, layers from the root up, ends in the same plan from either end.
TEST(Passes, SharesAreEqualAndLayersRise) {
    const SeamModel model = test::model_of(test::helix(35, 30), false, 120);
    std::size_t before = 0;
    for (const double bead : {80.0, 40.0, 20.0, 10.0, 5.0, 2.5}) {
        const auto passes = passes_of(model, 0, fillet(9, bead));
        EXPECT_GE(passes.size(), before);
        before = passes.size();
        int layer = 0;
        double up = -1;
        for (const Pass& pass : passes) {
            EXPECT_NEAR(pass.facts.area_mm2, passes.front().facts.area_mm2, 1e-9);
            EXPECT_TRUE(pass.facts.layer == layer || pass.facts.layer == layer + 1);
            EXPECT_TRUE(pass.facts.layer == layer ? pass.facts.up_mm >= up - 1e-9 : pass.facts.up_mm > up);
            layer = pass.facts.layer;
            up = pass.facts.up_mm;
        }
        // As many as fill the section, to half a bead.
        EXPECT_NEAR(static_cast<double>(passes.size()), std::max(1.0, 81 / bead), 0.5 + 1e-9) << bead;
    }
}

TEST(Passes, ArePlannedOneAfterTheOther) {
    const std::vector<SeamModel> models{test::model_of(test::line(100), false, 8),
                                        test::model_of(test::circle(40), true, 64)};
    const Plan single = plan(models, {});
    const Plan multi = plan(models, fillet(8, 16));
    EXPECT_TRUE(single.passes.empty());
    std::size_t starts = 0;
    int index = 0, seam = 0;
    for (std::size_t k = 0; k < multi.waypoints.size(); ++k) {
        const Waypoint& w = multi.waypoints[k];
        starts += w.kind == WaypointKind::weld_start ? 1 : 0;
        EXPECT_EQ(w.index, w.seam == seam ? index : 0);
        seam = w.seam;
        index = w.index + 1;
        EXPECT_TRUE(k == 0 || w.time_s > multi.waypoints[k - 1].time_s);
    }
    EXPECT_EQ(starts, multi.passes.size());
    EXPECT_GT(multi.duration_s, 2.5 * single.duration_s);
    EXPECT_LE(multi.max_chord_error_mm, PlanOptions().chord_tolerance_mm);
    EXPECT_LE(multi.max_turn_deg, PlanOptions().max_turn_deg + 1e-9);
    // The constant speed holds along every pass.
    const auto all = welds(multi);
    for (std::size_t k = 1; k < all.size(); ++k) {
        if (all[k].kind != WaypointKind::weld_start) {
            EXPECT_NEAR((all[k].station_mm - all[k - 1].station_mm) / (all[k].time_s - all[k - 1].time_s), 8, 1e-6);
        }
    }
}

TEST(Passes, SayWhatCannotBeFilled) {
    const SeamModel line = test::model_of(test::line(100), false, 8);
    const auto inside = [](double t) {  // a bore's edge: the air is on the inner side
        const Vector3d out(std::cos(2 * kPi * t), std::sin(2 * kPi * t), 0);
        return test::Place{5 * out, -out, Vector3d::UnitZ()};
    };
    const SeamModel bore = test::model_of(inside, true, 32);
    const auto flat = [](double t) { return test::Place{{100 * t, 0, 0}, Vector3d::UnitZ(), Vector3d::UnitZ()}; };
    const SeamModel butt = test::model_of(flat, false, 8);
    EXPECT_THAT([&] { passes_of(line, 2, fillet(150, 1)); },
                ThrowsMessage<InputError>(HasSubstr("seam 2: a groove of 22500 mm2 would take more than 500 beads")));
    EXPECT_THAT([&] { passes_of(bore, 1, fillet(12, 20)); }, ThrowsMessage<InputError>(HasSubstr("folds back")));
    EXPECT_THAT([&] { passes_of(butt, 0, fillet(5, 20)); },
                ThrowsMessage<InputError>(HasSubstr("the groove opens by 180 deg")));
    PlanOptions v = fillet(5, 20);
    v.groove = GrooveForm::v;
    EXPECT_GE(passes_of(butt, 0, v).size(), 1u) << "a V about the upright of a butt";
    EXPECT_EQ(passes_of(line, 0, fillet(2, 1000)).size(), 1u) << "one pass at least";
    const auto two = passes_of(line, 0, fillet(5, 14));
    ASSERT_EQ(two.size(), 2u);
    EXPECT_EQ(two[1].facts.layer, 1) << "on a root without width a bead lies alone";
}

}  // namespace passes_test
}  // namespace seampath
