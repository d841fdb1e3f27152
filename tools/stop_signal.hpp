#pragma once

namespace seampath {

/// From now on the first Ctrl-C (or SIGTERM) asks the program to stop and says so, the second ends it at once with
/// status 130. For commands that ask stop_asked(); the others end at the first.
void watch_stop_signals();

/// Whether the program was asked to stop.
bool stop_asked();

}  // namespace seampath
