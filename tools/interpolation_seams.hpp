#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "stages/fit/fit.hpp"
#include "stages/types.hpp"
#include "stages/validate/validate.hpp"

/// What `seampath interpolate RUN_FOLDER` computes: the experiment of Minejeva & Markovics on the seams of a scan. All
/// methods are laid through few of a seam's points and held against what the raw scan says between them.
namespace seampath {

/// Where the raw scan says that a seam runs: the places in which its flank surfaces meet, beside the smoothing spline,
/// where both were measured.
struct MeasuredSeam {
    SeamModel spline;
    Deviation deviation;  ///< of the spline
    std::vector<Eigen::Vector3d> p;
};
MeasuredSeam measure_seam(const Seam& seam, const Scan& scan, const ValidateOptions& options);

/// So many points of the seam, its ends among them: at equal arc lengths, or as stage `place` sets them when its
/// tolerance is chosen so that it takes that many, or the next number that it can take.
Nodes equal_nodes(const Seam& seam, std::size_t count);
Nodes curvature_nodes(const Seam& seam, std::size_t count);

/// One method on one set of nodes: distances of the measured places from its line.
struct SeamTrial {
    double rms_mm = 0;
    double p95_mm = 0;
    double max_mm = 0;
};

struct SeamMethod {
    std::string label;  ///< the model's name; that of `parametric` with its parametrization
    FitOptions options;
    std::vector<SeamTrial> trials;  ///< one for each count of nodes
    double mean_rms_mm = 0;         ///< geometric mean of the trials' rms
};

/// One line: its method and nodes in words, and its curve.
struct SeamLine {
    std::string label;
    double rms_mm = std::numeric_limits<double>::infinity();
    SeamModel model;
};

/// All methods on the same nodes, best first.
struct SeamRanking {
    std::vector<std::size_t> counts;  ///< of nodes
    std::vector<SeamMethod> methods;
    std::vector<std::pair<std::string, std::string>> left_out;  ///< methods that can't serve the seam, and why
    SeamLine best;                                              ///< of least rms
};

struct SeamComparison {
    JointKind kind = JointKind::fillet;
    bool closed = false;
    double length_mm = 0;
    std::size_t points = 0;    ///< of the seam
    std::size_t measured = 0;  ///< places that the lines are held against
    SeamTrial spline;          ///< the smoothing spline through all points of the seam
    SeamRanking equal;
    SeamRanking curvature;  ///< without the methods that set their nodes at equal steps
    SeamLine best;          ///< of least rms in both rankings
};

/// `counts` ascend; a seam of fewer points takes them all, once.
SeamComparison compare_methods(const Seam& seam, const MeasuredSeam& measured, std::span<const std::size_t> counts);

std::string seam_comparison_text(const SeamComparison& comparison);
nlohmann::ordered_json seam_comparison_json(const SeamComparison& comparison);

/// For each seam the rms over the number of nodes, one plot for either way to place them, as a file of its own.
std::string seam_comparisons_svg(std::span<const SeamComparison> comparisons);

}  // namespace seampath
