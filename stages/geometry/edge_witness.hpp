#pragma once

#include <cstdint>
#include <optional>
#include <vector>

/// Where the top of a plate ends, by all that the scan's views saw of its edge.
namespace seampath {

inline constexpr double kTopGate = 3.5;   ///< noises off a top within which a point is of it
inline constexpr double kWallDepth = 20;  ///< point distances below a top down to which its edge's wall is looked at

/// A point beside a straightened edge, mm: s along it, d from a line before the edge towards the plate, `off` the
/// height over the plate's top.
struct EdgePoint {
    double s, d, off;
    std::uint32_t view;
};

/// What is known of the edge beforehand.
struct EdgeLook {
    double distance = 0;  ///< mm, of the edge from the line
    double noise = 0;     ///< mm, of a point of the top
    double spacing = 0;   ///< mm, of points
    double along = 0;     ///< mm, half length of the stretch
    double away = 0;      ///< mm from the line up to which the top is one surface
    double above = 0;     ///< mm by which the top lies above what is seen behind the edge; 0: a wall is
    bool shaded = false;  ///< so far below the plate across the gap that most views may not see the edge
};

/// What one view tells of the edge.
struct Witness {
    std::uint32_t view = 0;
    bool wall = false;    ///< it sees the wall below the edge; otherwise it sees the top stop
    double distance = 0;  ///< mm, of the edge from the line
    double variance = 0;  ///< of it, by noise
    double share = 0;     ///< of the weight of all that are believed
};

/// How far, at s, the edge lies off its mean, towards the plate, mm.
struct EdgeOff {
    double s, off, weight;
};

struct Edge {
    double distance = 0;  ///< mm, from the line
    double variance = 0;  ///< of it, by noise
    bool walled = false;  ///< its wall was seen below the top
    std::vector<Witness> witnesses;
    std::vector<EdgeOff> offs;
};

/// The edge by two kinds of witness, never by the outermost point. A view that looks over the edge sees the top stop:
/// as many points as lie between the edge and a line on the plate, over their density, is the distance between both,
/// whatever the phase of the view's raster; pixels whose light came from both sides of the edge hang between them, and
/// count to the nearer side, so that as many are gained as lost. A view that looks at the edge sees the wall below it:
/// robustly a line, met with the top. Witnesses that do not agree with most are left out: a view that has the edge in a
/// shadow sees the top end early, one that sees a wall without knowing sees it go on. Empty without a witness.
std::optional<Edge> find_edge(const std::vector<EdgePoint>& points, const EdgeLook& look);

}  // namespace seampath
