// Ctrl-C and SIGTERM counted.
#pragma once

namespace aurasim::cli {

/// From now on SIGINT and SIGTERM are counted instead of ending the process.
void catch_stop_signals();
bool stop_requested();
/// How often: whoever asks again does not want to wait.
int stop_requests();

}  // namespace aurasim::cli
