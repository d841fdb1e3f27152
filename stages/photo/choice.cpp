#include "stages/photo/choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

constexpr std::array kSeamKinds{LineKind::dark, LineKind::bright};
constexpr std::array kBorderKinds{LineKind::border};
constexpr std::size_t kMostBorders = 8;
constexpr double kMostVouched = 4;  // of a line's own worth: two borders make no line of nothing

std::vector<LinePath> best_borders(const LineEvidence& evidence) {
    constexpr double kLeastWorth = 0.5;  // texture alone has less
    std::vector<LinePath> borders;
    while (borders.size() < kMostBorders) {
        borders.push_back(best_path(evidence, kBorderKinds, borders));
        if (borders.back().worth < kLeastWorth) {
            borders.pop_back();
            break;
        }
    }
    return borders;
}

/// Midway between two borders; without entries where they meet or are hardly apart.
Corridor corridor_between(const LinePath& a, const LinePath& b) {
    constexpr double kLeastHalf = 16;  // rows: else they may be the sides of one line
    Corridor corridor;
    for (std::size_t i = 0; i < a.places.size(); ++i) {
        const double half = 0.5 * (b.places[i].row - a.places[i].row);
        if (half < kLeastHalf) {
            return {};
        }
        corridor.half.push_back(half);
        corridor.middle.push_back(a.places[i].row + half);
    }
    return corridor;
}

/// A line that lies in the middle part of a corridor is as wide as that part at most: a wider one is what was ground.
double widest_in(const Corridor& corridor) {
    std::vector<double> halves = corridor.half;
    return 2 * Corridor::kShare * quantile(halves, 0.5);
}

/// Whether two paths are the same line for most of their way.
bool same_line(const LinePath& a, const LinePath& b) {
    int near = 0;
    for (std::size_t i = 0; i < a.places.size(); ++i) {
        const float reach = 4 + std::max(a.places[i].sign.width, b.places[i].sign.width);
        near += std::abs(a.places[i].row - b.places[i].row) <= static_cast<int>(reach) ? 1 : 0;
    }
    return 2 * near > static_cast<int>(a.places.size());
}

}  // namespace

ChosenLine choose_line(const LineEvidence& evidence) {
    std::vector<ChosenLine> lines;
    const LinePath free = best_path(evidence, kSeamKinds, {});
    lines.push_back({free, free.worth, 0, false, kLineWidths.back()});
    const LinePath second = best_path(evidence, kSeamKinds, {&free, 1});
    lines.push_back({second, second.worth, 0, false, kLineWidths.back()});
    const std::vector<LinePath> borders = best_borders(evidence);
    for (const LinePath& a : borders) {
        for (const LinePath& b : borders) {
            const Corridor corridor = corridor_between(a, b);
            if (!corridor.middle.empty()) {
                const LinePath path = best_path(evidence, kSeamKinds, {}, &corridor);
                const double worth = path.worth + std::min({kMostVouched * path.worth, a.worth, b.worth});
                lines.push_back({path, worth, 0, true, widest_in(corridor)});
            }
        }
    }
    const auto less = [](const ChosenLine& a, const ChosenLine& b) { return a.worth < b.worth; };
    ChosenLine best = *std::max_element(lines.begin(), lines.end(), less);
    for (const ChosenLine& line : lines) {
        if (line.worth > best.rival_worth && !same_line(line.path, best.path)) {
            best.rival_worth = line.worth;
        }
    }
    return best;
}

}  // namespace seampath::detail
