#pragma once

#include <string>

#include "pipeline/fixture_calibration.hpp"
#include "stages/error.hpp"

namespace seampath {

/// Now, or the date given, as 2026-11-26T05:00:00Z. Throws InputError for what is no date.
std::string date_of(const std::string& given);

/// Throws InputError unless --accept and --reason come together.
void check_acceptance(bool accept, const std::string& reason);

/// Makes a calibration that measured well the accepted one; where it has moved since the last one, that becomes a note.
/// Throws InputError for one that did not measure well.
template <class Calibration>
void accept(Calibration& c, bool measured_well, const std::string& reason) {
    if (!measured_well) {
        throw InputError("--accept: this calibration did not pass and can't be accepted: " + c.frame.faults.front());
    }
    c.accepted = Acceptance{c.date, reason};
    c.frame.notes.insert(c.frame.notes.end(), c.frame.faults.begin(), c.frame.faults.end());
    c.frame.faults.clear();
}

}  // namespace seampath
