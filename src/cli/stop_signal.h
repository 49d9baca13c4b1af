// Ctrl-C and SIGTERM as a flag to ask for.
#pragma once

namespace aurasim::cli {

/// From now on SIGINT and SIGTERM set the flag instead of ending the process.
void catch_stop_signals();
bool stop_requested();

}  // namespace aurasim::cli
