// Standard output that may go away: a closed pipe or a terminal that hung up is no reason to lose a run.
#pragma once

#include <string>

namespace aurasim::cli {

/// False when nobody takes it any more. Throws nothing.
bool print(const std::string& text);

}  // namespace aurasim::cli
