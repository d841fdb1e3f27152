#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/dataset.hpp"
#include "datasets/score.hpp"
#include "stages/extract/extract.hpp"
#include "stages/types.hpp"

/// From a made scan to its score: what the accuracy program prints and the tests hold.
namespace seampath {

/// What seams and models of a made scan must reach.
struct AccuracyLimits {
    double rms_mm = 0.03;
    double max_mm = 0.12;
    double found = 0.98;
    double false_share = 0.02;
    double end_mm = 1.5;
};

/// One scan, measured. Times are wall clock.
struct Accuracy {
    SceneKind scene = SceneKind::tee;
    std::uint64_t seed = 0;
    std::size_t points = 0;
    std::size_t seams = 0;
    std::size_t true_seams = 0;
    Score extracted;
    Score fitted;
    /// What of that error the views have in common, rms, mm (tests/accuracy/common_error.hpp), and the scores against
    /// the truth that is moved by it.
    double common_mm = 0;
    Score extracted_apart;
    Score fitted_apart;
    double within_1_sigma = 0;     ///< share of extracted points whose distance from the truth is below their sigma
    double within_2_sigma = 0;     ///< below twice their sigma
    double validated_rms_mm = 0;   ///< largest of all models
    double least_coverage = 1;     ///< smallest of all models
    std::size_t passed = 0;        ///< models whose verdict is pass
    std::size_t passed_wrong = 0;  ///< of those, the ones that are off by more than their verdict's tolerance, or where
                                   ///< there is no seam
    std::vector<SaddleParameters> saddles;  ///< of the models that have them
    double extract_s = 0;
    double stages_s = 0;  ///< extract, place, fit, validate
};

Scan scan_of(const Dataset& dataset);

/// Extracts, places, fits and validates, and compares with the truth. All other stages have their default options.
Accuracy measure_accuracy(const Dataset& dataset, const ExtractOptions& options = {});

/// Largest error of an open seam's ends, mm; 0 without open seams.
double worst_end(const Score& score);

/// The limits that are missed, each as "what value > limit"; empty when all hold.
std::vector<std::string> missed(const Accuracy& accuracy, const AccuracyLimits& limits);

}  // namespace seampath
