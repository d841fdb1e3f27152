#pragma once

namespace seampath {

/// From now on the first Ctrl-C (or SIGTERM) asks the program to stop, the second ends it at once with status 130.
void watch_stop_signals();

/// Whether the program was asked to stop.
bool stop_asked();

}  // namespace seampath
