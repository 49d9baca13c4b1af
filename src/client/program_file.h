// Where the program `aurasim` is.
#pragma once

#include <string>

namespace aurasim::client {

/// `asked` if it is not empty; else $AURASIM_PROGRAM; else the one that this library was built or installed with: in
/// the nearest folder above it, or in its `bin`; else that of $PATH. Throws NoProgram.
std::string program_file(const std::string& asked);

}  // namespace aurasim::client
