#include "stages/geometry/surface_fit.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/geometry/patches.hpp"

/// Planes, cylinders, cones and spheres fitted to points of known surfaces.
namespace seampath {
namespace surface_fit_test {

using Eigen::Vector3d;

constexpr double kTurn = 2 * std::numbers::pi;
const Vector3d kAxis = Vector3d(0.3, -0.5, 1).normalized();
const Vector3d kPlace(12, -40, 300);

const Patch kFullPipe{Cylinder{kPlace, kAxis, 150}, 0, kTurn, 0, 100};
const Patch kArc{Cylinder{kPlace, kAxis, 600}, 0, 40 * kDegree, 0, 400};

struct Case {
    const char* name;
    Patch patch;
};

const std::vector<Case> kCases{
    {"plane", {Plane{kPlace, kAxis}, 0, 200, 0, 40}},
    {"pipe", kFullPipe},
    {"arc of 40 deg", kArc},
    {"arc of 5 deg", {Cylinder{kPlace, kAxis, 600}, 0, 5 * kDegree, 0, 100}},
    {"cone", {Cone{kPlace, kAxis, 20 * kDegree}, 0, kTurn, 200, 300}},
    {"arc of a slender cone", {Cone{kPlace, kAxis, 10 * kDegree}, 0, 90 * kDegree, 1000, 1300}},
    {"arc of a flat cone", {Cone{kPlace, kAxis, 70 * kDegree}, 0, 60 * kDegree, 100, 200}},
    {"sphere", {Sphere{kPlace, 300}, 0, 60 * kDegree, -20 * kDegree, 20 * kDegree}},
    {"cap of a sphere", {Sphere{kPlace, 600}, 0, 10 * kDegree, -5 * kDegree, 5 * kDegree}},
};

/// Radius, or half angle in mm at 100 mm; 0 for a plane.
double size_of(const SurfaceFit::Shape& shape) {
    struct {
        double operator()(const Plane&) const { return 0; }
        double operator()(const Cylinder& s) const { return s.radius; }
        double operator()(const Cone& s) const { return 100 * s.half_angle; }
        double operator()(const Sphere& s) const { return s.radius; }
    } const size;
    return std::visit(size, shape);
}

TEST(SurfaceFit, RecoversExactSurfaces) {
    for (const auto& [name, patch] : kCases) {
        const auto fit = fit_like(patch.shape, points_of(patch, 2000, {}, 3));
        ASSERT_TRUE(fit) << name;
        EXPECT_LT(surface_error(patch, *fit), 1e-11) << name;
        EXPECT_NEAR(size_of(fit->shape()), size_of(patch.shape), 1e-10) << name;
        EXPECT_LT(fit->sigma(fit->origin()), 1e-11) << name;
        EXPECT_EQ(fit->share_taken(), 1) << name;
    }
}

// Half exactly on the surface, some of the rest far off: the scale falls to nothing.
TEST(SurfaceFit, RecoversExactSurfacesAmongOutliers) {
    for (const auto& [name, patch] : kCases) {
        const auto fit = fit_like(patch.shape, points_of(patch, 2000, {0, 0, 0.05}, 3));
        ASSERT_TRUE(fit) << name;
        EXPECT_LT(surface_error(patch, *fit), 1e-10) << name;
        EXPECT_NEAR(fit->share_taken(), 0.95, 0.002) << name;
    }
}

/// Points in pairs, as far outside as inside along one normal: residuals that are square to all derivatives (the
/// null-space method of Cox & Forbes, NPL 1992), whatever an even weight makes of them.
PatchPoints null_space_points(const Patch& patch) {
    PatchPoints made = points_of(patch, 2000, {}, 5), pairs = made;
    const Random residual(6, 0);
    for (std::size_t i = 0; i < made.points.size(); ++i) {
        const Vector3d n = std::visit([&](const auto& s) { return outward_normal(s, made.points[i]); }, patch.shape);
        const double d = i % 20 == 0 ? 2 : 0.1 * residual.normal(i);
        pairs.points[i] += d * n;
        pairs.points.push_back(made.points[i] - d * n);
        pairs.block.push_back(made.block[i]);
    }
    return pairs;
}

// The bound of a class 1 of test data: 0.1 um, 0.1 urad.
TEST(SurfaceFit, IsTheLeastSquaresSolution) {
    for (const auto& [name, patch] : kCases) {
        const auto fit = fit_like(patch.shape, null_space_points(patch));
        ASSERT_TRUE(fit) << name;
        EXPECT_LT(surface_error(patch, *fit), 1e-7) << name;
        EXPECT_NEAR(size_of(fit->shape()), size_of(patch.shape), 1e-5) << name;
        EXPECT_GT(fit->scale(), 0.08) << name;
    }
}

/// Of 20000 points: the largest error over the patch, mean of twelve scans.
double mean_largest_error(const Patch& patch, double sigma, double outliers) {
    constexpr int kScans = 12;
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
        const auto fit = fit_like(patch.shape, points_of(patch, 20000, {sigma, 0, outliers}, seed), 0.03 * sigma);
        sum += fit ? surface_error(patch, *fit) : 1;
    }
    return sum / kScans;
}

TEST(SurfaceFit, FindsPipesInNoise) {
    EXPECT_LT(mean_largest_error(kFullPipe, 0.05, 0), 0.0022);
    EXPECT_LT(mean_largest_error(kFullPipe, 0.1, 0.05), 0.0048);
    EXPECT_LT(mean_largest_error(kArc, 0.05, 0.05), 0.003);
    EXPECT_LT(mean_largest_error(kArc, 0.1, 0.05), 0.0058);
}

// What a short arc leaves open is its radius, and not where its surface is.
TEST(SurfaceFit, FindsTheRadiusOfAnArc) {
    double squares = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const auto fit = fit_like(kArc.shape, points_of(kArc, 20000, {0.1, 0, 0.05}, seed));
        ASSERT_TRUE(fit);
        squares += std::pow(size_of(fit->shape()) - 600, 2);
    }
    EXPECT_LT(std::sqrt(squares / 20), 0.04);
}

TEST(SurfaceFit, TellsABoreFromABoss) {
    for (const auto& [name, patch] : kCases) {
        PatchPoints made = points_of(patch, 2000, {0.05, 0, 0.02}, 4);
        const auto boss = fit_like(patch.shape, made);
        turn_inside_out(made);
        const auto bore = fit_like(patch.shape, made);
        ASSERT_TRUE(boss && bore) << name;
        const Vector3d p = made.places[0];
        const Vector3d n = std::visit([&](const auto& s) { return outward_normal(s, p); }, patch.shape);
        EXPECT_GT(boss->normal(p).dot(n), 0.999) << name;
        EXPECT_LT(bore->normal(p).dot(n), -0.999) << name;
        EXPECT_NEAR(boss->distance(p + n), 1, 0.05) << name;
        EXPECT_NEAR(bore->distance(p + n), -1, 0.05) << name;
        EXPECT_FALSE(boss->bore()) << name;
        EXPECT_EQ(bore->bore(), !std::holds_alternative<Plane>(patch.shape)) << name;
        EXPECT_NEAR(bore->sigma(p), boss->sigma(p), 1e-9) << name;
    }
}

/// Points and normals, not blocks, by a rigid motion.
PatchPoints by(const Eigen::Isometry3d& motion, PatchPoints made) {
    for (auto* points : {&made.points, &made.places}) {
        for (auto& p : *points) {
            p = motion * p;
        }
    }
    for (auto& n : made.normals) {
        n = motion.linear() * n;
    }
    return made;
}

TEST(SurfaceFit, FollowsARigidMotion) {
    const Eigen::Isometry3d far(Eigen::Translation3d(5000, -3000, 2000)),
        turn(Eigen::Translation3d(70, 20, -400) * Eigen::AngleAxisd(2, Vector3d(1, 2, -1).normalized()));
    for (const auto& [name, patch] : kCases) {
        const PatchPoints made = points_of(patch, 2000, {0.05, 0, 0.02}, 4);
        const auto here = fit_like(patch.shape, made);
        for (const auto& motion : {far, turn}) {
            const auto there = fit_like(patch.shape, by(motion, made));
            ASSERT_TRUE(here && there) << name;
            EXPECT_NEAR(size_of(there->shape()), size_of(here->shape()), 1e-5) << name;
            for (const auto& p : made.places) {
                EXPECT_NEAR(there->distance(motion * p), here->distance(p), 1e-7) << name;
                EXPECT_LT((there->normal(motion * p) - motion.linear() * here->normal(p)).norm(), 1e-8) << name;
                EXPECT_NEAR(there->sigma(motion * p), here->sigma(p), 1e-4 * here->sigma(p)) << name;
            }
        }
    }
}

TEST(SurfaceFit, DoesNotMindTheOrderOfPoints) {
    for (const auto& [name, patch] : kCases) {
        PatchPoints made = points_of(patch, 2000, {0.05, 0.02, 0.02}, 4);
        const auto fit = fit_like(patch.shape, made);
        std::reverse(made.points.begin(), made.points.end());
        std::reverse(made.block.begin(), made.block.end());
        const auto reversed = fit_like(patch.shape, made);
        ASSERT_TRUE(fit && reversed) << name;
        for (const auto& p : made.places) {
            EXPECT_NEAR(reversed->distance(p), fit->distance(p), 1e-8) << name;
            EXPECT_NEAR(reversed->sigma(p), fit->sigma(p), 1e-6 * fit->sigma(p)) << name;
        }
    }
}

const std::vector<SurfaceFit::Shape> kKinds{Plane{kPlace, kAxis}, Cylinder{kPlace, kAxis, 1}, Cone{kPlace, kAxis, 1},
                                            Sphere{kPlace, 1}};

TEST(SurfaceFit, RefusesPointsThatDetermineNothing) {
    const PatchPoints pipe = points_of(kFullPipe, 2000, {}, 3);
    const Random random(8, 0);
    PatchPoints none = pipe, three = pipe, equal = pipe, line = pipe, noisy_line = pipe, broken = pipe;
    none.points.clear(), none.block.clear();
    three.points.resize(3), three.block.resize(3);
    broken.points[7][1] = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < pipe.points.size(); ++i) {
        equal.points[i] = kPlace;
        line.points[i] = kPlace + 0.1 * static_cast<double>(i) * kAxis;
        noisy_line.points[i] =
            line.points[i] + 0.05 * Vector3d(random.normal(3 * i), random.normal(3 * i + 1), random.normal(3 * i + 2));
    }
    for (const auto& kind : kKinds) {
        for (const auto* made : {&none, &three, &equal, &line, &noisy_line, &broken}) {
            EXPECT_FALSE(fit_like(kind, *made)) << "kind " << kind.index();
        }
    }
}

TEST(SurfaceFit, RefusesNormalsThatSayNothing) {
    PatchPoints made = points_of(kFullPipe, 2000, {}, 3);
    made.places.clear(), made.normals.clear();
    for (const auto& kind : {kKinds[1], kKinds[2], kKinds[3]}) {
        EXPECT_FALSE(fit_like(kind, made));
    }
}

TEST(SurfaceFit, TakesNoPlaneForACurvedSurface) {
    const Patch plane{Plane{kPlace, kAxis}, 0, 200, 0, 40};
    for (const double sigma : {0.0, 0.05}) {
        for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}) {
            for (const auto& kind : {kKinds[1], kKinds[2], kKinds[3]}) {
                EXPECT_FALSE(fit_like(kind, points_of(plane, 2000, {sigma, 0, 0}, seed))) << sigma << ' ' << seed;
            }
        }
    }
}

TEST(SurfaceFit, TakesNoPipeForACone) {
    for (const double sigma : {0.0, 0.05}) {
        for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}) {
            EXPECT_FALSE(fit_like(kKinds[2], points_of(kFullPipe, 2000, {sigma, 0, 0}, seed))) << sigma << ' ' << seed;
        }
    }
}

// By central differences, of a shape in a frame that is none of its own points'.
template <class S>
void expect_derivatives_of_steps(const S& shape, const char* name) {
    const SurfaceFrame frame = frame_of(shape, kPlace + Vector3d(40, 170, 220), 60);
    const Random random(3, 0);
    for (std::uint64_t i = 0; i < 20; ++i) {
        const Vector3d p =
            frame.origin + 50 * Vector3d(random.normal(3 * i), random.normal(3 * i + 1), random.normal(3 * i + 2));
        const auto at = row(shape, frame, p);
        EXPECT_NEAR(at.distance, signed_distance(shape, p), 1e-11) << name;
        for (Eigen::Index j = 0; j < at.by.size(); ++j) {
            constexpr double kStep = 1e-3;
            auto step = at.by;
            step.setZero();
            step[j] = kStep;
            const double ahead = signed_distance(moved(shape, frame, step), p);
            const double behind = signed_distance(moved(shape, frame, -step), p);
            EXPECT_NEAR((ahead - behind) / (2 * kStep), at.by[j], 1e-7) << name << ", parameter " << j;
        }
    }
}

TEST(SurfaceParameters, HaveTheDerivativesOfTheirSteps) {
    expect_derivatives_of_steps(Plane{kPlace, kAxis}, "plane");
    expect_derivatives_of_steps(Cylinder{kPlace, kAxis, 150}, "cylinder");
    expect_derivatives_of_steps(Cone{kPlace, kAxis, 20 * kDegree}, "cone");
    expect_derivatives_of_steps(Cone{kPlace, kAxis, 65 * kDegree}, "flat cone");
    expect_derivatives_of_steps(Sphere{kPlace, 300}, "sphere");
}

/// How often the surface is within one and two of its own sigmas, at nine places of 250 scans.
struct Coverage {
    double one = 0, two = 0;
};

Coverage coverage(const Patch& patch, const PatchNoise& noise) {
    constexpr int kScans = 250;
    constexpr double kAt[] = {0.05, 0.5, 0.95};
    Coverage within;
    for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
        const auto fit = fit_like(patch.shape, points_of(patch, 800, noise, seed), 1e-3);
        for (int k = 0; fit && k < 9; ++k) {
            const Vector3d p = on(patch, std::lerp(patch.a_from, patch.a_to, kAt[k / 3]),
                                  std::lerp(patch.b_from, patch.b_to, kAt[k % 3]));
            const double off = std::abs(fit->distance(p)) / fit->sigma(p);
            within.one += (off < 1) / (9.0 * kScans);
            within.two += (off < 2) / (9.0 * kScans);
        }
    }
    return within;
}

void expect_sound(const Coverage& within, const char* name) {
    EXPECT_GT(within.one, 0.60) << name;
    EXPECT_LT(within.one, 0.76) << name;
    EXPECT_GT(within.two, 0.92) << name;
    EXPECT_LT(within.two, 0.98) << name;
}

TEST(SurfaceFit, KnowsHowSureItIsInIndependentNoise) {
    for (const auto& [name, patch] : kCases) {
        expect_sound(coverage(patch, {0.05, 0, 0.03, 24, 3}), name);
        expect_sound(coverage(patch, {0.05, 0, 0, 1, 1}), name);  // one block tells nothing of shared errors
    }
}

TEST(SurfaceFit, KnowsHowSureItIsInNoiseThatBlocksShare) {
    for (const auto& [name, patch] : kCases) {
        expect_sound(coverage(patch, {0.05, 0.03, 0, 24, 3}), name);
        expect_sound(coverage(patch, {0.05, 0.03, 0, 8, 4}), name);
        expect_sound(coverage(patch, {0.05, 0.03, 0, 24, 1}), name);
    }
}

// Without blocks the shared errors would count as if each point had its own.
TEST(SurfaceFit, NeedsBlocksToKnowOfSharedNoise) {
    PatchNoise noise{0.05, 0.03, 0, 8, 4};
    PatchPoints made = points_of(kFullPipe, 2000, noise, 1);
    const auto fit = fit_like(kFullPipe.shape, made);
    std::iota(made.block.begin(), made.block.end(), 0U);
    const auto blind = fit_like(kFullPipe.shape, made);
    ASSERT_TRUE(fit && blind);
    EXPECT_GT(fit->sigma(made.places[0]), 2 * blind->sigma(made.places[0]));
}

}  // namespace surface_fit_test
}  // namespace seampath
