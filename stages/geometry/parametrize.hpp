#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

/// Parameters t_0 = 0 < ... < t_N = 1 for the points that natural cubic splines are laid through: Marin, An approach to
/// data parametrization in parametric cubic spline interpolation problems, J. Approx. Theory 41 (1984).
namespace seampath {

/// What the spacing of the parameter follows, or makes least.
enum class Objective {
    chord,        ///< h proportional to the distance of the points, (5)
    centripetal,  ///< to its root: Lee, Choosing nodes in parametric curve interpolation, CAD 21 (1989)
    foley,        ///< to the distance, more where the polygon turns: Foley & Nielson (1989), in the Euclidean metric
    exact,        ///< least bending energy, (31)
    diagonal,     ///< least approximate bending energy, (34)
    minimax       ///< least of the largest acceleration over its limit, of any axis: shortest time within the limits
};
inline constexpr std::array<std::string_view, 6> kObjectiveNames{"chord", "centripetal", "foley",
                                                                 "exact", "diagonal",    "minimax"};
inline std::string_view name(Objective objective) {
    return kObjectiveNames[static_cast<std::size_t>(objective)];
}

/// How `exact` and `diagonal` are minimised: L-BFGS in log h, or the paper's gradient projection (30) for comparison.
enum class Solver { lbfgs, gradient_projection };

struct ParametrizeOptions {
    Objective objective = Objective::chord;
    Solver solver = Solver::lbfgs;
    std::vector<double> weights;  ///< alpha of (1), one a coordinate, positive; empty: all 1
    std::vector<double> limits;   ///< largest acceleration of each axis, positive; empty: the weights
    double tolerance = 1e-12;     ///< relative, of the objective; above 0
    int max_evaluations = 20000;  ///< of the objective with its gradient
};

/// Parameters and how hard the splines over them bend. Accelerations are second derivatives for t in [0, 1].
struct Parametrization {
    std::vector<double> t;                 ///< one a point, from 0 to 1, ascending
    double exact_energy = 0;               ///< G of (31)
    double diagonal_energy = 0;            ///< G of (34)
    std::vector<double> max_acceleration;  ///< largest |theta''| of each coordinate
    double peak = 0;        ///< the largest of them over its limit; its root is the shortest time within the limits
    int evaluations = 0;    ///< of the objective with its gradient
    int iterations = 0;     ///< of the gradient projection
    bool converged = true;  ///< the objective is within the tolerance of a local minimum
};

/// Index i of the first point that equals point i + 1, if any: no parametrization exists then (its G is infinite).
std::optional<std::size_t> first_repeated(std::span<const Eigen::VectorXd> points);

/// Parametrizes at least two points of one dimension each. One-dimensional points have the closed form of section 2,
/// which `exact` then is. Throws InputError on fewer points, on points that differ in dimension, are not finite or
/// repeat (with the two rows, from 1), and on weights or limits of the wrong number or not above 0.
Parametrization parametrize(std::span<const Eigen::VectorXd> points, const ParametrizeOptions& options);

/// The spacing of least G for scalar ordinates, (9) and (14)-(17); no two in a row are equal.
Eigen::VectorXd closed_form_spacing(std::span<const double> z);

}  // namespace seampath
