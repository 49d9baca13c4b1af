// Remembers the participants that have announced themselves, and judges whether the claims of a datagram continue their
// earlier ones. From unknown participants Fast DDS gets only announcements. Pure; time is passed in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>

#include "rtps/datagram_findings.h"
#include "rtps/source_limits.h"

namespace aurasim::rtps {

struct PeerLimits {
  std::size_t participants = 1024, participants_of_an_address = 256;  ///< RTPS's ports allow 120 on one host
  std::size_t endpoints_of_a_participant = 4096;
  std::uint64_t longest_jump = std::uint64_t{1} << 27;  ///< at 60 steps a second: 26 days
  /// Samples that a number may be ahead of its writer's highest known one.
  std::uint64_t farthest_ahead = std::uint64_t{1} << 14;
  double price_with_samples = 32;  ///< price factor of a jump over numbers among which there are samples
  std::uint64_t longest_gap = std::uint64_t{1} << 18;
  std::uint64_t free_jump = 1024, free_gap = 256;  ///< jumps and gaps up to these lengths are free
};

class PeerBook {
 public:
  using Time = core::TokenBucket::Time;

  explicit PeerBook(const PeerLimits& limits) : limits_(limits) {}

  /// Takes note that a datagram of `participant` has arrived.
  void hear(const GuidPrefix& participant, Time now);
  /// Returns why the claim is refused; nothing: it is accepted.
  std::optional<Refusal> judge(const Claim& claim, Source source, SourceLimits& rates, Time now);
  /// True when the participant has announced itself and is not forgotten.
  bool knows(const GuidPrefix& participant) const { return peers_.contains(participant); }
  std::size_t participants() const { return peers_.size(); }

 private:
  struct Endpoint {
    bool announced = false;
    /// By reader (0: all): the highest first number of its heartbeats so far.
    std::map<std::uint32_t, std::uint64_t> first;
    std::uint64_t highest = 0;  ///< highest sequence number of its samples
  };
  using Endpoints = std::unordered_map<std::uint32_t, Endpoint>;
  struct Peer {
    std::uint32_t address = 0;
    Time heard{0}, lease{0};
    Endpoints endpoints;
  };
  using Peers = std::unordered_map<GuidPrefix, Peer, PrefixHash>;

  std::optional<Refusal> take_participant(const Claim& claim, Source source, Time now);
  std::optional<Refusal> take_endpoint(Peer& peer, const Claim& claim);
  bool is_far_ahead(Endpoint& writer, const Claim& claim) const;
  std::optional<Refusal> take_heartbeat(Endpoint& writer, const Claim& claim, Source source, SourceLimits& rates,
                                        Time now);
  std::optional<Refusal> take_gap(const Claim& claim, Source source, SourceLimits& rates, Time now) const;
  Endpoint* endpoint_of(Peer& peer, std::uint32_t entity);
  void forget_the_silent(Time now);
  void erase(Peers::iterator peer);

  PeerLimits limits_;
  Peers peers_;
  std::unordered_map<std::uint32_t, std::size_t> peers_of_address_;
};

}  // namespace aurasim::rtps
