#include "stages/fit/saddle_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "tests/geometry/patches.hpp"

/// Saddles from noisy points of a branch and of a header.
namespace seampath {
namespace saddle_fit_test {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kTurn = 2 * std::numbers::pi;

/// A branch of radius 80 that leans by 70 deg on a header, 25 mm off its axis, both turned and shifted.
struct Scene {
    Patch branch, header;
    double angle, offset;
};

const Vector3d kMiddle(30, -500, 220);
const Vector3d kAlong = Vector3d(0.3, -0.5, 1).normalized();
const Vector3d kSquare = kAlong.unitOrthogonal();
constexpr double kRadius = 80, kAngle = 70 * kDegree, kOffset = 25;

Cylinder leaning_branch(double radius, double angle, double offset) {
    const Vector3d axis = std::cos(angle) * kAlong + std::sin(angle) * kSquare;
    return {kMiddle + offset * axis.cross(kAlong).normalized(), axis, radius};
}

Patch all_round(const Cylinder& branch, double from, double to) {
    return {branch, 0, kTurn, from, to};
}

// The header's patch is where the branch stands: `about` counts angles from kSquare.
Scene on_pipe(double arc, double radius = kRadius, double angle = kAngle, double offset = kOffset) {
    return {all_round(leaning_branch(radius, angle, offset), 350, 500),
            {Cylinder{kMiddle, kAlong, 300}, -arc / 2, arc / 2, -250, 250},
            angle,
            offset};
}

const Scene kOnPipe = on_pipe(120 * kDegree);
const Scene kOnPlane{all_round(leaning_branch(kRadius, 70 * kDegree, 0), 50, 200),
                     {Plane{kMiddle, kSquare}, -200, 200, -200, 200},
                     70 * kDegree,
                     0};
const Scene kOnSphere{all_round(leaning_branch(kRadius, kAngle, kOffset), 350, 500),
                      {Sphere{kMiddle, 300}, 0, kTurn, -60 * kDegree, 60 * kDegree},
                      0,
                      kOffset};
const Scene kOnCone{all_round(leaning_branch(kRadius, kAngle, kOffset), 350, 500),
                    {Cone{kMiddle - 900 * kAlong, kAlong, 15 * kDegree}, -60 * kDegree, 60 * kDegree, 700, 1100},
                    kAngle,
                    kOffset};

Header header_of(const Scene& scene) {
    return std::visit([](const auto& s) -> Header { return s; }, scene.header.shape);
}

std::variant<SaddleFit, NoSaddle> fitted(const Scene& scene, const PatchNoise& noise, std::uint64_t seed,
                                         const SaddleNominals& nominals = {}, int count = 1500) {
    const auto branch = fit_like(scene.branch.shape, points_of(scene.branch, count, noise, 2 * seed), 1e-3);
    const auto header = fit_like(scene.header.shape, points_of(scene.header, count, noise, 2 * seed + 1), 1e-3);
    if (!branch || !header) {
        return NoSaddle{"a surface was not fitted"};
    }
    return fit_saddle(*branch, *header, nominals);
}

std::string reason_of(const std::variant<SaddleFit, NoSaddle>& result) {
    const auto* none = std::get_if<NoSaddle>(&result);
    return none != nullptr ? none->reason : "";
}

TEST(SaddleFit, OfExactPointsIsTheExactCurve) {
    for (const Scene* scene : {&kOnPipe, &kOnPlane, &kOnSphere, &kOnCone}) {
        const auto result = fitted(*scene, {}, 1);
        ASSERT_EQ(reason_of(result), "");
        const auto& fit = std::get<SaddleFit>(result);
        const SaddleCurve truth(std::get<Cylinder>(scene->branch.shape), fit.zero, header_of(*scene));
        EXPECT_NEAR(fit.curve.length(), truth.length(), 1e-9);
        for (double theta = 0; theta < kTurn; theta += 0.1) {
            EXPECT_LT((fit.curve.at(theta).p - truth.at(theta).p).norm(), 1e-9) << theta;
        }
        EXPECT_NEAR(fit.branch_radius_mm.value, kRadius, 1e-10);
        EXPECT_EQ(fit.header_radius_mm.has_value(), scene == &kOnPipe || scene == &kOnSphere);
        EXPECT_EQ(fit.angle_rad.has_value(), scene != &kOnSphere);
        EXPECT_EQ(fit.offset_mm.has_value(), scene != &kOnPlane);
        if (fit.header_radius_mm) {
            EXPECT_NEAR(fit.header_radius_mm->value, 300, 1e-9);
        }
        if (fit.angle_rad) {
            EXPECT_NEAR(fit.angle_rad->value, scene->angle, 1e-12);
        }
        if (fit.offset_mm && scene != &kOnSphere) {
            EXPECT_NEAR(fit.offset_mm->value, scene->offset, 1e-9);
        }
    }
}

TEST(SaddleFit, PointsTheBranchOutOfTheHeader) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        const auto result = fitted(kOnPipe, {0.05, 0, 0}, seed);
        ASSERT_EQ(reason_of(result), "");
        EXPECT_GT(std::get<SaddleFit>(result).curve.branch().axis.dot(kSquare), 0.9);
    }
}

/// Counts how often numbers are within one and two of their own sigmas.
struct Tally {
    int one = 0, two = 0, all = 0;
    void add(const Measured& g, double truth) {
        one += std::abs(g.value - truth) < g.sigma;
        two += std::abs(g.value - truth) < 2 * g.sigma;
        ++all;
    }
    void expect_sound(const std::string& what) const {
        EXPECT_GT(one, 0.60 * all) << what;
        EXPECT_LT(one, 0.76 * all) << what;
        EXPECT_GT(two, 0.92 * all) << what;
        EXPECT_LT(two, 0.98 * all) << what;
    }
};

void expect_sound_sigmas(const Scene& scene, const PatchNoise& noise, const std::string& what) {
    constexpr int kScans = 800;  // the share within two sigmas is then known to 0.8 %
    Tally branch, header, angle, offset;
    for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
        const auto result = fitted(scene, noise, seed, {}, 1000);
        ASSERT_EQ(reason_of(result), "") << what << ", seed " << seed;
        const auto& fit = std::get<SaddleFit>(result);
        branch.add(fit.branch_radius_mm, kRadius);
        if (fit.header_radius_mm) {
            header.add(*fit.header_radius_mm, 300);
        }
        if (fit.angle_rad) {
            angle.add(*fit.angle_rad, scene.angle);
        }
        if (fit.offset_mm) {
            offset.add(*fit.offset_mm, scene.offset);
        }
    }
    for (const auto& [tally, name] : {std::pair{&branch, "branch radius"}, std::pair{&header, "header radius"},
                                      std::pair{&angle, "angle"}, std::pair{&offset, "offset"}}) {
        if (tally->all > 0) {
            tally->expect_sound(what + ", " + name);
        }
    }
}

// Of the sphere, whose centre is off the branch's axis by more than the offset of the axes.
Scene sphere_scene() {
    Scene scene = kOnSphere;
    const auto& branch = std::get<Cylinder>(scene.branch.shape);
    scene.offset = across(kMiddle - branch.point, branch.axis).norm();
    return scene;
}

TEST(SaddleFit, KnowsHowSureItsNumbersAre) {
    expect_sound_sigmas(kOnPipe, {0.1, 0, 0.03, 24, 3}, "pipe");
    expect_sound_sigmas(kOnPipe, {0.1, 0.05, 0, 24, 3}, "pipe, shared noise");
    expect_sound_sigmas(on_pipe(60 * kDegree, kRadius, 90 * kDegree, 0), {0.1, 0, 0, 24, 3}, "tee");
    expect_sound_sigmas(kOnPlane, {0.1, 0, 0, 24, 3}, "plane");
    expect_sound_sigmas(sphere_scene(), {0.1, 0, 0, 24, 3}, "sphere");
    expect_sound_sigmas(kOnCone, {0.1, 0, 0, 24, 3}, "cone");
}

// With the true values, drawn from what the nominals say of them, the posterior must hold as well.
TEST(SaddleFit, KnowsHowSureItIsWithNominals) {
    constexpr int kScans = 400;
    constexpr double kSigma = 0.1;
    Tally radius, angle, offset;
    double chi2 = 0;
    for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
        const Random drawn(seed, 7);
        SaddleNominals nominals;
        nominals.header_radius_mm = {300 + kSigma * drawn.normal(0), kSigma};
        nominals.angle_rad = {kAngle + 1e-3 * drawn.normal(1), 1e-3};
        nominals.branch_radius_mm = {kRadius + 0.01 * drawn.normal(2), 0.01};
        const auto result = fitted(on_pipe(60 * kDegree), {0.1, 0, 0, 12, 4}, seed, nominals, 1000);
        ASSERT_EQ(reason_of(result), "") << seed;
        const auto& fit = std::get<SaddleFit>(result);
        radius.add(*fit.header_radius_mm, 300);
        angle.add(*fit.angle_rad, kAngle);
        offset.add(*fit.offset_mm, kOffset);
        chi2 += fit.nominals_chi2 / kScans;
    }
    radius.expect_sound("header radius");
    angle.expect_sound("angle");
    offset.expect_sound("offset");
    EXPECT_NEAR(chi2, 3, 0.4) << "three degrees of freedom";
}

// On a header of which an arc is seen, a radius that is known keeps the surface where it is and its radius to itself:
// as two independent measurements of one number.
TEST(SaddleFit, ANominalTightensAShortArc) {
    const Scene scene = on_pipe(40 * kDegree);
    const auto free = std::get<SaddleFit>(fitted(scene, {0.1, 0, 0, 12, 4}, 1));
    SaddleNominals nominals;
    nominals.header_radius_mm = {300, 0.02};
    const auto held = std::get<SaddleFit>(fitted(scene, {0.1, 0, 0, 12, 4}, 1, nominals));
    const double own = 1 / std::pow(free.header_radius_mm->sigma, 2), known = 1 / std::pow(0.02, 2);
    EXPECT_GT(free.header_radius_mm->sigma, 0.06) << "the arc alone";
    EXPECT_NEAR(held.header_radius_mm->sigma, 1 / std::sqrt(own + known), 1e-6);
    EXPECT_NEAR(held.header_radius_mm->value, (own * free.header_radius_mm->value + known * 300) / (own + known), 1e-6);
    EXPECT_NEAR(held.branch_radius_mm.value, free.branch_radius_mm.value, 1e-12) << "the branch knows nothing of it";
    const SaddleCurve truth(std::get<Cylinder>(scene.branch.shape), held.zero, header_of(scene));
    for (double theta = 0; theta < kTurn; theta += 0.1) {
        EXPECT_LT((held.curve.at(theta).p - truth.at(theta).p).norm(), 0.1);
    }
}

TEST(SaddleFit, SaysThatANominalIsWrong) {
    SaddleNominals nominals;
    nominals.header_radius_mm = {310, 0.1};
    const auto fit = std::get<SaddleFit>(fitted(kOnPipe, {0.1, 0, 0, 12, 4}, 1, nominals));
    EXPECT_GT(fit.nominals_chi2, 100);
}

TEST(SaddleFit, TakesAnAngleBeyondARightOne) {
    SaddleNominals nominals;
    nominals.angle_rad = {std::numbers::pi - kAngle, 0.01};
    const auto fit = std::get<SaddleFit>(fitted(kOnPipe, {0.1, 0, 0, 12, 4}, 1, nominals));
    EXPECT_NEAR(fit.angle_rad->value, std::numbers::pi - kAngle, 1e-3);
    EXPECT_LT(fit.nominals_chi2, 4);
}

TEST(SaddleFit, RefusesAPartialPenetration) {
    const auto result = fitted(on_pipe(120 * kDegree, 80, kAngle, 240), {0.1, 0, 0, 12, 4}, 1);
    EXPECT_THAT(reason_of(result), HasSubstr("partial penetration"));
    EXPECT_THAT(reason_of(result), HasSubstr("-19.9"));
}

TEST(SaddleFit, RefusesEqualRadii) {
    for (const double sigma : {0.0, 0.1}) {
        const auto result = fitted(on_pipe(170 * kDegree, 300, 90 * kDegree, 0), {sigma, 0, 0, 12, 4}, 1);
        EXPECT_THAT(reason_of(result), HasSubstr("corner")) << sigma;
    }
    EXPECT_EQ(reason_of(fitted(on_pipe(170 * kDegree, 298, 90 * kDegree, 0), {0.1, 0, 0, 12, 4}, 1)), "");
}

TEST(SaddleFit, RefusesABranchBesideASphereOrAcrossACone) {
    Scene beside = kOnSphere;
    std::get<Cylinder>(beside.branch.shape).radius = 299;
    EXPECT_THAT(reason_of(fitted(beside, {0.1, 0, 0, 12, 4}, 1)), HasSubstr("partial penetration"));
    Scene wide = kOnCone;
    std::get<Cylinder>(wide.branch.shape).radius = 260;
    EXPECT_THAT(reason_of(fitted(wide, {0.1, 0, 0, 12, 4}, 1)), HasSubstr("partial penetration"));
}

TEST(SaddleFit, RefusesABranchThatIsNone) {
    const auto plane = fit_like(kOnPlane.header.shape, points_of(kOnPlane.header, 500, {}, 1));
    const auto pipe = fit_like(kOnPipe.header.shape, points_of(kOnPipe.header, 500, {}, 1));
    ASSERT_TRUE(plane && pipe);
    EXPECT_THAT(reason_of(fit_saddle(*plane, *pipe, {})), HasSubstr("no cylinder"));
    EXPECT_THAT(reason_of(fit_saddle(*pipe, *pipe, {})), HasSubstr("along the header"));
}

TEST(SaddleFit, RefusesNominalsThatSayNothing) {
    for (const Measured& wrong : {Measured{80, 0}, Measured{80, -1}, Measured{std::nan(""), 1}}) {
        SaddleNominals nominals;
        nominals.branch_radius_mm = wrong;
        EXPECT_THROW(fitted(kOnPipe, {}, 1, nominals), InputError);
    }
}

TEST(SaddleSeam, IsTheCurveOrAStretchOfIt) {
    const auto fit = std::get<SaddleFit>(fitted(kOnPipe, {}, 1));
    const SaddleSeam round(fit.curve, 0, kTurn), stretch(fit.curve, 1.5, 7), back(fit.curve, 7, 1.5);
    EXPECT_NEAR(round.length(), fit.curve.length(), 1e-12);
    EXPECT_EQ(back.length(), stretch.length());
    for (const double s : {0.0, 3.0, 100.0}) {
        EXPECT_LT((back.at(s).p - stretch.at(stretch.length() - s).p).norm(), 1e-9);
        EXPECT_NEAR(back.station(back.at(s).theta), s, 1e-9);
    }
    EXPECT_NEAR(stretch.length(), fit.curve.station(7) - fit.curve.station(1.5), 1e-12);
    EXPECT_LT((stretch.at(0).p - fit.curve.at(1.5).p).norm(), 1e-9);
    EXPECT_LT((stretch.at(stretch.length()).p - fit.curve.at(7).p).norm(), 1e-9);
    double polygon = 0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {
        polygon +=
            (stretch.at(stretch.length() * (i + 1) / kSteps).p - stretch.at(stretch.length() * i / kSteps).p).norm();
    }
    EXPECT_NEAR(polygon, stretch.length(), 1e-3);
    for (const double theta : {-3.0, -1.0, 0.0, 2.0}) {
        EXPECT_NEAR(branch_angle(fit, fit.curve.at(theta).p), theta, 1e-12);
    }
}

}  // namespace saddle_fit_test
}  // namespace seampath
