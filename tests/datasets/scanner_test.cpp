#include "datasets/scanner.hpp"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/station.hpp"
#include "stages/error.hpp"
#include "tests/datasets/scene_laws.hpp"

namespace seampath {
namespace scanner_test {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// One view without any error.
ScannerOptions perfect(double pitch) {
    ScannerOptions o;
    o.sigma_mm = 0;
    o.pitch_x_mm = o.pitch_y_mm = pitch;
    o.views = 1;
    o.mixed_pixels = o.dropout = o.blobs = o.outliers = o.ghosts = 0;
    o.registration_mm = o.registration_deg = 0;
    return o;
}

/// A block whose top is z = 0.
Scene block(double side) {
    Scene scene;
    const Vector3d high(side / 2, side / 2, 0);
    const Vector3d low(-side / 2, -side / 2, -5);
    std::vector<SceneShape> faces;
    for (int axis = 0; axis < 3; ++axis) {
        faces.push_back(PlaneShape{high, Vector3d::Unit(axis)});
        faces.push_back(PlaneShape{low, -Vector3d::Unit(axis)});
    }
    for (std::size_t i = 0; i < faces.size(); ++i) {
        std::vector<SceneShape> others = faces;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        scene.surfaces.push_back({faces[i], others});
    }
    scene.box.extend(low);
    scene.box.extend(high);
    return scene;
}

bool measured(const Vector3d& p) {
    return !std::isnan(p.x());
}

std::size_t count(const View& view, const std::function<bool(const Vector3d&)>& holds = measured) {
    return static_cast<std::size_t>(std::count_if(view.points.begin(), view.points.end(), holds));
}

/// On the top of the block, away from its edges.
bool on_top(const Vector3d& p) {
    return std::abs(p.z()) < 1 && p.head<2>().cwiseAbs().maxCoeff() < 29;
}

/// Distance from the eye of the surface that a pixel looks at, or 0.
double true_distance(const Scene& scene, const Station& station, std::size_t pixel) {
    const auto row = static_cast<std::uint32_t>(pixel / station.width);
    const auto column = static_cast<double>(pixel % station.width);
    const auto hit = first_hit(scene.surfaces, {station.eye(row), station.sight(column, row).normalized()});
    return hit ? hit->t : 0;
}

double rms_of_top(const View& view) {
    double squares = 0;
    double n = 0;
    for (const Vector3d& p : view.points) {
        if (on_top(p)) {
            squares += p.z() * p.z();
            ++n;
        }
    }
    return std::sqrt(squares / n);
}

TEST(Scanner, WithoutErrorsPointsLieOnThePart) {
    for (const SceneOptions& variant : scene_variants()) {
        const Scene scene = make_scene(resolved(variant, 1));
        for (const SensorKind sensor : {SensorKind::camera, SensorKind::profile}) {
            ScannerOptions o = perfect(2);
            o.sensor = sensor;
            const View view = take_view(scene, o, 1, 0, 1);
            EXPECT_GT(count(view), 1500U) << variant_name(variant);
            for (const Vector3d& p : view.points) {
                if (measured(p)) {
                    ASSERT_NEAR(part_value(scene, p), 0, 1e-9);
                }
            }
        }
    }
}

TEST(Scanner, PitchIsTheDistanceOfPointsOnAFaceOnSurface) {
    ScannerOptions o = perfect(0.4);
    o.elevation_deg = 80;
    const View view = take_view(block(60), o, 1, 0, 1);
    const std::size_t middle = view.height / 2 * view.width + view.width / 2;
    EXPECT_NEAR((view.points[middle + 1] - view.points[middle]).norm(), 0.4, 0.004);
    EXPECT_NEAR((view.points[middle + view.width] - view.points[middle]).norm(), 0.4, 0.02);
}

TEST(Scanner, NoiseAcrossASurfaceHasTheAskedSigma) {
    // Along the ray it grows with 1/cos(incidence), so across the surface it is the same at any incidence up to 78
    // degrees.
    for (const double elevation : {25.0, 45.0, 70.0}) {
        for (const double correlation : {0.0, 1.2}) {
            ScannerOptions o = perfect(0.2);
            o.sigma_mm = 0.045;
            o.elevation_deg = elevation;
            o.correlation_px = correlation;
            EXPECT_NEAR(rms_of_top(take_view(block(60), o, 1, 0, 1)), 0.045, 0.0045) << elevation << ' ' << correlation;
        }
    }
}

TEST(Scanner, NoiseGrowsWithTheSquareOfTheDistance) {
    ScannerOptions o = perfect(0.4);
    o.sigma_mm = 0.05;
    Scene near = block(60);
    const double at_working_distance = rms_of_top(take_view(near, o, 1, 0, 1));
    near.box.max().z() = 400;  // the sensor aims 200 mm above the block
    const double farther = rms_of_top(take_view(near, o, 1, 0, 1));
    const double ratio = (600 + 200 * std::sin(37 * M_PI / 180)) / 600;
    EXPECT_NEAR(farther / at_working_distance, ratio * ratio, 0.08);
}

double correlation_of_neighbours(const View& view, std::size_t step) {
    double product = 0;
    double square = 0;
    for (std::size_t i = 0; i + step < view.points.size(); ++i) {
        const Vector3d& a = view.points[i];
        const Vector3d& b = view.points[i + step];
        if (on_top(a) && on_top(b)) {
            product += a.z() * b.z();
            square += a.z() * a.z();
        }
    }
    return product / square;
}

TEST(Scanner, ErrorsOfNeighboursAreTied) {
    ScannerOptions o = perfect(0.2);
    o.sigma_mm = 0.045;
    o.correlation_px = 1.2;
    const View tied = take_view(block(60), o, 1, 0, 1);
    // White noise under a Gaussian kernel of width s has the correlation exp(-d^2 / (4 s^2)) at the distance d.
    const double expected = std::exp(-1 / (4 * 1.2 * 1.2));
    EXPECT_NEAR(correlation_of_neighbours(tied, 1), expected, 0.02);
    EXPECT_NEAR(correlation_of_neighbours(tied, tied.width), expected, 0.02);
    EXPECT_NEAR(correlation_of_neighbours(tied, 12), 0, 0.03);
    o.correlation_px = 0;
    EXPECT_NEAR(correlation_of_neighbours(take_view(block(60), o, 1, 0, 1), 1), 0, 0.03);
    o.correlation_px = 1.2;
    o.sensor = SensorKind::profile;
    const View profile = take_view(block(60), o, 1, 0, 1);
    EXPECT_NEAR(correlation_of_neighbours(profile, 1), expected, 0.02);
    EXPECT_NEAR(correlation_of_neighbours(profile, profile.width), 0, 0.03);
}

/// Steps along the line; the ends are left out by a tenth of a millimetre.
bool is_free(const Scene& scene, const Vector3d& from, const Vector3d& to) {
    const double distance = (to - from).norm();
    const Vector3d direction = (to - from) / distance;
    for (double t = 0.1; t < std::min(distance - 0.1, 350.0); t += 0.25) {
        if (part_value(scene, from + t * direction) < -0.02) {
            return false;
        }
    }
    return true;
}

TEST(Scanner, EveryPointIsSeenByBothEyes) {
    const int kBeside = 9;  // of 36 views: along the web, with the second eye on its other side
    for (const SceneKind kind : {SceneKind::tee, SceneKind::pipe_on_pipe_oblique}) {
        const Scene scene = make_scene(scene_options(static_cast<int>(kind)));
        for (const SensorKind sensor : {SensorKind::camera, SensorKind::profile}) {
            ScannerOptions o = perfect(2);
            o.sensor = sensor;
            o.views = 36;
            const Station station = make_station(scene, o, Random(1, 10), kBeside);
            const View view = take_view(scene, o, 1, kBeside, 1);
            ASSERT_EQ(view.width, station.width);
            int in_shadow = 0;
            for (std::size_t i = 0; i < view.points.size(); i += 13) {
                const double distance = true_distance(scene, station, i);
                if (distance == 0) {
                    EXPECT_FALSE(measured(view.points[i]));
                    continue;
                }
                const auto row = static_cast<std::uint32_t>(i / view.width);
                const Vector3d ray = station.sight(static_cast<double>(i % view.width), row).normalized();
                const Vector3d p = station.eye(row) + distance * ray;
                ASSERT_TRUE(is_free(scene, p, station.eye(row)));
                if (!is_free(scene, p, station.second_eye(row))) {
                    ++in_shadow;
                    ASSERT_FALSE(measured(view.points[i])) << p.transpose();
                }
            }
            EXPECT_GT(in_shadow, 10) << name(kind) << static_cast<int>(sensor);
        }
    }
}

TEST(Scanner, DropoutsHaveTheAskedShareAndGrowWithIncidence) {
    const Scene scene = block(60);
    const auto share = [&](const ScannerOptions& o) {
        return 1 - static_cast<double>(count(take_view(scene, o, 1, 0, 1))) / static_cast<double>(count(take_view(
                                                                                  scene,
                                                                                  [&] {
                                                                                      ScannerOptions whole = o;
                                                                                      whole.dropout = 0;
                                                                                      whole.blobs = 0;
                                                                                      return whole;
                                                                                  }(),
                                                                                  1, 0, 1)));
    };
    ScannerOptions o = perfect(0.2);
    o.elevation_deg = 60;
    o.dropout = 0.05;
    EXPECT_NEAR(share(o), 0.05, 0.01);
    o.dropout = 0;
    o.blobs = 0.05;
    EXPECT_NEAR(share(o), 0.05, 0.02);
}

TEST(Scanner, GrazingSurfaceLosesMostPoints) {
    ScannerOptions o = perfect(0.2);
    o.elevation_deg = 60;
    const auto steep = static_cast<double>(count(take_view(block(60), o, 1, 0, 1), on_top));
    o.elevation_deg = 10;
    const auto grazing = static_cast<double>(count(take_view(block(60), o, 1, 0, 1), on_top));
    // The top shows foreshortened by about sin(10 +- 4) / sin(60 +- 4), and 95 % of what is left is lost.
    EXPECT_LT(grazing / steep, 0.3 * 0.2);
    EXPECT_GT(grazing, 0);
}

TEST(Scanner, OutliersHaveTheAskedShare) {
    ScannerOptions o = perfect(0.2);
    o.outliers = 0.02;
    const View view = take_view(block(60), o, 1, 0, 1);
    const Scene scene = block(60);
    const auto off =
        count(view, [&](const Vector3d& p) { return measured(p) && std::abs(part_value(scene, p)) > 0.01; });
    EXPECT_NEAR(static_cast<double>(off) / static_cast<double>(count(view)), 0.02, 0.003);
}

TEST(Scanner, MixedPixelsHangBetweenTheSidesOfADepthStep) {
    const Scene scene = make_scene(scene_options(static_cast<int>(SceneKind::box_on_plate)));
    ScannerOptions o = perfect(0.5);
    const View clean = take_view(scene, o, 1, 0, 1);
    o.mixed_pixels = 0.35;
    const View mixed = take_view(scene, o, 1, 0, 1);
    const Station station = make_station(scene, o, Random(1, 10), 0);
    std::size_t hanging = 0;
    for (std::size_t i = 0; i < mixed.points.size(); ++i) {
        if (!measured(mixed.points[i]) || (mixed.points[i] - clean.points[i]).norm() < 1e-9) {
            continue;
        }
        ++hanging;
        double least = 1e9;
        double most = 0;
        for (const std::size_t pixel : {i, i - 1, i + 1, i - mixed.width, i + mixed.width}) {
            const double distance = true_distance(scene, station, pixel);
            least = distance > 0 ? std::min(least, distance) : least;
            most = std::max(most, distance);
        }
        // Depths along z are mixed; neighbouring rays differ by 0.5 / 600 rad.
        ASSERT_GT((mixed.points[i] - station.eye(0)).norm(), least - 0.5);
        ASSERT_LT((mixed.points[i] - station.eye(0)).norm(), most + 0.5);
    }
    EXPECT_GT(hanging, 50U);
    EXPECT_LT(static_cast<double>(hanging), 0.01 * static_cast<double>(count(clean)));
}

TEST(Scanner, GhostsStayNearTheJoint) {
    const Scene scene = make_scene(scene_options(static_cast<int>(SceneKind::tee)));
    ScannerOptions o = perfect(1);
    const View clean = take_view(scene, o, 1, 0, 1);
    o.ghosts = 0.2;
    const View ghostly = take_view(scene, o, 1, 0, 1);
    double near = 0;
    double moved = 0;
    for (std::size_t i = 0; i < clean.points.size(); ++i) {
        if (!measured(clean.points[i])) {
            continue;
        }
        double distance = 1e9;
        for (const TruthSeam& seam : scene.truth.seams) {
            const Vector3d off = clean.points[i] - seam.points.front().p;
            distance = std::min(distance, (off - off.x() * Vector3d::UnitX()).norm());
        }
        const bool differs = (clean.points[i] - ghostly.points[i]).norm() > 1e-9;
        ASSERT_TRUE(!differs || distance <= 10) << distance;
        near += distance <= 9.9 ? 1 : 0;
        moved += differs && distance <= 9.9 ? 1 : 0;
    }
    EXPECT_NEAR(moved / near, 0.2, 0.03);
}

TEST(Scanner, OnlyFlanksThatFaceEachOtherMakeGhosts) {
    const auto moved = [](SceneKind kind) {
        const Scene scene = make_scene(scene_options(static_cast<int>(kind)));
        ScannerOptions o = perfect(2);
        const View clean = take_view(scene, o, 1, 0, 1);
        o.ghosts = 1;
        const View ghostly = take_view(scene, o, 1, 0, 1);
        std::size_t differing = 0;
        for (std::size_t i = 0; i < clean.points.size(); ++i) {
            differing += measured(clean.points[i]) && clean.points[i] != ghostly.points[i] ? 1 : 0;
        }
        return differing;
    };
    for (const SceneKind kind : {SceneKind::plain, SceneKind::corner, SceneKind::butt}) {
        EXPECT_EQ(moved(kind), 0U) << name(kind);
    }
    for (const SceneKind kind : {SceneKind::lap, SceneKind::v_groove, SceneKind::multi}) {
        EXPECT_GT(moved(kind), 100U) << name(kind);
    }
}

TEST(Scanner, DepthComesInSteps) {
    const Scene scene = block(60);
    ScannerOptions o = perfect(0.5);
    o.sigma_mm = 0.05;
    o.quantisation_mm = 0.02;
    const Station station = make_station(scene, o, Random(1, 10), 0);
    for (const Vector3d& p : take_view(scene, o, 1, 0, 1).points) {
        if (measured(p)) {
            const double steps = (station.scene_from_sensor.inverse() * p).z() / 0.02;
            ASSERT_NEAR(steps, std::round(steps), 1e-6);
        }
    }
}

TEST(Scanner, ViewsAreMisplacedByTheRegistrationError) {
    const Scene scene = block(60);
    ScannerOptions o = perfect(1);
    o.views = 36;
    o.registration_mm = 0.1;
    double squares = 0;
    for (int i = 0; i < o.views; ++i) {
        double sum = 0;
        double n = 0;
        for (const Vector3d& p : take_view(scene, o, 1, i, 1).points) {
            if (on_top(p)) {
                sum += p.z();
                ++n;
            }
        }
        squares += sum * sum / (n * n);
    }
    EXPECT_NEAR(std::sqrt(squares / o.views), 0.1, 0.03);
}

TEST(Scanner, ScaleAndBowChangeTheShape) {
    const Scene scene = block(60);
    ScannerOptions o = perfect(0.5);
    const View clean = take_view(scene, o, 1, 0, 1);
    o.scale_error = 0.01;
    const View scaled = take_view(scene, o, 1, 0, 1);
    std::vector<std::size_t> valid;
    for (std::size_t i = 0; i < clean.points.size(); ++i) {
        if (measured(clean.points[i])) {
            valid.push_back(i);
        }
    }
    const double ratio = (scaled.points[valid.back()] - scaled.points[valid.front()]).norm() /
                         (clean.points[valid.back()] - clean.points[valid.front()]).norm();
    EXPECT_GT(std::abs(ratio - 1), 1e-4);
    EXPECT_LT(std::abs(ratio - 1), 0.01);
    o.scale_error = 0;
    o.bow_mm = 0.3;
    const View bowed = take_view(scene, o, 1, 0, 1);
    const auto depth_error = [&](std::size_t i) {
        const Station station = make_station(scene, o, Random(1, 10), 0);
        return (station.scene_from_sensor.inverse() * bowed.points[i]).z() -
               (station.scene_from_sensor.inverse() * clean.points[i]).z();
    };
    const std::size_t middle = clean.height / 2 * clean.width + clean.width / 2;
    EXPECT_NEAR(depth_error(middle), -0.1, 0.002);
    EXPECT_GT(depth_error(valid.front()), 0);
}

TEST(Scanner, RobotPathBendsAProfileScan) {
    ScannerOptions o = perfect(0.5);
    o.sensor = SensorKind::profile;
    o.path_error_mm = 0.05;
    const double rms = rms_of_top(take_view(block(60), o, 1, 0, 1));
    EXPECT_GT(rms, 0.005);
    EXPECT_LT(rms, 0.05 * std::sqrt(3.0));
}

TEST(Scanner, UsualScannerSeesBothFlanksOfEverySeam) {
    for (const SceneOptions& variant : scene_variants()) {
        const Scene scene = make_scene(resolved(variant, 4));
        ScannerOptions o;
        o.pitch_x_mm = o.pitch_y_mm = 1.2;
        std::vector<Vector3d> points;
        for (int i = 0; i < o.views; ++i) {
            for (const Vector3d& p : take_view(scene, o, 4, i, 2).points) {
                if (measured(p)) {
                    points.push_back(p);
                }
            }
        }
        for (const TruthSeam& seam : scene.truth.seams) {
            for (std::size_t i = 100; i + 100 < seam.points.size(); i += 200) {
                const TruthPoint& at = seam.points[i];
                const Feet f = feet(seam, at);
                const auto seen = [&](const Vector3d& foot, const Vector3d& along, const Vector3d& n) {
                    return std::count_if(points.begin(), points.end(), [&](const Vector3d& p) {
                        const Vector3d off = p - foot;
                        return std::abs(off.dot(at.tangent)) < 3 && off.norm() < 8 && std::abs(off.dot(n)) < 1 &&
                               off.dot(along) > 1.5;
                    });
                };
                EXPECT_GT(seen(f.p1, f.along1, at.n1), 1) << variant_name(variant) << ' ' << i;
                EXPECT_GT(seen(f.p2, f.along2, at.n2), 1) << variant_name(variant) << ' ' << i;
            }
        }
    }
}

TEST(Scanner, ImpossibleViewsAreRefused) {
    ScannerOptions o = perfect(1);
    o.working_distance_mm = 20;
    EXPECT_THAT([&] { take_view(block(60), o, 1, 0, 1); }, ThrowsMessage<InputError>(HasSubstr("working_distance_mm")));
    o = perfect(1e-4);
    EXPECT_THAT([&] { take_view(block(60), o, 1, 0, 1); }, ThrowsMessage<InputError>(HasSubstr("pitch_x_mm")));
}

TEST(Presets, AreKnownByNameAndWithinTheirBounds) {
    for (const std::string_view name : kPresetNames) {
        ScannerOptions options = preset(name);
        for (const Field& field : describe(options)) {
            if (double* const* value = std::get_if<double*>(&field.value)) {
                EXPECT_GE(**value, field.bounds.low) << name << ' ' << field.key;
                EXPECT_LE(**value, field.bounds.high) << name << ' ' << field.key;
            }
        }
    }
    EXPECT_EQ(preset("phoxi_s").sigma_mm, 0.03);
    EXPECT_THAT([] { preset("standart"); },
                ThrowsMessage<InputError>(HasSubstr("\"standart\"; the presets are standard, metrology")));
}

}  // namespace scanner_test
}  // namespace seampath
