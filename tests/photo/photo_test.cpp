#include "stages/photo/photo.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "datasets/photo_picture.hpp"
#include "stages/error.hpp"
#include "stages/photo/smooth.hpp"
#include "stages/picture/picture.hpp"

namespace seampath {
namespace photo_test {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Course = std::vector<Vector2d>;

// From side to side, or from top to bottom, of a small photograph.
Course bowed_across() {
    Course course;
    for (int i = 0; i <= 64; ++i) {
        const double t = i / 64.0;
        course.emplace_back(-5 + 650 * t, 190 + 80 * t * (1 - t) + 60 * t);
    }
    return course;
}

Course wave_down() {
    Course course;
    for (int i = 0; i <= 64; ++i) {
        const double t = i / 64.0;
        course.emplace_back(240 + 25 * std::sin(5 * t), -5 + 650 * t);
    }
    return course;
}

double distance_from(const Course& course, const Vector2d& p) {
    double nearest = INFINITY;
    for (std::size_t i = 0; i + 1 < course.size(); ++i) {
        const Vector2d along = course[i + 1] - course[i];
        const double x = std::clamp((p - course[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (p - course[i] - x * along).norm());
    }
    return nearest;
}

struct Off {
    double rms = 0;         // px, of measured points
    double normalised = 0;  // rms of distance over 1-sigma
    std::size_t modelled = 0;
};

Off off_truth(const PhotoLine& line, const Course& course) {
    Off off;
    double n = 0;
    for (const PhotoPoint& point : line.points) {
        if (point.modelled) {
            ++off.modelled;
            continue;
        }
        const double d = distance_from(course, point.p);
        off.rms += d * d;
        off.normalised += d * d / (point.sigma_px * point.sigma_px);
        ++n;
    }
    off.rms = std::sqrt(off.rms / n);
    off.normalised = std::sqrt(off.normalised / n);
    return off;
}

struct Rendered {
    const char* name;
    PhotoPicture picture;
    PhotoNoise noise;
};

std::vector<Rendered> rendered_photos() {
    PhotoPicture across, down;
    across.course = bowed_across();
    down.course = wave_down();
    std::swap(down.width, down.height);
    PhotoNoise spots;
    spots.tacks = 3;
    spots.holes = 1;
    spots.highlights = 1;
    PhotoPicture unlike = down, bright = across;
    unlike.sheet_grey = {150, 90};
    bright.gap_px = 5;
    bright.gap_grey = 230;
    PhotoPicture narrow = down;
    narrow.gap_px = 3;
    PhotoNoise soft;
    soft.blur_px = 2;
    return {{"dark", across, {}},      {"spots", down, spots},    {"unlike sheets", unlike, {}},
            {"bright", bright, spots}, {"narrow", narrow, spots}, {"out of focus", across, soft}};
}

TEST(Photo, RenderedSeamsAreMeasuredToAThirdOfAPixel) {
    std::uint64_t seed = 11;
    for (const Rendered& photo : rendered_photos()) {
        SCOPED_TRACE(photo.name);
        const auto line = find_photo_line(draw_photo(photo.picture, photo.noise, seed));
        ASSERT_TRUE(line);
        const Off off = off_truth(*line, photo.picture.course);
        EXPECT_LT(off.rms, 0.3);
        EXPECT_LT(off.normalised, 2.2);
        EXPECT_GT(off.normalised, 0.4);
        RecordProperty(photo.name, std::to_string(off.rms));
        seed = seed == 11 ? 12 : 11;
    }
}

// Known answers: a straight line keeps straight over flaws to one side and over what is not measured, and beyond its
// ends; waves much longer than the flaws are followed.
TEST(Photo, SmoothLinesFollowWavesAndNoFlaws) {
    detail::Heights straight, wave;
    for (int i = 0; i < 160; ++i) {
        const double jitter = 0.1 * std::sin(2.4 * i * i);
        const bool flaw = i % 40 > 30, hidden = i < 4 || (i > 70 && i < 90);
        straight.y.push_back(3 + 0.1 * i + jitter + (flaw ? 6 : 0));
        straight.measured.push_back(!hidden);
        wave.y.push_back(8 * std::sin(2 * M_PI * i / 80) + jitter);
        wave.measured.push_back(true);
    }
    const detail::SmoothLine line = detail::smooth_line(straight, 12), bent = detail::smooth_line(wave, 12);
    for (int i = 0; i < 160; ++i) {
        const auto k = static_cast<std::size_t>(i);
        EXPECT_NEAR(line.y[k], 3 + 0.1 * i, 0.4) << i;
        EXPECT_NEAR(bent.y[k], 8 * std::sin(2 * M_PI * i / 80), 0.4) << i;
    }
    EXPECT_GT(line.length, 2 * bent.length);
}

// Tacks and holes hide the seam: what lies there is carried over and says so.
TEST(Photo, BridgedPartsAreMarked) {
    const Rendered photo = rendered_photos()[1];
    const auto line = find_photo_line(draw_photo(photo.picture, photo.noise, 11));
    ASSERT_TRUE(line);
    EXPECT_GT(off_truth(*line, photo.picture.course).modelled, 3U);
    EXPECT_FALSE(line->points.front().modelled);
    EXPECT_FALSE(line->points.back().modelled);
    double along = 0;
    for (const PhotoPoint& point : line->points) {
        along = std::max(along, point.p.y());
        EXPECT_LT(distance_from(photo.picture.course, point.p), 4) << point.p.transpose();
    }
    EXPECT_GT(along, 0.95 * photo.picture.height);
}

TEST(Photo, TextureAloneIsNoSeam) {
    PhotoPicture picture;
    picture.course = {{-200, -100}, {900, -100}};  // outside
    EXPECT_FALSE(find_photo_line(draw_photo(picture, {}, 1)));
}

TEST(Photo, TheSeamIsInMillimetresOnThePlane) {
    CameraModel camera{640, 480, {1000, 1000}, {319.5, 239.5}, {-0.1, 0.02, 0, 0, 0}};
    Eigen::Isometry3d camera_from_plane = Eigen::Isometry3d::Identity();
    camera_from_plane.linear() = Eigen::AngleAxisd(3.0, Vector3d(1, 0.1, 0).normalized()).toRotationMatrix();
    camera_from_plane.translation() = Vector3d(5, -10, 400);
    PhotoLine line;
    std::vector<Vector3d> truth;
    for (int i = 0; i < 5; ++i) {
        truth.emplace_back(-80 + 40 * i, 3.0 * i, 0);
        line.points.push_back({pixel_of(camera, camera_from_plane * truth.back()), {0, 1}, 0.2, i == 2});
    }
    const Seam seam = seam_on_plane(line, {{}, camera, camera_from_plane});
    ASSERT_EQ(seam.points.size(), truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
        EXPECT_LT((seam.points[i].p - truth[i]).norm(), 1e-6);
        EXPECT_NEAR(seam.points[i].sigma_mm, 0.2 * 0.4, 0.02);  // 400 mm over 1000 px
        EXPECT_EQ(seam.points[i].modelled, i == 2);
        EXPECT_GT((camera_from_plane.inverse().translation() - truth[i]).dot(seam.points[i].n1), 0) << "to the camera";
    }
    camera_from_plane.linear() = Eigen::AngleAxisd(1.57, Vector3d::UnitX()).toRotationMatrix();
    EXPECT_THROW(seam_on_plane(line, {{}, camera, camera_from_plane}), InputError) << "seen edge-on";
}

std::map<std::string, Course> marked_seams() {
    std::map<std::string, Course> seams;
    std::ifstream file(fs::path(SEAMPATH_SOURCE_DIR) / "tests" / "photo" / "marked_seams.csv");
    for (std::string line; std::getline(file, line);) {
        std::istringstream text(line);
        std::string name;
        Vector2d p;
        char comma = 0;
        if (line.starts_with('#') || !std::getline(text, name, ',') || !(text >> p.x() >> comma >> p.y())) {
            continue;
        }
        seams[name].push_back(p);
    }
    return seams;
}

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

// Share of the marked seam that the points' polyline comes near to.
double share_within(const Course& marked, const PhotoLine& line, double reach) {
    Course found;
    for (const PhotoPoint& point : line.points) {
        found.push_back(point.p);
    }
    int near = 0, all = 0;
    for (std::size_t i = 0; i + 1 < marked.size(); ++i) {
        const double length = (marked[i + 1] - marked[i]).norm();
        for (double s = 0; s < length; s += 2) {
            near += distance_from(found, marked[i] + s / length * (marked[i + 1] - marked[i])) <= reach ? 1 : 0;
            ++all;
        }
    }
    return static_cast<double>(near) / all;
}

TEST(Photo, RealSeamsAreFollowedWhereAPersonSeesThem) {
    const fs::path folder = fs::path(SEAMPATH_SOURCE_DIR) / ".." / "shared" / "scans" / "photos";
    if (!fs::exists(folder)) {
        GTEST_SKIP() << "the real photographs are not on this machine: " << folder;
    }
    // Least share within 4 px. Where flakes as long as ten widths broke out of an edge (x2, x5), the line follows them
    // some pixels.
    const std::map<std::string, double> least{{"specular", 0.95}, {"x2", 0.85}, {"x3", 0.95}, {"x4", 0.95},
                                              {"x5", 0.89},       {"x6", 0.95}, {"x7", 0.95}, {"y1", 0.95}};
    const auto seams = marked_seams();
    ASSERT_EQ(seams.size(), least.size());
    for (const auto& [name, marked] : seams) {
        const auto line = find_photo_line(decode_photograph(bytes_of(folder / (name + ".jpg")), name));
        ASSERT_TRUE(line) << name;
        const double near = share_within(marked, *line, 4);
        EXPECT_GE(near, least.at(name)) << name;
        EXPECT_GE(share_within(marked, *line, 12), 0.99) << name << ": the seam and no other line";
        RecordProperty(name, std::to_string(near));
    }
}

}  // namespace photo_test
}  // namespace seampath
