#pragma once

namespace seampath {

/// Exit status of the program; `run` of several scans ends with the largest of its parts.
enum ExitStatus { kPass = 0, kOutOfTolerance = 1, kBadInput = 2, kOwnFault = 3, kInterrupted = 130 };

}  // namespace seampath
