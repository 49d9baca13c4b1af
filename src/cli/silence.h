// What a command does that listens to a run, and hears nobody.
#pragma once

#include <chrono>

#include "cli/commands.h"
#include "config/launch.h"

namespace aurasim::cli {

/// Nodes are found in a fraction of a second, on a bad network in a few.
inline constexpr std::chrono::seconds kPatienceWithSilence{10};

/// Says in which domain nobody was heard, and ends the process with 1.
[[noreturn]] void fail_for_want_of_a_run(const FileArguments& files, const config::Launch& launch);

}  // namespace aurasim::cli
