#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stages/types.hpp"

/// Two runs of one part, held against each other in the frame of their scans.
namespace seampath {

/// What a difference means. `same`: the sigmas explain it. `tolerated`: they don't, but it is within the tolerance.
/// `differs`: neither. `told`: nothing is known that it could be judged by.
enum class DifferenceVerdict { same, tolerated, differs, told };
inline constexpr std::array<std::string_view, 4> kDifferenceVerdictNames{"same", "within tolerance", "differs",
                                                                         "not judged"};
inline std::string_view name(DifferenceVerdict verdict) {
    return kDifferenceVerdictNames[static_cast<std::size_t>(verdict)];
}

/// One number or fact of both runs.
struct Difference {
    std::string of;                    ///< "part", or "seam 0", of a pair "seam 0 / 1" where the numbers differ
    std::string name;                  ///< as in report.json; ends in the unit
    std::string a, b;                  ///< values as in report.json; empty where a run has none
    std::optional<double> difference;  ///< b - a, or a distance, in the unit of the name
    std::optional<double> sigma;       ///< of the difference, where both runs say how sure they are
    std::optional<double> allowed;     ///< largest difference that is not judged as one
    DifferenceVerdict verdict = DifferenceVerdict::told;

    double share() const;  ///< of what is allowed; 0 where nothing is
};

/// One place of a pair of seams.
struct PairPlace {
    double station_mm = 0;    ///< along the seam of run A
    Eigen::Vector3d p;        ///< there, mm
    Eigen::Vector3d off;      ///< from there to the nearest place of the other curve, square to it, mm
    double across_mm = 0;     ///< the part of `off` to the right of travel
    double up_mm = 0;         ///< the part of `off` into the air
    double sigma_mm = 0;      ///< of both curves together
    double station_b_mm = 0;  ///< of that nearest place, along the seam of run B
};

struct SeamPair {
    std::size_t a = 0, b = 0;
    double tolerance_mm = 0;        ///< the smaller of both
    std::vector<PairPlace> places;  ///< where both curves run side by side, by station
};

struct ComparedRun {
    std::string name;  ///< the folder as it was given
    std::string part;
    std::string report;  ///< text of report.json
    std::vector<SeamModel> models;
    std::vector<Deviation> deviations;
};

struct RunComparison {
    ComparedRun a, b;
    std::vector<SeamPair> pairs;
    std::vector<Difference> differences;  ///< worst first
    std::vector<Difference> settings;     ///< options with different values
    bool pass = false;                    ///< nothing differs
    std::string sentence;
};

/// Compares the runs in two folders. Seams are paired by where they lie, whatever their numbers are: of all pairs, the
/// nearest first, if half of the shorter seam runs within a tenth of its length of the other. Of each pair the distance
/// of the curves that 99.7 % of places keep is held against 3.41 sigmas of both together (99.7 % of the distances in a
/// plane) and against the smaller tolerance; dimensions with a sigma against 3 sigmas; kinds, closedness and verdicts
/// against being equal. A seam without a partner differs. Everything else in report.json is told. Throws InputError for
/// folders without a whole run over a scan.
RunComparison compare_runs(const std::filesystem::path& a, const std::filesystem::path& b);

/// For machines.
std::string run_comparison_json(const RunComparison& comparison);

/// One file that needs no network: both runs overlaid, and the differences, worst first.
std::string run_comparison_page(const RunComparison& comparison);

}  // namespace seampath
