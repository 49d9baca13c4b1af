// How a process that has joined a DDS domain ends.
#pragma once

#include <functional>

#include "command_line/exit_code.h"

namespace aurasim::command_line {

/// Flushes all output and ends the process without deleting its DDS participant. Fast DDS 2.9.1 aborts in the *other*
/// processes (assertion in PDP::check_remote_participant_liveliness) when a participant announces its end while they
/// check whether it is still alive. A silent participant is dropped when its lease ends, as after a crash.
[[noreturn]] void leave(int exit_code);

/// Leaves with the result of `work`. If `work` throws, logs the exception and leaves with kFailed, or kBadConfig for
/// config::BadConfig. An exception that went further up would delete the participant.
[[noreturn]] void leave_after(const std::function<ExitCode()>& work);

}  // namespace aurasim::command_line
