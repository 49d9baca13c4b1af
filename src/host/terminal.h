// Standard output that may be closed during a run: a closed pipe or terminal must not end the run.
#pragma once

#include <string>

namespace aurasim::host {

/// Prints `text`. False when standard output is closed. Throws nothing.
bool print(const std::string& text);

}  // namespace aurasim::host
