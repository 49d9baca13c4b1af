// Finds the program `aurasim`.
#pragma once

#include <string>

namespace aurasim::client {

/// Returns `asked` if it is not empty; else $AURASIM_PROGRAM; else the program that this library was built or installed
/// with, in the nearest folder above it or in its `bin`; else the one in $PATH. Throws NoProgram.
std::string program_file(const std::string& asked);

}  // namespace aurasim::client
