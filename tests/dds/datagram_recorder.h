// Every datagram that this process sends or receives, of its kinds a few: what is in this file stands before the C
// library's sendto and recvfrom, so that no privilege is needed.
#pragma once

#include <cstdint>
#include <vector>

namespace aurasim::dds::testing {

using Bytes = std::vector<std::uint8_t>;

/// Copies of what was recorded so far: of each length and first submessage the latest few.
std::vector<Bytes> recorded_datagrams();

/// The calling thread's datagrams are not recorded from now on.
void stop_recording_this_thread();

}  // namespace aurasim::dds::testing
