#pragma once

#include <string>
#include <vector>

#include "pipeline/fixture_history.hpp"

/// What repeated calibrations of a fixture say about the calibration itself.
namespace seampath {

/// Gauge repeatability and reproducibility of one coordinate of one work point (AIAG, Measurement Systems Analysis, 4th
/// edition, ANOVA method). Standard deviations, mm.
struct GaugeStudy {
    int parts = 0, appraisers = 0, trials = 0;
    double repeatability = 0;         ///< EV: within the same part and appraiser
    double reproducibility = 0;       ///< AV: between appraisers, their interaction with parts included
    double part_variation = 0;        ///< PV
    double gauge = 0;                 ///< GRR: both of the first
    double percent_of_tolerance = 0;  ///< 600 GRR over the width of the tolerance; <= 10 accepted, > 30 rejected
    double distinct_categories = 0;   ///< ndc = 1.41 PV / GRR; 0 for one part
};

/// `value[part][appraiser][trial]`, as many of each; `tolerance` is the width, mm. Throws InputError for less than two
/// trials.
GaugeStudy gauge_study(const std::vector<std::vector<std::vector<double>>>& value, double tolerance);

/// A coordinate of a work point over time: individuals and moving ranges.
struct DriftChart {
    std::string name;              ///< "nozzle, x"
    std::vector<double> value;     ///< mm, from the mean
    double mean = 0;               ///< mm, base frame
    double limit = 0;              ///< 2.66 mean moving range: a value further off is out of control
    double slope = 0;              ///< mm a run
    double slope_sigmas = 0;       ///< over its standard error
    std::vector<std::size_t> out;  ///< runs out of control
};

struct FixtureStudy {
    std::size_t runs = 0;
    std::vector<DriftChart> charts;
    std::optional<GaugeStudy> gauge;  ///< of the coordinate with the largest GRR
    std::string gauge_of;
    double largest_shift_mm = 0;      ///< of a work point, between the first run and the last
    std::vector<std::string> alarms;  ///< a sentence each
    std::vector<std::string> notes;
};

/// Runs of one fixture in the order in which they were made, at the work points of the last. Parts and appraisers are
/// taken from the rows; without a complete set of them all runs count as trials. `limit_mm` is the largest shift that
/// raises no alarm; the tolerance is twice that wide. Throws InputError for less than two runs.
FixtureStudy study_fixture(const std::vector<HistoryRow>& runs, double limit_mm);

}  // namespace seampath
