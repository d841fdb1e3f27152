#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/scanner.hpp"
#include "datasets/scenes.hpp"
#include "stages/extract/extract.hpp"
#include "tests/accuracy/measure.hpp"

/// What the measurement of every kind of joint must reach; a test looks at some rows of this table, a program at all.
namespace seampath {

/// Of fitted models, in mm. Without `depth`, distances are in space; with it, rms and max are across the joint alone
/// and `depth` has the same out of it.
struct JointLimits {
    struct Pair {
        double rms_mm, max_mm;
    };
    std::optional<Pair> off;
    std::optional<Pair> depth;
    double found = 0;
    std::optional<double> false_share;
    bool sigma = false;  ///< shares within 1 and 2 sigma, of points and of a saddle's parameters
};

struct JointRow {
    std::string name;
    SceneOptions scene;
    ScannerOptions scanner;
    double size = 1;  ///< of the part against the usual one
    int scans = 1;    ///< for each seed that is asked for
    JointLimits asked;
};

/// In the order of the table.
std::vector<JointRow> joint_rows();

/// Over scans of other seeds, which also draw dimensions and pose. The worst scan tells, but for shares and `all_rms`.
struct JointResult {
    int scans = 0;
    std::size_t seams = 0, passed = 0;
    std::size_t wrong = 0;  ///< of those that passed, the ones that are off by more than the verdict's tolerance
    double all_rms_mm = 0;  ///< over all scans
    double rms_mm = 0, max_mm = 0;
    double across_rms_mm = 0, across_max_mm = 0;
    double depth_rms_mm = 0, depth_max_mm = 0;
    double common_mm = 0;  ///< rms over all scans of what no method can see, as in Accuracy
    double apart_mm = 0;   ///< rms over all scans of what is left beside that
    double found = 1, false_share = 0;
    double within_1_sigma = 0, within_2_sigma = 0;  ///< of extracted points, mean over scans
    std::size_t parameters = 0, parameters_1_sigma = 0, parameters_2_sigma = 0;  ///< of saddles
};
JointResult measure_row(const JointRow& row, std::uint64_t first_seed, int scans);

/// The limits that are missed, each as "what value > limit"; empty when all hold.
std::vector<std::string> missed(const JointResult& result, const JointLimits& asked);

}  // namespace seampath
