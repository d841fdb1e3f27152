#pragma once

#include <optional>
#include <vector>

#include "stages/types.hpp"

/// Private to the place stage: what nodes of a spline are chosen from and held against.
namespace seampath {

/// A smooth line through the seam's points, from the foot of the first one. Coordinates are the scan's.
struct SmoothLine {
    bool closed = false;
    double length = 0;  ///< mm
    /// Seam points whose feet follow each other along the line, the first and an open seam's last among them: index,
    /// station of the foot, ascending from 0, and foot.
    std::vector<std::size_t> index;
    std::vector<double> s;
    std::vector<Eigen::Vector3d> p;
    /// Between each of them and the next (in a closed seam also behind the last), what the density of nodes is like:
    /// the integral of |c''''|^(1/4).
    std::vector<double> weight;
    /// Places at which a spline is held against the line: station, position and unit tangent, each with the number of
    /// the foot before it.
    struct Place {
        double s;
        Eigen::Vector3d p, t;
        std::size_t after;
    };
    std::vector<Place> places;
};

/// Throws InputError for a seam without length.
SmoothLine smooth_line(const Seam& seam);

/// The chosen feet of a line and how far the cubic spline through them is from it.
struct Chosen {
    std::vector<std::size_t> foot;  ///< ascending numbers into SmoothLine::index
    std::vector<double> error;      ///< mm, largest distance in each interval; in a closed seam also in the last
    double worst = 0;
};

/// Of at least 2 feet, or 4 of a closed line.
Chosen held_against(const SmoothLine& line, std::vector<std::size_t> foot);

/// Station of a foot; numbers from the size on are those of the next time round.
double station_of(const SmoothLine& line, std::size_t foot);

}  // namespace seampath
