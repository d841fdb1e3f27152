#pragma once

#include <vector>

#include "stages/mechanism/walk.hpp"

/// Private to the mechanism: the best way along a segment.
namespace seampath::mechanism {

/// The way from the first to the last node of `greedy` whose nodes in between have the least rms distance from the
/// line. Each move goes nearer to M2, so the moves form no circle and dynamic programming in the order of that distance
/// gives the least sum of d^2 - lambda; with lambda the mean of the best way so far, until it no longer falls
/// (Dinkelbach 1967), that is the least mean. Takes time and space in proportion to the nodes of the corridor.
std::vector<GridNode> optimal_way(const GridSegment& segment, const std::vector<GridNode>& greedy,
                                  Neighbours neighbours);

}  // namespace seampath::mechanism
