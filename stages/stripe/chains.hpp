#pragma once

#include <vector>

#include "stages/stripe/bars.hpp"

namespace seampath {

/// One bar of a chain.
struct ChainLink {
    int column = 0;
    Bar bar;
};

/// Bars that follow each other from column to column; columns ascend, a few may be missing.
struct Chain {
    std::vector<ChainLink> links;
};

/// Links bars to chains, with hysteresis: of those that reach `sure` somewhere and are long enough to be lines.
std::vector<Chain> link_bars(const std::vector<std::vector<Bar>>& columns, double sure);

/// At most `count` lines with at most one bar a column, each put together from those chains that say most, the best
/// first. What lies beside it, e.g. a second reflection, is not of it; lines far fainter than the first are left out.
std::vector<Chain> choose_lines(std::vector<Chain> chains, int count);

/// Median of a number of each link.
double median_of(const Chain& chain, float Bar::*number);

}  // namespace seampath
