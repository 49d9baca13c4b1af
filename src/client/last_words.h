// Reads the last output of a process on standard error, if that went into a file.
#pragma once

#include <string>

#include <sys/types.h>

namespace aurasim::client {

/// Returns at most `longest_B` bytes of the end of an open regular file, without its last line ends; empty for any
/// other file.
std::string last_words(int file, off_t longest_B);

}  // namespace aurasim::client
