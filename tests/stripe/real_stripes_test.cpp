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
    Share within_2_px;  // of the mask's columns, one for each stripe: a point that near to the mask's middle
    Share found;        // a point in the mask's band, or 2 px beside it
    Share outside;      // of the points: not in the mask's band, nor 2 px beside it
};

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

void compare_with_mask(const GreyImage& mask, const std::vector<Stripe>& stripes, MaskScore& score) {
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
            double off = INFINITY;
            for (const double row : rows[static_cast<std::size_t>(c)]) {
                off = std::min(off, std::abs(row - middle));
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
        const auto stripes = find_stripes(real_picture(folder, i, "input"), 2);
        EXPECT_EQ(stripes.size(), 2U) << "picture " << i;
        MaskScore one;
        compare_with_mask(real_picture(folder, i, "truemask"), stripes, one);
        EXPECT_GT(one.found.value(), 0.85) << "picture " << i;
        RecordProperty("picture_" + std::to_string(i), std::to_string(one.within_2_px.value()) + " " +
                                                           std::to_string(one.found.value()) + " " +
                                                           std::to_string(one.outside.value()));
        compare_with_mask(real_picture(folder, i, "truemask"), stripes, score);
        if (i != kPartlyDrawn) {
            compare_with_mask(real_picture(folder, i, "truemask"), stripes, fully_drawn);
        }
    }
    EXPECT_GE(score.found.value(), 0.97);
    EXPECT_LE(fully_drawn.outside.value(), 0.02);
    RecordProperty("all", std::to_string(score.within_2_px.value()) + " " + std::to_string(score.found.value()) + " " +
                              std::to_string(score.outside.value()) + " " +
                              std::to_string(fully_drawn.outside.value()));
}

}  // namespace real_stripes_test
}  // namespace seampath
