#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "tests/fit/models.hpp"
#include "tests/geometry/boxes.hpp"

/// Seams with true corners.
namespace seampath {
namespace cornered_test {

using Eigen::Vector3d;

double worst_of(const SeamModel& model, const SharpBox& box) {
    const ArcLength arc(model.curve);
    double worst = 0;
    for (int i = 0; i <= 1000; ++i) {
        worst = std::max(worst, box.distance(position(model.curve, arc.parameter(arc.length() * i / 1000))));
    }
    return worst;
}

TEST(Cornered, TheCurveHasTheCornersWhereItsPiecesMeet) {
    const SharpBox box = tilted_box();
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
        const SeamModel model = model_of(box.seam(1, 0.04, seed));
        EXPECT_TRUE(model.closed);
        EXPECT_TRUE(model.curve.periodic);
        EXPECT_NEAR(model.length_mm, 2 * (box.length + box.width), 0.1);
        EXPECT_LT(worst_of(model, box), 0.04) << seed;
        ASSERT_EQ(model.corners_mm.size(), 4u);
        const ArcLength arc(model.curve);
        for (std::size_t k = 0; k < 4; ++k) {
            const Vector3d at = position(model.curve, arc.parameter(model.corners_mm[k]));
            EXPECT_LT((at - box.corners()[k]).norm(), 0.04) << seed << ": " << k;
        }
    }
}

TEST(Cornered, SharesOnlyThePositionInItsCorners) {
    const SeamModel model = model_of(tilted_box().seam(1, 0.04, 1));
    int corners = 0;
    for (const CurveKnot& knot : knots_of(model.curve)) {
        EXPECT_TRUE(knot.continuity == 0 || knot.continuity == 2) << knot.u;
        corners += knot.continuity == 0;
    }
    EXPECT_EQ(corners, 4);
    const double period = last_parameter(model.curve) - first_parameter(model.curve);
    for (const CurveKnot& knot : knots_of(model.curve)) {
        const Vector3d before = position(model.curve, knot.u + period * (1 - 1e-12)),
                       behind = position(model.curve, knot.u);
        EXPECT_LT((behind - before).norm(), 1e-6) << knot.u;
    }
}

TEST(Cornered, FlanksAreThoseOfTheirOwnSide) {
    const SharpBox box = tilted_box();
    const SeamModel model = model_of(box.seam(1, 0.04, 1));
    for (const double corner : model.corners_mm) {
        const FlankSample before = flanks_at(model, corner + model.length_mm - 1e-6), behind = flanks_at(model, corner);
        EXPECT_LT((before.n1 - behind.n1).norm(), 1e-6);
        EXPECT_NEAR(before.n2.dot(behind.n2), 0, 1e-6) << corner;
    }
}

TEST(Cornered, AnOpenSeamKeepsItsEnds) {
    const SharpBox box = tilted_box();
    Seam seam = box.seam(1, 0.02, 2);
    seam.closed = false;  // from the first corner to a point before it
    seam.corners.erase(seam.corners.begin());
    const SeamModel model = model_of(seam);
    EXPECT_FALSE(model.closed);
    ASSERT_EQ(model.corners_mm.size(), 3u);
    EXPECT_NEAR(model.corners_mm[0], box.length, 0.05);
    EXPECT_NEAR(model.length_mm, 2 * (box.length + box.width) - 1, 0.1);
    EXPECT_LT(worst_of(model, box), 0.03);
}

TEST(Cornered, CornersAreNodesWhateverNodesAreFor) {
    const Seam seam = tilted_box().seam(1, 0.01, 1);
    for (const PlaceMethod method : {PlaceMethod::chord, PlaceMethod::spline, PlaceMethod::uniform}) {
        PlaceOptions options;
        options.method = method;
        const Nodes nodes = place(seam, options);
        for (const std::size_t corner : seam.corners) {
            EXPECT_THAT(nodes.index, testing::Contains(corner)) << name(method);
        }
        EXPECT_TRUE(std::is_sorted(nodes.index.begin(), nodes.index.end()));
        EXPECT_EQ(std::adjacent_find(nodes.index.begin(), nodes.index.end()), nodes.index.end());
        EXPECT_LE(nodes.max_chord_error_mm, options.chord_tolerance_mm) << name(method);
        if (nodes.line) {
            EXPECT_EQ(nodes.line->p.size(), nodes.index.size());
            EXPECT_NEAR(nodes.line->length_mm, 300, 0.2);
            EXPECT_LE(nodes.line->max_error_mm, options.spline_tolerance_mm);
        }
    }
}

TEST(Cornered, ModelsThatPassNodesHaveTheCornersToo) {
    const SharpBox box = tilted_box();
    const Seam seam = box.seam(1, 0.01, 3);
    for (const PlaceMethod method : {PlaceMethod::chord, PlaceMethod::uniform}) {
        PlaceOptions options;
        options.method = method;
        const Nodes nodes = place(seam, options);
        for (const FitModel kind : {FitModel::linear, FitModel::akima, FitModel::pchip, FitModel::parametric}) {
            FitOptions how;
            how.model = kind;
            const SeamModel model = fit(seam, nodes, how);
            EXPECT_LT(worst_of(model, box), 0.05) << name(kind) << ", " << name(method);
            EXPECT_EQ(model.corners_mm.size(), 4u);
        }
    }
}

TEST(Cornered, IsNoSaddle) {
    const Seam seam = tilted_box().seam(1, 0.04, 1);
    FitOptions options;
    options.model = FitModel::saddle;
    EXPECT_THROW(fit(seam, place(seam, {}), options), InputError);
}

}  // namespace cornered_test
}  // namespace seampath
