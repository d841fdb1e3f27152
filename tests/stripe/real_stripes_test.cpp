#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/files.hpp"
#include "stages/picture/picture.hpp"
#include "stages/stripe/stripe.hpp"

/// Ten pictures of one or two laser stripes on joints under a torch, each with a mask of the stripes that a person
/// drew: a band of even width along straight lines, up to four pixels beside the stripe where that is wide, so that its
/// middle says where the stripe is to some pixels only.
namespace seampath {
namespace real_stripes_test {

namespace fs = std::filesystem;

constexpr int kFrame = 2;        // px of a figure's frame about each picture
constexpr int kPartlyDrawn = 5;  // the picture whose mask leaves out what a stripe shows of a second plate

struct Share {
    double of = 0, all = 0;
    void add(bool counts) { of += counts, ++all; }
    double value() const { return of / all; }
};

struct MaskScore {
    Share within_2_px;          // of the mask's columns, one for each stripe: a point that near to the mask's middle
    Share found;                // a point in the mask's band, or 2 px beside it
    Share outside;              // of the points: not in the mask's band, nor 2 px beside it
    Share gravity_within_2_px;  // of the mask's columns: the light's own gravity that near to the mask's middle
    Share point_at_gravity;     // of those with a point in the band: it lies that near to the light's gravity
};

// Middle of the light in rows [begin, end) of a column and some beside them, without any of the detector's means: the
// gravity of what is brighter than half way from the darkest to the brightest.
double gravity_of(const GreyImage& image, int column, int begin, int end) {
    constexpr int kBeside = 4;
    float least = INFINITY, most = -INFINITY;
    for (int r = begin - kBeside; r < end + kBeside; ++r) {
        least = std::min(least, image.clamped(column, r));
        most = std::max(most, image.clamped(column, r));
    }
    double sum = 0, weights = 0;
    for (int r = begin - kBeside; r < end + kBeside; ++r) {
        const double weight = std::max(0.0, static_cast<double>(image.clamped(column, r) - 0.5F * (least + most)));
        sum += weight * r, weights += weight;
    }
    return weights > 0 ? sum / weights : 0.5 * (begin + end - 1);
}

GreyImage real_picture(const fs::path& folder, int number, const char* which) {
    const fs::path file = folder / ("result_" + std::to_string(number) + "_" + which + ".png");
    return decode_picture(read_file(file, std::size_t{1} << 24, "test"), file.string());
}

bool is_near_mask(const GreyImage& mask, const Eigen::Vector2d& p) {
    const int column = static_cast<int>(std::lround(p.x())), row = static_cast<int>(std::lround(p.y()));
    for (int r = row - 2; r <= row + 2; ++r) {
        if (mask.clamped(column, r) >= 128) {
            return true;
        }
    }
    return false;
}

void compare_with_mask(const GreyImage& image, const GreyImage& mask, const std::vector<Stripe>& stripes,
                       MaskScore& score) {
    std::vector<std::vector<double>> rows(static_cast<std::size_t>(mask.width));
    for (const Stripe& stripe : stripes) {
        for (const StripePoint& point : stripe.points) {
            const auto column = static_cast<std::size_t>(std::clamp<long>(std::lround(point.p.x()), 0, mask.width - 1));
            rows[column].push_back(point.p.y());
            score.outside.add(!is_near_mask(mask, point.p));
        }
    }
    for (int c = kFrame; c < mask.width - kFrame; ++c) {
        for (int r = kFrame; r < mask.height - kFrame; ++r) {
            const int begin = r;
            while (r < mask.height - kFrame && mask.at(c, r) >= 128) {
                ++r;
            }
            if (r == begin) {
                continue;
            }
            const double middle = 0.5 * (begin + r - 1), half = 0.5 * (r - begin);
            const double gravity = gravity_of(image, c, begin, r);
            double off = INFINITY, off_gravity = INFINITY;
            for (const double row : rows[static_cast<std::size_t>(c)]) {
                off = std::min(off, std::abs(row - middle));
                off_gravity = std::min(off_gravity, std::abs(row - gravity));
            }
            score.gravity_within_2_px.add(std::abs(gravity - middle) <= 2);
            if (off <= half + 2) {
                score.point_at_gravity.add(off_gravity <= 2);
            }
            score.within_2_px.add(off <= 2);
            score.found.add(off <= half + 2);
        }
    }
}

TEST(RealStripes, AreFoundWhereAPersonDrewThem) {
    const fs::path folder = fs::path(SEAMPATH_SOURCE_DIR) / ".." / "shared" / "scans" / "stripes";
    if (!fs::exists(folder)) {
        GTEST_SKIP() << "the real pictures are not on this machine: " << folder;
    }
    MaskScore score, fully_drawn;
    for (int i = 1; i <= 10; ++i) {
        const GreyImage image = real_picture(folder, i, "input"), mask = real_picture(folder, i, "truemask");
        const auto stripes = find_stripes(image, 2);
        EXPECT_EQ(stripes.size(), 2U) << "picture " << i;
        MaskScore one;
        compare_with_mask(image, mask, stripes, one);
        EXPECT_GT(one.found.value(), 0.85) << "picture " << i;
        RecordProperty("picture_" + std::to_string(i),
                       std::to_string(one.within_2_px.value()) + " " + std::to_string(one.found.value()) + " " +
                           std::to_string(one.outside.value()) + " " + std::to_string(one.gravity_within_2_px.value()) +
                           " " + std::to_string(one.point_at_gravity.value()));
        compare_with_mask(image, mask, stripes, score);
        if (i != kPartlyDrawn) {
            compare_with_mask(image, mask, stripes, fully_drawn);
        }
    }
    EXPECT_GE(score.found.value(), 0.97);
    EXPECT_LE(fully_drawn.outside.value(), 0.02);
    // Points lie where the light is. The masks' middles do not: of the columns three in four have the light's own
    // gravity within 2 px of them, so that nothing that finds the light is nearer to them more often.
    EXPECT_GE(score.point_at_gravity.value(), 0.965);
    EXPECT_LT(score.gravity_within_2_px.value(), 0.75);
    EXPECT_GT(score.within_2_px.value(), score.gravity_within_2_px.value() - 0.03);
    RecordProperty("gravity", std::to_string(score.gravity_within_2_px.value()) + " " +
                                  std::to_string(score.point_at_gravity.value()));
    RecordProperty("all", std::to_string(score.within_2_px.value()) + " " + std::to_string(score.found.value()) + " " +
                              std::to_string(score.outside.value()) + " " +
                              std::to_string(fully_drawn.outside.value()));
}

}  // namespace real_stripes_test
}  // namespace seampath
