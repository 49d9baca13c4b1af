// What a process said last on standard error, where that went into a file.
#pragma once

#include <string>

#include <sys/types.h>

namespace aurasim::client {

/// At most so many bytes of the end of an open regular file, without its last line ends; nothing of anything else.
std::string last_words(int file, off_t longest_B);

}  // namespace aurasim::client
