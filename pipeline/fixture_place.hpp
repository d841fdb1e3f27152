#pragma once

#include <optional>

#include "pipeline/config.hpp"
#include "pipeline/fixture_calibration.hpp"

/// A calibrated fixture as the place of a run's program.
namespace seampath {

/// Reads plan.fixture, if it is given, and makes export.base_from_scan its base_from_part, with the 1-sigmas at the
/// part's origin: the scan's frame is taken as the part's. Throws InputError for a calibration that did not pass, one
/// older than plan.fixture_max_age_h at `now_s` (seconds of Unix time), and a base_from_scan beside it.
std::optional<StoredFixture> put_in_place(Config& config, double now_s);

/// Adds what the fixture's place is not sure of to the waypoints' sigmas: the largest 1-sigma square to travel.
void add_place_sigma(const StoredFixture& fixture, Plan& plan);

/// All that a plan takes from the fixture.
std::string place_key(const StoredFixture& fixture);

}  // namespace seampath
