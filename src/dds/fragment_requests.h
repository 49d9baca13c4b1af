// Fast DDS here sees samples whole (datagram_guard.h), so of a sample of which parts are here it asks for all. It is to
// ask for the fragments that are missing. The form: OMG DDSI-RTPS 2.2, sections 8.3.7.1 and 8.3.7.10.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dds/peer_book.h"

namespace aurasim::dds {

class FragmentRequests {
 public:
  /// A datagram that this process is about to send, as it is to be sent; nothing: as it is.
  std::optional<std::vector<std::uint8_t>> put_into(std::span<const std::uint8_t> datagram, const PeerBook& peers);

 private:
  std::vector<std::uint8_t> instead_of(std::span<const std::uint8_t> ack_nack, const GuidPrefix& destination,
                                       const PeerBook& peers);

  std::uint32_t count_ = 0;  ///< of requests; writers pass over those that are not newer
};

}  // namespace aurasim::dds
