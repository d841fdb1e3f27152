#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/fit/fit.hpp"
#include "stages/geometry/path_moves.hpp"
#include "stages/geometry/piecewise_cubic.hpp"
#include "stages/place/place.hpp"
#include "tests/fit/models.hpp"
#include "tests/papers/saddles.hpp"

namespace seampath {
namespace spline_nodes_test {

using Eigen::Vector3d;

constexpr double kSplineTolerance = 0.01, kHeader = 600;

/// Exact points of a saddle at equal steps, with noise of that sigma along each axis.
Seam saddle_seam(const SaddleCurve& saddle, int points, double noise = 0) {
    const Random random(11, 0);
    Seam seam;
    seam.closed = true;
    for (int i = 0; i < points; ++i) {
        const SaddlePoint at = saddle.at(saddle.theta(saddle.length() * i / points));
        const auto k = 3 * static_cast<std::uint64_t>(i);
        const Vector3d off(random.normal(k), random.normal(k + 1), random.normal(k + 2));
        seam.points.push_back({at.p + noise * off, at.n1, at.n2, std::max(0.01, std::sqrt(2.0) * noise), false});
    }
    return seam;
}

/// Distance of p from the saddle, by golden sections of the branch angle around that of p.
double distance_to(const SaddleCurve& saddle, const Vector3d& p, double near_theta) {
    double from = near_theta - 0.05, to = near_theta + 0.05;
    const double share = 0.5 * (std::sqrt(5.0) - 1);
    for (int step = 0; step < 30; ++step) {
        const double a = to - share * (to - from), b = from + share * (to - from);
        ((saddle.at(a).p - p).norm() < (saddle.at(b).p - p).norm() ? to : from) =
            (saddle.at(a).p - p).norm() < (saddle.at(b).p - p).norm() ? b : a;
    }
    return (saddle.at(0.5 * (from + to)).p - p).norm();
}

PlaceOptions spline_options(PlaceMethod method = PlaceMethod::spline) {
    PlaceOptions options;
    options.method = method;
    options.spline_tolerance_mm = kSplineTolerance;
    options.max_spacing_mm = 1e6;
    return options;
}

/// Largest distance of the periodic spline that fit lays through the nodes from the exact saddle.
double spline_error(const Seam& seam, const Nodes& nodes, const SaddleCurve& saddle) {
    FitOptions options;
    options.model = FitModel::periodic;
    const SeamModel model = fit(seam, nodes, options);
    const ArcLength arc(model.curve);
    double worst = 0;
    for (int i = 0; i < 800; ++i) {
        const Vector3d p = position(model.curve, arc.parameter(arc.length() * i / 800));
        const Vector3d on_branch = p - saddle.branch().point;
        const Vector3d e1 = saddle.at(0).n1, e2 = saddle.at(kPi / 2).n1;
        worst = std::max(worst, distance_to(saddle, p, std::atan2(on_branch.dot(e2), on_branch.dot(e1))));
    }
    return worst;
}

struct Row {
    double radius;
    std::size_t most_nodes, uniform_nodes;
};
// What nodes at equal angles and equal arcs need on these saddles is known from others' programs.
constexpr std::array<Row, 3> kRows{{{150, 18, 20}, {540, 43, 72}, {588, 58, 144}}};

TEST(SplineNodes, AreFewOnSaddlesAndHoldEverywhere) {
    for (const Row& row : kRows) {
        const SaddleCurve saddle = pipes(kHeader, row.radius);
        const Seam seam = saddle_seam(saddle, 2000);
        const Nodes nodes = place(seam, spline_options());
        EXPECT_LE(nodes.index.size(), row.most_nodes) << row.radius;
        const double error = spline_error(seam, nodes, saddle);
        EXPECT_LE(error, kSplineTolerance) << row.radius;
        EXPECT_NEAR(nodes.line->max_error_mm, error, 0.05 * kSplineTolerance) << row.radius;
        const Nodes uniform = place(seam, spline_options(PlaceMethod::uniform));
        EXPECT_NEAR(static_cast<double>(uniform.index.size()), static_cast<double>(row.uniform_nodes),
                    0.08 * static_cast<double>(row.uniform_nodes));
        EXPECT_LE(spline_error(seam, uniform, saddle), kSplineTolerance) << row.radius;
    }
}

TEST(SplineNodes, OfANoisySeamFollowItsSmoothLine) {
    const SaddleCurve saddle = pipes(kHeader, 150);
    const Seam seam = saddle_seam(saddle, 2000, 0.1);
    const Nodes nodes = place(seam, spline_options());
    EXPECT_LE(nodes.index.size(), 24u);
    EXPECT_LE(nodes.line->max_error_mm, kSplineTolerance);
    EXPECT_LE(spline_error(seam, nodes, saddle), 0.05);
}

/// Largest distance of the spline with ends that are no knots through some points of a sine from it, by its slope.
double error_through(const Nodes& all, const std::vector<std::size_t>& chosen, const SineCurve& sine) {
    std::vector<double> s, x, y;
    for (const std::size_t k : chosen) {
        s.push_back(all.line->station_mm[k]);
        x.push_back(all.line->p[k].x());
        y.push_back(all.line->p[k].y());
    }
    const PiecewiseCubic cx = not_a_knot_spline(s, x), cy = not_a_knot_spline(s, y);
    const double wave = 2 * kPi / sine.length;
    double worst = 0;
    for (int i = 0; i <= 200; ++i) {
        const double at = s.back() * i / 200, angle = wave * cx.value(at);
        const double slope = sine.amplitude * wave * std::cos(angle);
        worst = std::max(worst, std::abs(cy.value(at) - sine.amplitude * std::sin(angle)) / std::hypot(1, slope));
    }
    return worst;
}

// Which points are the best few is not searched through: where there are hardly more points than nodes, two can be
// left.
TEST(SplineNodes, AreHardlyMoreThanTheBestChoiceOfThem) {
    const SineCurve sine{60, 9};
    const Seam seam = seam_along(sine, 14, false);
    PlaceOptions every = spline_options();
    every.spline_tolerance_mm = 1e-9;
    const Nodes all = place(seam, every);
    ASSERT_EQ(all.index.size(), 14u);
    for (const double tolerance : {0.05, 0.2, 0.6}) {
        PlaceOptions options = spline_options();
        options.spline_tolerance_mm = tolerance;
        const Nodes nodes = place(seam, options);
        std::size_t fewest = 14;
        for (unsigned inner = 0; inner < 1u << 12; ++inner) {
            std::vector<std::size_t> chosen{0};
            for (std::size_t k = 1; k < 13; ++k) {
                if (inner >> (k - 1) & 1u) {
                    chosen.push_back(k);
                }
            }
            chosen.push_back(13);
            if (chosen.size() < fewest && error_through(all, chosen, sine) <= tolerance) {
                fewest = chosen.size();
            }
        }
        EXPECT_LE(nodes.index.size(), fewest + 2) << tolerance;
        EXPECT_GE(nodes.index.size(), fewest) << tolerance;
    }
}

TEST(SplineNodes, KeepTheBoundsOnTheirSpacing) {
    const Seam seam = seam_along(SineCurve{200, 18}, 801, false);
    PlaceOptions options = spline_options();
    options.max_spacing_mm = 7;
    const auto spacing = [](const Nodes& nodes) {
        std::vector<double> steps;
        for (std::size_t k = 0; k + 1 < nodes.index.size(); ++k) {
            steps.push_back(nodes.line->station_mm[k + 1] - nodes.line->station_mm[k]);
        }
        return steps;
    };
    EXPECT_THAT(spacing(place(seam, options)), testing::Each(testing::Le(7 + 1e-6)));
    const Nodes free = place(seam, spline_options());
    options = spline_options();
    options.min_spacing_mm = 30;
    const Nodes wide = place(seam, options);
    EXPECT_THAT(spacing(wide), testing::Each(testing::Ge(30 - 1e-6)));
    EXPECT_LT(wide.index.size(), free.index.size());
    EXPECT_LE(free.line->max_error_mm, kSplineTolerance);
    EXPECT_GT(wide.line->max_error_mm, kSplineTolerance) << "the error that is left is told";
}

TEST(SplineNodes, SpreadTheErrorEvenly) {
    const Nodes nodes = place(saddle_seam(pipes(kHeader, 588), 4000), spline_options());
    const SaddleCurve saddle = pipes(kHeader, 588);
    // The law by itself: the integral of |d4p/ds4|^(1/4) over an interval, by differences of the exact saddle.
    const auto density = [&](double s) {
        constexpr double h = 4;
        const auto at = [&](double x) { return saddle.at(saddle.theta(x)).p; };
        return std::pow((at(s - 2 * h) - 4 * at(s - h) + 6 * at(s) - 4 * at(s + h) + at(s + 2 * h)).norm(), 0.25) / h;
    };
    std::vector<double> shares;
    for (std::size_t k = 0; k < nodes.index.size(); ++k) {
        const double from = nodes.line->station_mm[k];
        const double to = k + 1 < nodes.index.size() ? nodes.line->station_mm[k + 1]
                                                     : nodes.line->station_mm[0] + nodes.line->length_mm;
        double sum = 0;
        for (int i = 0; i < 20; ++i) {
            sum += density(from + (to - from) * (i + 0.5) / 20) * (to - from) / 20;
        }
        shares.push_back(sum);
    }
    std::sort(shares.begin(), shares.end());
    EXPECT_LT(shares[shares.size() * 9 / 10], 2.5 * shares[shares.size() / 10]);
}

// By symmetry two halves, from crown to crown, are the whole seam.
TEST(Moves, OfASaddleAreFew) {
    const SaddleCurve saddle = pipes(kHeader, 588);
    Seam half;
    constexpr int kPoints = 8000;
    for (int i = 0; i <= kPoints; ++i) {
        const SaddlePoint at = saddle.at(saddle.theta(0.5 * saddle.length() * i / kPoints));
        half.points.push_back({at.p, at.n1, at.n2, 0.01, false});
    }
    EXPECT_LE(2 * (place(half, {0.05, 1e6}).index.size() - 1), 290u);

    std::vector<PathPose> poses;
    for (int i = 0; i <= 2000; ++i) {
        poses.push_back({saddle.at(saddle.theta(saddle.length() * i / 2000)).p, Eigen::Quaterniond::Identity()});
    }
    EXPECT_LE(fewest_moves(poses, {0.05, kPi}).size(), 40u);
}

TEST(SplineNodes, RefuseWhatCantBe) {
    const Seam seam = seam_along(SineCurve{200, 18}, 50, false);
    PlaceOptions options = spline_options();
    options.max_spacing_mm = 5;
    options.min_spacing_mm = 6;
    EXPECT_THAT([&] { place(seam, options); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("place.min_spacing_mm is 6, above")));
    options.max_spacing_mm = 50;
    options.method = PlaceMethod::chord;
    EXPECT_THAT([&] { place(seam, options); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("place.method is chord")));
    Seam nowhere = seam;
    for (SeamPoint& point : nowhere.points) {
        point.p = {1, 2, 3};
    }
    EXPECT_THAT([&] { place(nowhere, spline_options()); },
                testing::ThrowsMessage<InputError>(testing::StartsWith("place: the seam has no length")));
    EXPECT_THAT(
        [&] {
            place(seam_along(SineCurve{200, 18}, 5, false), spline_options());
        },
        testing::ThrowsMessage<InputError>(testing::StartsWith("place: the seam has 5 points; at least 6")));
}

}  // namespace spline_nodes_test
}  // namespace seampath
