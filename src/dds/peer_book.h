// Remembers the participants that have announced themselves, and judges whether the claims of a datagram continue their
// earlier ones. From unknown participants Fast DDS gets only announcements. Pure; time is passed in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "dds/datagram_findings.h"
#include "dds/made_datagrams.h"
#include "dds/source_limits.h"

namespace aurasim::dds {

/// Missing fragments of a sample; fragments are numbered from 1.
struct MissingFragments {
  std::uint32_t base = 0;            ///< number of the first missing fragment
  std::uint32_t count = 0;           ///< number of bits, the first of which stands for `base`; at most 256
  std::vector<std::uint32_t> words;  ///< the bits, the first one highest
};

struct PeerLimits {
  std::size_t participants = 1024, participants_of_an_address = 256;  ///< RTPS's ports allow 120 on one host
  std::size_t endpoints_of_a_participant = 4096;
  std::uint64_t longest_jump = std::uint64_t{1} << 27;  ///< at 60 steps a second: 26 days
  /// Samples that a number may be ahead of its writer's highest known one.
  std::uint64_t farthest_ahead = std::uint64_t{1} << 14;
  double price_with_samples = 32;  ///< price factor of a jump over numbers among which there are samples
  std::uint64_t longest_gap = std::uint64_t{1} << 18;
  std::uint64_t free_jump = 1024, free_gap = 256;  ///< jumps and gaps up to these lengths are free
  std::size_t unfinished_B = std::size_t{192} << 20, unfinished_of_a_participant_B = std::size_t{96} << 20;
  /// Time after which an unfinished sample that gets no more fragments makes room: what was lost of it is not
  /// retransmitted.
  core::TokenBucket::Time until_given_up = std::chrono::seconds(2);
};

class PeerBook {
 public:
  using Time = core::TokenBucket::Time;

  explicit PeerBook(const PeerLimits& limits) : limits_(limits) {}

  /// Takes note that a datagram of `participant` has arrived.
  void hear(const GuidPrefix& participant, Time now);
  /// Returns why the claim is refused; nothing: it is accepted. `datagram` is the one that contains the claim.
  std::optional<Refusal> judge(const Claim& claim, std::span<const std::uint8_t> datagram, Source source,
                               SourceLimits& rates, Time now);
  /// Returns the whole sample as one datagram if `claim` was its last missing fragment, otherwise nothing. The sample
  /// is then dropped: further fragments of it begin a new one. `header` is of the datagram that contains the claim.
  std::optional<MadeDatagram> take_whole(const Claim& claim, std::span<const std::uint8_t> header);
  /// Returns which fragments of a sample are missing; nothing if none of them has arrived.
  std::optional<MissingFragments> missing_of(const WireGuid& writer, std::uint64_t number) const;

  std::size_t participants() const { return peers_.size(); }
  std::size_t unfinished_B() const { return unfinished_B_; }

 private:
  /// A sample that arrives in fragments.
  struct Sample {
    Claim first;             ///< the first claim that came; `reader` is the reader that all its fragments are for, or 0
    std::uint32_t missing;   ///< fragments
    std::vector<bool> here;  ///< which fragments have arrived
    MadeDatagram datagram;
    Time touched{0};  ///< when something was added to it

    explicit Sample(const Claim& claim);
    bool is_like(const Claim& claim) const;
    void take(const Claim& claim, std::span<const std::uint8_t> datagram, Time now);
  };
  using Samples = std::map<std::uint64_t, Sample>;
  struct Endpoint {
    bool announced = false;
    /// By reader (0: all): the highest first number of its heartbeats so far.
    std::map<std::uint32_t, std::uint64_t> first;
    std::uint64_t highest = 0;  ///< highest sequence number of its samples
    Samples samples;            ///< unfinished samples
  };
  using Endpoints = std::unordered_map<std::uint32_t, Endpoint>;
  struct Peer {
    std::uint32_t address = 0;
    Time heard{0}, lease{0};
    std::size_t unfinished_B = 0;
    Endpoints endpoints;
  };
  using Peers = std::unordered_map<GuidPrefix, Peer, PrefixHash>;

  std::optional<Refusal> take_participant(const Claim& claim, Source source, Time now);
  std::optional<Refusal> take_endpoint(Peer& peer, const Claim& claim);
  bool is_far_ahead(Endpoint& writer, const Claim& claim) const;
  std::optional<Refusal> take_heartbeat(Peer& peer, Endpoint& writer, const Claim& claim, Source source,
                                        SourceLimits& rates, Time now);
  std::optional<Refusal> take_gap(Peer& peer, Endpoint& writer, const Claim& claim, Source source, SourceLimits& rates,
                                  Time now);
  std::optional<Refusal> take_fragments(Peer& peer, Endpoint& writer, const Claim& claim,
                                        std::span<const std::uint8_t> datagram, Time now);
  std::optional<Refusal> take_stranger(const Claim& claim, std::span<const std::uint8_t> datagram, Time now);
  bool has_room_for(const Peer& peer, const Claim& claim) const;
  Endpoint* endpoint_of(Peer& peer, std::uint32_t entity);
  void forget_samples(Peer& peer, Endpoint& writer, std::uint32_t reader, std::uint64_t from, std::uint64_t to);
  Samples::iterator forget(Peer& peer, Endpoint& writer, Samples::iterator sample);
  void forget_the_silent(Time now);
  Endpoints::iterator erase(Peer& peer, Endpoints::iterator endpoint);
  void erase(Peers::iterator peer);

  PeerLimits limits_;
  Peers peers_;
  /// Announcements in fragments, by unknown participants.
  std::unordered_map<GuidPrefix, Sample, PrefixHash> strangers_;
  std::unordered_map<std::uint32_t, std::size_t> peers_of_address_;
  std::size_t unfinished_B_ = 0;
};

}  // namespace aurasim::dds
