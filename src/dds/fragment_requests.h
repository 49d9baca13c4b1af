// Rewrites Fast DDS's requests for retransmission so that they ask for the missing fragments only. Fast DDS here sees
// samples whole (datagram_guard.h), so by itself it would ask for all of a sample of which parts are here. The form:
// OMG DDSI-RTPS 2.2, sections 8.3.7.1 and 8.3.7.10.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dds/peer_book.h"

namespace aurasim::dds {

class FragmentRequests {
 public:
  /// Rewrites a datagram that this process is about to send. Returns the datagram to send instead; nothing: send it as
  /// it is.
  std::optional<std::vector<std::uint8_t>> put_into(std::span<const std::uint8_t> datagram, const PeerBook& peers);

 private:
  std::vector<std::uint8_t> instead_of(std::span<const std::uint8_t> ack_nack, const GuidPrefix& destination,
                                       const PeerBook& peers);

  std::uint32_t count_ = 0;  ///< counter of requests; writers ignore requests whose counter is not higher than the last
};

}  // namespace aurasim::dds
