// Puts the coding of real messages between the nodes of one process and their network in memory: what a node sends is
// encoded and serialised, what it takes is deserialised, checked and decoded, as with DDS but for the sockets. What is
// refused arrives as a refusal. So bytes can be counted, the cost of coding is included, and links can have a limited
// bandwidth.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "core/messages.h"
#include "transport/memory_transport.h"

namespace aurasim::lab {

/// What one node has sent since the start. Bytes are payloads of RTPS DATA, without RTPS, UDP and IP headers.
struct Traffic {
  std::uint64_t aura_bytes = 0;  ///< bytes of one copy of each batch, however many regions receive it
  std::uint64_t aura_updates = 0;
  std::uint64_t hand_offs = 0;
  std::uint64_t handed_over = 0;  ///< bodies
  std::uint64_t hand_off_bytes = 0;
  std::uint64_t link_bytes = 0;  ///< bytes of all copies of all messages
  std::uint64_t messages = 0;    ///< copies of all messages
  std::uint64_t datagrams = 0;   ///< datagrams of all copies, each of at most WirePost::kDatagramBytes
};

class WirePost {
 public:
  /// Largest payload that RTPS over UDP sends in one datagram between hosts (qos/hosts.xml: 1400, less its headers).
  static constexpr std::uint64_t kDatagramBytes = 1300;

  /// `network` has `regions` regions and must outlive this object. `bandwidth_B_s`: bandwidth of each node's link,
  /// bytes per second. `block_m`: messages::Expected::block_m.
  WirePost(transport::MemoryNetwork& network, std::size_t regions,
           double bandwidth_B_s = std::numeric_limits<double>::infinity(), double block_m = 0);
  ~WirePost();

  transport::Transport& endpoint(core::RegionId region);
  const Traffic& traffic(core::RegionId region) const;
  /// Seconds until the region's link has sent what it was given.
  double backlog_s(core::RegionId region) const;

 private:
  class Endpoint;
  using Bytes = std::vector<std::uint8_t>;
  /// Keys of messages: redo and state, for batches also the word, and for hand-offs destination and number.
  using AuraKey = std::tuple<std::uint32_t, core::Step, std::uint32_t>;
  using HandOffKey = std::tuple<std::uint32_t, core::Step, core::RegionId, std::uint64_t>;
  /// The last messages of one source. They are kept because the network may lose, repeat and delay envelopes.
  struct Kept {
    std::map<AuraKey, Bytes> auras;
    std::map<HandOffKey, Bytes> hand_offs;
  };

  transport::MemoryNetwork& network_;
  double bandwidth_B_s_;
  std::vector<std::unique_ptr<Endpoint>> endpoints_;
  std::vector<Kept> kept_;  ///< by source
};

}  // namespace aurasim::lab
