// Ctrl-C, SIGTERM and a terminal that hangs up, counted.
#pragma once

namespace aurasim::cli {

/// From now on SIGINT, SIGTERM and SIGHUP are counted instead of ending the process (SIGHUP not under nohup), and a
/// closed pipe or a full file is an error of the write. Told to stop after its parent has died, when nobody is left to
/// see to it, the process has 30 s before it is ended.
void catch_stop_signals();
/// From now on the first SIGTERM asks the process to leave, not to stop: it has what others need. With
/// `ends_with_parent` only as long as its parent lives.
void let_sigterm_ask_to_leave(bool ends_with_parent);
bool asked_to_leave();
bool stop_requested();
/// How often: whoever asks again does not want to wait.
int stop_requests();

}  // namespace aurasim::cli
