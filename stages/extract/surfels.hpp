#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/grid.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/scale.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// How sure it is on which side of a surface the air lies.
enum class AirSide { known, assumed, unknown };

/// The scan, thinned to one element a cell: what coarse work looks at.
struct Surfel {
    Eigen::Vector3d p;              ///< mean of the cell's points, relative to the scan's origin, mm
    Eigen::Vector3d n{0, 0, 0};     ///< unit, out of the material; zero where too few neighbours
    std::uint32_t piece = 0;        ///< of the scan that hangs together, by its first surfel
    AirSide side = AirSide::known;  ///< how sure it is that n points there; the same for all of a piece
    double flatness = 0;            ///< rms distance of the neighbours from their plane, mm
};

/// A list of surfels for each surfel. Lists of neighbouring surfels share their memory, which is half of what a list
/// of its own would take for each.
class SurfelLists {
public:
    SurfelLists() = default;
    /// `append(i, items)` adds surfel i's list to the end of `items`; it is called in parallel.
    template <class Append>
    SurfelLists(std::size_t count, Append&& append) : blocks_((count + kBlock - 1) / kBlock), end_(count) {
        parallel_for(blocks_.size(), 1, [&](std::size_t b) {
            std::vector<std::uint32_t>& items = blocks_[b];
            for (std::size_t i = b * kBlock; i < std::min(count, (b + 1) * kBlock); ++i) {
                append(static_cast<std::uint32_t>(i), items);
                end_[i] = static_cast<std::uint32_t>(items.size());
            }
            items.shrink_to_fit();
        });
    }
    std::span<const std::uint32_t> operator[](std::size_t i) const {
        const std::uint32_t* const items = blocks_[i / kBlock].data();
        return {items + (i % kBlock == 0 ? 0 : end_[i - 1]), items + end_[i]};
    }

private:
    static constexpr std::size_t kBlock = 256;
    std::vector<std::vector<std::uint32_t>> blocks_;
    std::vector<std::uint32_t> end_;  ///< of each list, within its block
};

struct Surfels {
    double radius = 0;  ///< of the neighbourhoods, mm
    std::vector<Surfel> at;
    SurfelLists next;                ///< surfels that touch each one, ascending
    SurfelLists neighbours;          ///< those within the radius that hang together with each one; itself first
    std::string orientation_reason;  ///< one sentence: how the side of the air was found
};

/// Surfels of a grid with plane normals over `radius`, not yet told which side is the air.
Surfels make_surfels(const PointGrid& grid, double radius);

/// Turns all normals to the side of the air: by the sensor's place or the file's normals if there are any; otherwise
/// normals are made consistent over each connected piece (minimum spanning tree, Hoppe et al. 1992) and each piece is
/// turned so that fewer of its normals run into other parts of the scan: what a scanner saw is open to the outside, and
/// the inside of a box, web or pipe is not. Where few rays decide, a plane that is much of the scan with all else on
/// one side of it does; that is an assumption where the plane ends at the walls that stand on it, since a block and a
/// trough are then the same points. A piece of which nothing told is left as it is.
void orient(Surfels& surfels, const PointGrid& grid, const Scan& scan);

}  // namespace seampath::detail
