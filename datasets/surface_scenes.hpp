#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "datasets/fixture_scenes.hpp"
#include "datasets/part_mesh.hpp"

/// Parts with known truth that stand among clutter on a table, seen once by a camera from
/// above and from a corner, so that the sides of a part that stands square are seen, too.
namespace seampath {

/// The first six have one pose only; of the rest some direction is open, or several poses look alike.
enum class FixturePart { bracket, node, housing, tee, wedge, hat, sheet, pipe, sleeve, ball, cuboid, flange };
inline constexpr std::array<std::string_view, 12> kFixturePartNames{
    "bracket", "pipe node", "housing", "tee", "wedge", "hat", "sheet", "pipe", "sleeve", "ball", "cuboid", "flange"};
inline constexpr std::size_t kDefiniteParts = 6;

PartMesh part_mesh(FixturePart part);

struct SurfaceScene {
    FixturePart part = FixturePart::bracket;
    int width = 640, height = 470;  ///< pixels: 300 800
    double share = 0.3;             ///< of the points that lie on the part
    double sigma_mm = 0.05;         ///< along the line of sight
    std::optional<int> quarter;     ///< of a turn, from which it is seen; drawn where none is given
};

struct SurfaceScan {
    FixtureScan made;                   ///< base frame: any turn, any place
    std::vector<std::uint8_t> of_part;  ///< of each point: 1 for the part's, 0 for what is around
    double on_part = 0;                 ///< share of the points
    double part_seen = 0;               ///< share of the part's surface that they show, by area
};

SurfaceScan make_surface_scan(const SurfaceScene& scene, std::uint64_t seed);

/// A golden scan: the points of the part alone, in its frame, with the place of the sensor.
Scan golden_scan(const SurfaceScan& seen);

}  // namespace seampath
