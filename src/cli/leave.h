// How a process that has joined a DDS domain ends.
#pragma once

#include <functional>

#include "cli/exit_code.h"

namespace aurasim::cli {

/// Flushes everything and ends the process without taking its DDS participant down. Fast DDS 2.9.1 aborts in the
/// *other* processes (assertion in PDP::check_remote_participant_liveliness) when a participant says goodbye while they
/// check whether it is still alive; one that is silent they drop by its lease, as they would after a crash.
[[noreturn]] void leave(int exit_code);

/// Leaves with what `work` returns, or says what it has thrown and leaves with kFailed (kBadConfig for that). An
/// exception that went further up would take the participant down.
[[noreturn]] void leave_after(const std::function<ExitCode()>& work);

}  // namespace aurasim::cli
