#include "stages/plan/order.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "stages/plan/plan.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace order_test {

using Eigen::Vector3d;

SeamModel line_at(const Vector3d& start, double turn, double length) {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
    motion.translation() = start;
    return test::model_of(test::moved(test::line(length), motion), false, 4);
}

/// From each retract to the next approach, as the plan has them.
double air_way(const std::vector<Waypoint>& waypoints) {
    double way = 0;
    for (std::size_t k = 1; k < waypoints.size(); ++k) {
        const Vector3d from = waypoints[k - 1].p;
        if (waypoints[k - 1].kind == WaypointKind::retract) {
            const auto next = std::find_if(waypoints.begin() + static_cast<std::ptrdiff_t>(k), waypoints.end(),
                                           [](const Waypoint& w) { return w.kind == WaypointKind::approach; });
            way += (next->p - from).norm();
        }
    }
    return way;
}

/// The least over all orders, and all directions where they are free, by trying them.
double least_way(const std::vector<SeamModel>& models, bool turns) {
    std::vector<std::array<std::pair<Vector3d, Vector3d>, 2>> ends;
    for (const SeamModel& model : models) {
        const auto w = plan({&model, 1}, {}).waypoints;
        ends.push_back({std::pair(w.front().p, w.back().p), std::pair(w.back().p, w.front().p)});
    }
    std::vector<std::size_t> order(models.size());
    std::iota(order.begin(), order.end(), 0);
    double least = 1e300;
    do {
        for (std::size_t mask = 0; mask < (turns ? std::size_t{1} << order.size() : 1); ++mask) {
            double sum = 0;
            for (std::size_t k = 1; k < order.size(); ++k) {
                sum += (ends[order[k]][mask >> k & 1].first - ends[order[k - 1]][mask >> (k - 1) & 1].second).norm();
            }
            least = std::min(least, sum);
        }
    } while (std::next_permutation(order.begin(), order.end()));
    return least;
}

TEST(Order, IsTheShortestOfAll) {
    std::mt19937 generator(5);
    std::uniform_real_distribution<double> at(0, 400);
    for (int round = 0; round < 4; ++round) {
        std::vector<SeamModel> models;
        for (int k = 0; k < 5; ++k) {
            models.push_back(line_at({at(generator), at(generator), 0}, at(generator), 20 + 0.2 * at(generator)));
        }
        for (const bool turns : {false, true}) {
            PlanOptions options;
            options.order = SeamOrder::shortest;
            options.order_turns_seams = turns;
            const Plan result = plan(models, options);
            EXPECT_NEAR(air_way(result.waypoints), least_way(models, turns), 1e-6) << round;
            EXPECT_LE(air_way(result.waypoints), air_way(plan(models, {}).waypoints) + 1e-9);
            std::vector<int> seams;
            for (const Waypoint& w : result.waypoints) {
                if (w.kind == WaypointKind::weld_start) {
                    seams.push_back(w.seam);
                }
            }
            std::sort(seams.begin(), seams.end());
            EXPECT_EQ(seams, (std::vector<int>{0, 1, 2, 3, 4})) << "each once";
        }
    }
}

// Too many to try: in a row the best is from one end to the other.
TEST(Order, OfManySeamsInARowGoesFromEndToEnd) {
    std::vector<SeamModel> models;
    for (int k = 0; k < 20; ++k) {
        models.push_back(line_at({60.0 * (k * 7 % 20), 0, 0}, 0, 30));
    }
    PlanOptions options;
    options.order = SeamOrder::shortest;
    EXPECT_NEAR(air_way(plan(models, options).waypoints), 19 * 30, 1e-6);
    EXPECT_GT(air_way(plan(models, {}).waypoints), 19 * 30 * 5);
}

// Of seams at random places no run turned round and no seam moved elsewhere would make the way shorter.
TEST(Order, OfManySeamsNoExchangeIsShorter) {
    std::mt19937 generator(8);
    std::uniform_real_distribution<double> at(0, 900);
    std::vector<SeamModel> models;
    for (int k = 0; k < 20; ++k) {
        models.push_back(line_at({at(generator), at(generator), 0}, at(generator), 30));
    }
    PlanOptions options;
    options.order = SeamOrder::shortest;
    std::vector<std::pair<Vector3d, Vector3d>> ends;
    for (const Waypoint& w : plan(models, options).waypoints) {
        if (w.kind == WaypointKind::approach) {
            ends.emplace_back(w.p, w.p);
        }
        ends.back().second = w.kind == WaypointKind::retract ? w.p : ends.back().second;
    }
    ASSERT_EQ(ends.size(), 20u);
    const auto way = [](const auto& row) {
        double sum = 0;
        for (std::size_t k = 1; k < row.size(); ++k) {
            sum += (row[k].first - row[k - 1].second).norm();
        }
        return sum;
    };
    const double found = way(ends);
    for (std::size_t i = 0; i < ends.size(); ++i) {
        for (std::size_t k = i + 1; k < ends.size(); ++k) {
            const auto from = static_cast<std::ptrdiff_t>(i), to = static_cast<std::ptrdiff_t>(k) + 1;
            auto turned = ends, later = ends, sooner = ends;
            std::reverse(turned.begin() + from, turned.begin() + to);
            std::rotate(later.begin() + from, later.begin() + from + 1, later.begin() + to);
            std::rotate(sooner.begin() + from, sooner.begin() + to - 1, sooner.begin() + to);
            EXPECT_GE(std::min({way(turned), way(later), way(sooner)}), found - 1e-6) << i << " " << k;
        }
    }
}

TEST(Order, ClosedSeamsBeginWhereTheWayIsShort) {
    const auto ring = [](double x) {
        Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
        motion.translation() = Vector3d(x, 0, 0);
        return test::model_of(test::moved(test::circle(40), motion), true, 64);
    };
    // Both begin at their +X: the next one's nearest place is its -X.
    const std::vector<SeamModel> models{ring(0), ring(300)};
    PlanOptions options;
    options.order = SeamOrder::shortest;
    const double fixed = air_way(plan(models, options).waypoints);
    options.order_moves_starts = true;
    EXPECT_NEAR(fixed - air_way(plan(models, options).waypoints), 2 * (40 + 30 / std::sqrt(2.0)), 0.5);
}

}  // namespace order_test
}  // namespace seampath
