// Counts stop signals: Ctrl-C, SIGTERM and a terminal that hangs up.
#pragma once

namespace aurasim::host {

/// From now on SIGINT, SIGTERM and SIGHUP are counted instead of ending the process (SIGHUP not under nohup), and a
/// closed pipe or a full file is an error of the write. A process that is asked to stop after its parent has died is
/// ended after 30 s, because no launcher is left to end it.
void catch_stop_signals();
/// From now on the first SIGTERM asks the process to leave, not to stop: other nodes need its world. With
/// `ends_with_parent`, only as long as its parent lives.
void let_sigterm_ask_to_leave(bool ends_with_parent);
bool asked_to_leave();
bool stop_requested();
/// Number of stop signals. A second one means that the user does not want to wait.
int stop_requests();

}  // namespace aurasim::host
