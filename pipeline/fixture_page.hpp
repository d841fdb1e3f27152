#pragma once

#include <string>
#include <vector>

#include "pipeline/fixture_history.hpp"
#include "pipeline/report_view.hpp"

namespace seampath {

/// One page that needs no network: verdict, features with their residuals, the uncertainty of the frame and of the work
/// points, all of it in 3D, and every calibration of the folder as a chart. Cells that show a number carry its JSON
/// pointer in the result as data-at and the unrounded value as data-value. `history`: oldest first, this one last.
std::string fixture_page(const FixtureCalibration& calibration, const std::vector<HistoryRow>& history);

/// What the page's 3D view shows, in the frame of the part: the scan, features with what they are off, and ellipsoids
/// that hold 95 % at the work points; arrows and ellipsoids so many times as long as they are.
struct FixtureScene {
    ViewScene scene;
    double arrows_times = 1, ellipsoids_times = 1;
};
FixtureScene fixture_scene(const FixtureCalibration& calibration);

/// How far the work points were, each time, from where the calibration that was accepted last before it, or the first,
/// had them; as a figure. Empty for a single calibration.
std::string history_chart(const std::vector<HistoryRow>& history, double limit_mm);

}  // namespace seampath
