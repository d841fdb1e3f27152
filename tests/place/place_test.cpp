#include "stages/place/place.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/rng.hpp"
#include "stages/error.hpp"
#include "tests/geometry/curves.hpp"

namespace seampath {
namespace place_test {

using Eigen::Vector3d;

constexpr double kTolerance = 0.05;

double distance_to_chord(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const double x = std::clamp((p - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-300), 0.0, 1.0);
    return (p - a - x * (b - a)).norm();
}

/// Largest distance of the points from `from` to `to` (which runs past the end of a closed seam) from their chord.
double chord_error(const Seam& seam, std::size_t from, std::size_t to) {
    const std::size_t n = seam.points.size();
    double worst = 0;
    for (std::size_t k = from; k <= to; ++k) {
        worst =
            std::max(worst, distance_to_chord(seam.points[k % n].p, seam.points[from % n].p, seam.points[to % n].p));
    }
    return worst;
}

double spacing(const Seam& seam, std::size_t from, std::size_t to) {
    const std::size_t n = seam.points.size();
    double length = 0;
    for (std::size_t k = from; k < to; ++k) {
        length += (seam.points[(k + 1) % n].p - seam.points[k % n].p).norm();
    }
    return length;
}

/// The largest chord error of the nodes by brute force, after checking their order and spacing.
double check_nodes(const Seam& seam, const Nodes& nodes, const PlaceOptions& options) {
    const auto& index = nodes.index;
    EXPECT_TRUE(std::is_sorted(index.begin(), index.end()));
    EXPECT_EQ(std::adjacent_find(index.begin(), index.end()), index.end()) << "a node twice";
    EXPECT_LT(index.back(), seam.points.size());
    if (!seam.closed) {
        EXPECT_EQ(index.front(), 0u);
        EXPECT_EQ(index.back(), seam.points.size() - 1);
    }
    double worst = 0;
    for (std::size_t k = 0; k + (seam.closed ? 0 : 1) < index.size(); ++k) {
        const std::size_t to = k + 1 < index.size() ? index[k + 1] : index[0] + seam.points.size();
        worst = std::max(worst, chord_error(seam, index[k], to));
        EXPECT_TRUE(to == index[k] + 1 || spacing(seam, index[k], to) <= options.max_spacing_mm + 1e-9);
    }
    EXPECT_NEAR(nodes.max_chord_error_mm, worst, 1e-12);
    EXPECT_LE(worst, options.chord_tolerance_mm);
    return worst;
}

/// Fewest nodes by trying every set of inner nodes; closed seams may start anywhere.
std::size_t fewest_by_force(const Seam& seam, const PlaceOptions& options) {
    const std::size_t n = seam.points.size();
    std::size_t best = n + 1;
    for (unsigned chosen = 0; chosen < 1u << n; ++chosen) {
        std::vector<std::size_t> index;
        for (std::size_t i = 0; i < n; ++i) {
            if (chosen >> i & 1u) {
                index.push_back(i);
            }
        }
        if (index.size() < 2 || index.size() >= best ||
            (!seam.closed && (index.front() != 0 || index.back() != n - 1))) {
            continue;
        }
        bool holds = true;
        for (std::size_t k = 0; holds && k + (seam.closed ? 0 : 1) < index.size(); ++k) {
            const std::size_t to = k + 1 < index.size() ? index[k + 1] : index[0] + n;
            holds = chord_error(seam, index[k], to) <= options.chord_tolerance_mm &&
                    (to == index[k] + 1 || spacing(seam, index[k], to) <= options.max_spacing_mm);
        }
        best = holds ? index.size() : best;
    }
    return best;
}

TEST(Place, HoldsTheToleranceUnderEveryChord) {
    const PlaceOptions options{kTolerance, 25};
    for (const bool closed : {false, true}) {
        check_nodes(seam_along(CircleCurve{30}, 300, closed), place(seam_along(CircleCurve{30}, 300, closed), options),
                    options);
    }
    const Seam helix = seam_along(Helix{20, 15, 2.5}, 500, false), wave = seam_along(SineCurve{200, 18}, 400, false);
    check_nodes(helix, place(helix, options), options);
    check_nodes(wave, place(wave, options), options);
}

TEST(Place, SeesTheSCurveWhoseMiddleLiesOnItsChord) {
    const Seam wave = seam_along(SineCurve{20, 1}, 41, false);
    ASSERT_NEAR(chord_error(wave, 0, 40), 1, 0.01);
    EXPECT_GT(place(wave, {kTolerance, 25}).index.size(), 4u);
}

TEST(Place, StraightSeamTakesItsEndsAndTheSpacingOnly) {
    const Seam seam = seam_along(Straight{{1, 2, 3}, {91, 2, 3}}, 181, false);
    EXPECT_THAT(place(seam, {kTolerance, 1000}).index, testing::ElementsAre(0u, 180u));
    EXPECT_EQ(place(seam, {kTolerance, 25}).index.size(), 5u);
}

TEST(Place, TakesAsFewNodesAsAnyChoice) {
    const Random random(21, 0);
    for (std::uint64_t trial = 0; trial < 24; ++trial) {
        Seam seam = seam_along(CircleCurve{random.uniform(1000 * trial, 5, 15)}, 13, trial % 2 == 0);
        for (std::size_t i = 0; i < seam.points.size(); ++i) {
            seam.points[i].p.z() += random.uniform(1000 * trial + i + 1, -0.6, 0.6);
        }
        const PlaceOptions options{random.uniform(1000 * trial + 50, 0.3, 2), trial % 3 == 0 ? 14.0 : 1000.0};
        const Nodes nodes = place(seam, options);
        check_nodes(seam, nodes, options);
        EXPECT_EQ(nodes.index.size(), fewest_by_force(seam, options))
            << "trial " << trial << (seam.closed ? ", closed" : ", open");
    }
}

TEST(Place, KeepsACorner) {
    Seam seam = seam_along(Straight{{0, 0, 0}, {40, 0, 0}}, 81, false);
    const Seam rest = seam_along(Straight{{40, 0.5, 0}, {40, 40, 0}}, 80, false);
    seam.points.insert(seam.points.end(), rest.points.begin(), rest.points.end());
    EXPECT_THAT(place(seam, {kTolerance, 1000}).index, testing::ElementsAre(0u, 80u, 160u));
}

TEST(Place, PutsMoreNodesWhereItBends) {
    const Seam wave = seam_along(SineCurve{200, 18}, 801, false);
    const Nodes nodes = place(wave, {kTolerance, 1000});
    double at_crest = 0, at_crossing = 0;
    for (std::size_t k = 0; k + 1 < nodes.index.size(); ++k) {
        const double length = spacing(wave, nodes.index[k], nodes.index[k + 1]);
        const auto covers = [&](std::size_t i) { return nodes.index[k] <= i && i < nodes.index[k + 1]; };
        at_crest = covers(200) ? length : at_crest;
        at_crossing = covers(400) ? length : at_crossing;
    }
    EXPECT_LT(at_crest, 0.8 * at_crossing);
}

TEST(Place, OfAReversedSeamTakesAsMany) {
    for (const bool closed : {false, true}) {
        Seam seam = seam_along(CircleCurve{30}, 200, closed);
        const Nodes nodes = place(seam, {kTolerance, 25});
        std::reverse(seam.points.begin(), seam.points.end());
        EXPECT_EQ(place(seam, {kTolerance, 25}).index.size(), nodes.index.size());
    }
}

TEST(Place, RefusesThreePoints) {
    EXPECT_THAT(
        [] {
            place(seam_along(Straight{{0, 0, 0}, {1, 0, 0}}, 3, false), {});
        },
        testing::ThrowsMessage<InputError>(testing::StartsWith("place: the seam has 3 points")));
}

}  // namespace place_test
}  // namespace seampath
