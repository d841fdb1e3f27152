#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/extract/extract.hpp"
#include "stages/fit/chi_squared.hpp"
#include "stages/fit/fit.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/flank_surface.hpp"
#include "tests/fit/pipes.hpp"
#include "tests/geometry/patches.hpp"

/// From scans of pipes to the model that `fit.model: auto` takes, and why.
namespace seampath {
namespace saddle_model_test {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr int kSteps = 400;

Seam seam_in(const Scan& scan) {
    const Extraction extraction = extract(scan, {});
    EXPECT_EQ(extraction.seams.size(), 1u);
    return extraction.seams.empty() ? Seam{} : extraction.seams.front();
}

SeamModel fitted(const Seam& seam, FitModel model = FitModel::automatic) {
    FitOptions options;
    options.model = model;
    return fit(seam, {}, options);
}

double largest_error(const SeamModel& model, const PipeScene& scene) {
    double largest = 0;
    for (int i = 0; i < kSteps; ++i) {
        const Vector3d p = seam_point(scene, 2 * std::numbers::pi * i / kSteps);
        largest = std::max(largest, (position(model.curve, nearest_parameter(model.curve, p)) - p).norm());
    }
    return largest;
}

void expect_within(const std::optional<Measured>& estimate, double truth, double most_sigma, const char* what) {
    ASSERT_TRUE(estimate) << what;
    EXPECT_NEAR(estimate->value, truth, 4 * estimate->sigma) << what;
    EXPECT_LT(estimate->sigma, most_sigma) << what;
    EXPECT_GT(estimate->sigma, 0) << what;
}

TEST(SaddleModel, IsTakenForRoundPipes) {
    PipeScene scene;
    for (const std::optional<double> header : {std::optional<double>(), std::optional(30.0)}) {
        scene.header_radius = header;
        scene.offset = header ? 4 : 0;
        const SeamModel model = fitted(seam_in(scan_of(scene)));
        EXPECT_EQ(model.model, "saddle");
        EXPECT_EQ(model.kind, JointKind::saddle);
        EXPECT_THAT(model.reason, HasSubstr("the pipe is round"));
        ASSERT_TRUE(model.saddle);
        EXPECT_EQ(model.saddle->header, header ? SurfaceShape::cylinder : SurfaceShape::plane);
        expect_within(model.saddle->branch_radius_mm, scene.radius, 0.02, "branch radius");
        expect_within(model.saddle->angle_rad, std::numbers::pi / 2 - scene.lean, 0.003, "angle");
        if (header) {
            expect_within(model.saddle->header_radius_mm, *header, 0.05, "header radius");
            expect_within(model.saddle->offset_mm, scene.offset, 0.05, "offset");
        }
        EXPECT_LT(largest_error(model, scene), 0.03);
        EXPECT_EQ(model.degrees_of_freedom, header ? 10 : 8);
    }
}

// The curve of a saddle is exact, so that its flanks are those of the walls and its tangent square to both.
TEST(SaddleModel, HasTheWallsNormals) {
    PipeScene scene;
    scene.header_radius = 30;
    const SeamModel model = fitted(seam_in(scan_of(scene)));
    const ArcLength arc(model.curve);
    for (const FlankSample& flank : model.flanks) {
        const Vector3d t = tangent(model.curve, arc.parameter(flank.station_mm));
        EXPECT_NEAR(flank.n1.norm(), 1, 1e-12);
        EXPECT_LT((flank.n1.cross(flank.n2).normalized() - t).norm(), 1e-4);
    }
}

TEST(SaddleModel, TakesSmoothOffsetsOfAnOvalPipe) {
    PipeScene scene;
    scene.radius = 20;
    scene.lean = 0;
    scene.ovality = 0.5;
    const Seam seam = seam_in(scan_of(scene));
    const SeamModel model = fitted(seam);
    EXPECT_EQ(model.model, "saddle with smooth offsets");
    EXPECT_THAT(model.reason, HasSubstr("out of round by 0.2"));
    EXPECT_LT(largest_error(model, scene), 0.05);
    EXPECT_GT(model.degrees_of_freedom, 8);
    // The exact saddle is off by what the pipe is out of round, and says so.
    const SeamModel exact = fitted(seam, FitModel::saddle);
    EXPECT_EQ(exact.model, "saddle");
    EXPECT_THAT(exact.reason, HasSubstr("fit.model asks for it, though the branch is out of round"));
    EXPECT_GT(largest_error(exact, scene), 0.08);
}

TEST(SaddleModel, LeavesACrushedPipeToTheSpline) {
    PipeScene scene;
    scene.ovality = 2.5;
    const SeamModel model = fitted(seam_in(scan_of(scene)));
    EXPECT_EQ(model.model, "spline");
    EXPECT_NE(model.kind, JointKind::saddle);
    EXPECT_FALSE(model.saddle);
    EXPECT_THAT(model.reason, HasSubstr("no saddle: "));
    EXPECT_LT(largest_error(model, scene), 0.08);
}

/// A box of 40 by 30 mm with upright edges of 8 mm radius on a plate.
Scan scan_of_box() {
    constexpr double kHalfX = 20, kHalfY = 15, kRadius = 8, kHeight = 14, kMargin = 14, kPi = std::numbers::pi;
    const Sampling sampling{0.5, 0.045, 1};
    std::vector<Eigen::Vector3f> points;
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
    const double length = 2 * (kHalfX - kRadius), width = 2 * (kHalfY - kRadius);
    add_rectangle(points, {-kHalfX + kRadius, -kHalfY, 0}, x, length, z, kHeight, sampling);
    add_rectangle(points, {-kHalfX + kRadius, kHalfY, 0}, x, length, z, kHeight, sampling);
    add_rectangle(points, {-kHalfX, -kHalfY + kRadius, 0}, y, width, z, kHeight, sampling);
    add_rectangle(points, {kHalfX, -kHalfY + kRadius, 0}, y, width, z, kHeight, sampling);
    for (int quarter = 0; quarter < 4; ++quarter) {
        const std::size_t begin = points.size();
        add_cylinder(points, kRadius, kHeight, sampling, quarter * kPi / 2, (quarter + 1) * kPi / 2);
        const Vector3d corner((quarter == 0 || quarter == 3 ? 0.5 : -0.5) * length, (quarter < 2 ? 0.5 : -0.5) * width,
                              0);
        std::for_each(points.begin() + static_cast<std::ptrdiff_t>(begin), points.end(),
                      [&](auto& p) { p += corner.cast<float>(); });
    }
    std::vector<Eigen::Vector3f> plate;
    add_rectangle(plate, {-kHalfX - kMargin, -kHalfY - kMargin, 0}, x, 2 * (kHalfX + kMargin), y,
                  2 * (kHalfY + kMargin), sampling);
    std::copy_if(plate.begin(), plate.end(), std::back_inserter(points), [&](const Eigen::Vector3f& p) {
        const double dx = std::abs(p.x()) - kHalfX + kRadius, dy = std::abs(p.y()) - kHalfY + kRadius;
        return std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) > kRadius;
    });
    return scan_of_points(std::move(points));
}

TEST(SaddleModel, LeavesABoxToTheSplineAndRefusesToBeForced) {
    const Seam seam = seam_in(scan_of_box());
    const SeamModel model = fitted(seam);
    EXPECT_EQ(model.model, "spline");
    EXPECT_EQ(model.kind, JointKind::fillet);
    EXPECT_THAT(model.reason, HasSubstr("no saddle: "));
    EXPECT_THAT([&] { fitted(seam, FitModel::saddle); },
                testing::ThrowsMessage<InputError>(testing::AllOf(HasSubstr("fit: fit.model saddle can't serve"),
                                                                  HasSubstr("set fit.model to auto or spline"))));
}

/// A seam of two walls of which points are known all round, without extraction.
Seam seam_of_walls(const SurfaceFit::Shape& branch, const SurfaceFit::Shape& header, const Patch& branch_patch,
                   const Patch& header_patch, const std::function<Vector3d(double)>& at, bool branch_first) {
    const auto b = fit_like(branch, points_of(branch_patch, 2000, {0.03, 0, 0}, 1), 1e-3),
               h = fit_like(header, points_of(header_patch, 2000, {0.03, 0, 0}, 2), 1e-3);
    Seam seam;
    seam.closed = true;
    const Random random(3, 0);
    for (std::uint64_t i = 0; i < 200; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / 200;
        const Vector3d p = at(branch_first ? -angle : angle);
        const Vector3d n1 = b->normal(p), n2 = h->normal(p);
        const Vector3d noisy = p + 0.01 * (random.normal(2 * i) * n1 + random.normal(2 * i + 1) * n2);
        seam.points.push_back({noisy, branch_first ? n1 : n2, branch_first ? n2 : n1, 0.015, false});
    }
    const FlankSurface one = flank_surface(*b, b->covariance()), other = flank_surface(*h, h->covariance());
    seam.surfaces.first = branch_first ? one : other;
    seam.surfaces.second = branch_first ? other : one;
    seam.surfaces.covariance_between = rows_of(Eigen::MatrixXd::Zero(branch_first ? b->parameters() : h->parameters(),
                                                                     branch_first ? h->parameters() : b->parameters()));
    return seam;
}

Seam pipes_at_right_angles(double radius, double header_radius, bool branch_first = true) {
    const Cylinder branch{{0, 0, 0}, Vector3d::UnitZ(), radius}, header{{0, 0, 0}, Vector3d::UnitY(), header_radius};
    const double turn = 2 * std::numbers::pi;
    return seam_of_walls(
        branch, header, {branch, 0, turn, header_radius, header_radius + 30}, {header, 0, turn, -60, 60},
        [=](double a) {
            const double x = radius * std::cos(a);
            return Vector3d(x, radius * std::sin(a), std::sqrt(header_radius * header_radius - x * x));
        },
        branch_first);
}

TEST(SaddleModel, RefusesEqualRadiiWithTheReason) {
    const SeamModel model = fitted(pipes_at_right_angles(30, 30));
    EXPECT_EQ(model.model, "spline");
    EXPECT_THAT(model.reason, HasSubstr("as wide as the header"));
    EXPECT_EQ(fitted(pipes_at_right_angles(28, 30)).model, "saddle");
}

TEST(SaddleModel, FollowsTheSeamsOwnDirection) {
    for (const bool branch_first : {true, false}) {
        const Seam seam = pipes_at_right_angles(20, 30, branch_first);
        const SeamModel model = fitted(seam);
        ASSERT_EQ(model.model, "saddle") << model.reason;
        EXPECT_LT((position(model.curve, 0) - seam.points.front().p).norm(), 0.05);
        for (std::size_t i = 1; i < model.flanks.size(); ++i) {
            EXPECT_GT(model.flanks[i].station_mm, model.flanks[i - 1].station_mm);
            EXPECT_GT(model.flanks[i].n1.dot(seam.points[i].n1), 0.999);
            EXPECT_GT(model.flanks[i].n2.dot(seam.points[i].n2), 0.999);
        }
    }
}

TEST(SaddleModel, IsAStretchWhereOnlyThatWasSeen) {
    Seam seam = pipes_at_right_angles(20, 30);
    seam.closed = false;
    seam.points.resize(140);
    const SeamModel model = fitted(seam);
    ASSERT_EQ(model.model, "saddle") << model.reason;
    EXPECT_FALSE(model.curve.periodic);
    EXPECT_LT((position(model.curve, first_parameter(model.curve)) - seam.points.front().p).norm(), 0.05);
    EXPECT_LT((position(model.curve, last_parameter(model.curve)) - seam.points.back().p).norm(), 0.05);
    seam.points.resize(80);
    EXPECT_THAT(fitted(seam).reason, HasSubstr("does not go round a pipe"));
}

TEST(SaddleModel, TakesWhatIsKnown) {
    const Seam seam = pipes_at_right_angles(20, 30);
    FitOptions options;
    const Measured free = fit(seam, {}, options).saddle->branch_radius_mm;
    options.branch_radius_mm = {20, 1e-4};
    options.angle_deg = {90, 1e-4};
    const SeamModel held = fit(seam, {}, options);
    EXPECT_NEAR(held.saddle->branch_radius_mm.value, 20, 2e-4);
    EXPECT_LT(held.saddle->branch_radius_mm.sigma, 1e-4);
    EXPECT_GT(free.sigma, 3e-4);
    EXPECT_NEAR(held.saddle->angle_rad->value, std::numbers::pi / 2, 1e-5);
    // A wrong drawing does not bend the seam.
    options.branch_radius_mm = {25, 1e-4};
    EXPECT_THAT(fit(seam, {}, options).reason, HasSubstr("not what was scanned: chi-squared"));
}

TEST(SaddleModel, RefusesNominalsThatSayNothing) {
    const Seam seam = pipes_at_right_angles(20, 30);
    FitOptions options;
    options.offset_mm = {3, 0};
    EXPECT_THAT([&] { fit(seam, {}, options); },
                testing::ThrowsMessage<InputError>(HasSubstr("fit.offset_mm is 3 with a sigma of 0")));
    options.offset_mm = {3, 0.1};
    options.model = FitModel::spline;
    EXPECT_THAT([&] { fit(seam, {}, options); }, testing::ThrowsMessage<InputError>(HasSubstr("are for a saddle")));
}

TEST(SaddleModel, MovesWithItsSeam) {
    const Eigen::Isometry3d move =
        Eigen::Translation3d(1e4, -2e4, 500) * Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized());
    const Seam seam = pipes_at_right_angles(20, 30);
    Seam there = seam;
    for (SeamPoint& point : there.points) {
        point.p = move * point.p;
        point.n1 = move.linear() * point.n1;
        point.n2 = move.linear() * point.n2;
    }
    for (FlankSurface* surface : {&*there.surfaces.first, &*there.surfaces.second}) {
        for (Vector3d* p : {&surface->point, &surface->origin}) {
            *p = move * *p;
        }
        for (Vector3d* v : {&surface->direction, &surface->e0, &surface->e1}) {
            *v = move.linear() * *v;
        }
    }
    const SeamModel a = fitted(seam), b = fitted(there);
    EXPECT_NEAR(a.length_mm, b.length_mm, 1e-7);
    EXPECT_NEAR(a.saddle->offset_mm->value, b.saddle->offset_mm->value, 1e-8);
    for (int i = 0; i < 50; ++i) {
        const double u = a.length_mm * i / 50;
        EXPECT_LT((move * position(a.curve, u) - position(b.curve, u)).norm(), 1e-6);
    }
}

// Of independent residuals there are as many as told, and the sigmas hold as often as they should.
TEST(ChiSquared, HoldsForNoiseOfTheStatedSigmaAndCountsWhatIsIndependent) {
    constexpr int kTrials = 400, kPoints = 120, kHalf = 6;
    for (const bool smooth : {false, true}) {
        int held = 0, doubled = 0;
        double freedom = 0;
        for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
            const Random random(seed, 0);
            std::vector<Eigen::Vector2d> white, z;
            for (std::uint64_t i = 0; i < kPoints; ++i) {
                white.emplace_back(random.normal(2 * i), random.normal(2 * i + 1));
            }
            for (int i = 0; i < kPoints; ++i) {
                Eigen::Vector2d sum = Eigen::Vector2d::Zero();
                for (int k = smooth ? -kHalf : 0; k <= (smooth ? kHalf : 0); ++k) {
                    sum += white[static_cast<std::size_t>((i + k + kPoints) % kPoints)];
                }
                z.push_back(sum / std::sqrt(2.0 * (smooth ? 2 * kHalf + 1 : 1)));
            }
            const ChiSquared test = chi_squared(z, true);
            held += test.holds();
            freedom += test.freedom / kTrials;
            for (Eigen::Vector2d& r : z) {
                r *= 3;
            }
            doubled += chi_squared(z, true).holds();
        }
        EXPECT_GT(held, 0.97 * kTrials) << smooth;
        EXPECT_LT(doubled, 0.05 * kTrials) << smooth;
        // The window's correlations 1 - |k| / 13 have squares that sum up to 8.7.
        EXPECT_NEAR(freedom, smooth ? kPoints / 8.7 : kPoints, (smooth ? 0.3 : 0.5) * (smooth ? 14 : kPoints));
    }
}

}  // namespace saddle_model_test
}  // namespace seampath
