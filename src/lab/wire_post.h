// Puts the coding of real messages between the nodes of one process and their network in memory: what a node sends is
// encoded and serialised, what it takes is deserialised, checked and decoded, as with DDS but for the sockets. So the
// bytes can be counted, their coding is paid for, and a link can be narrow.
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
  std::uint64_t aura_bytes = 0;  ///< of one copy of each batch, however many regions listen
  std::uint64_t aura_updates = 0;
  std::uint64_t hand_offs = 0;
  std::uint64_t handed_over = 0;  ///< bodies
  std::uint64_t hand_off_bytes = 0;
  std::uint64_t link_bytes = 0;  ///< of all copies of everything
  std::uint64_t datagrams = 0;   ///< likewise, each of at most WirePost::kDatagramBytes
};

class WirePost {
 public:
  /// What RTPS over UDP sends in one piece between hosts (qos/hosts.xml: 1400, less its headers).
  static constexpr std::uint64_t kDatagramBytes = 1300;

  /// `network`, of so many regions, outlives this. `bandwidth_B_s`: of each node's link.
  WirePost(transport::MemoryNetwork& network, std::size_t regions,
           double bandwidth_B_s = std::numeric_limits<double>::infinity());
  ~WirePost();

  transport::Transport& endpoint(core::RegionId region);
  const Traffic& traffic(core::RegionId region) const;
  /// How far the region's link is behind what it was given to send. Seconds.
  double backlog_s(core::RegionId region) const;

 private:
  class Endpoint;
  using Bytes = std::vector<std::uint8_t>;
  /// Redo, state, and of hand-offs destination and number.
  using AuraKey = std::tuple<std::uint32_t, core::Step>;
  using HandOffKey = std::tuple<std::uint32_t, core::Step, core::RegionId, std::uint64_t>;
  /// Of one source; the last ones, since networks lose, repeat and delay envelopes.
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
