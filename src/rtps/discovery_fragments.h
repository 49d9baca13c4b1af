// Puts together the samples of discovery and handshakes that come in fragments, so that they are checked like any
// other. Messages of a run never come in fragments. Pure; time is passed in.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/token_bucket.h"
#include "rtps/datagram_findings.h"
#include "rtps/made_datagrams.h"

namespace aurasim::rtps {

struct FragmentLimits {
  std::size_t all_B = std::size_t{64} << 20;
  std::size_t of_a_participant = 1024;  ///< unfinished samples; one more drops the first
  std::size_t of_strangers = 64;        ///< unfinished announcements of unknown participants, likewise
  /// Time after which an unfinished sample that gets no more fragments makes room for others.
  core::TokenBucket::Time until_given_up = std::chrono::seconds(2);
};

class DiscoveryFragments {
 public:
  using Time = core::TokenBucket::Time;

  explicit DiscoveryFragments(const FragmentLimits& limits = {}) : limits_(limits) {}

  /// Takes in the fragments of a claim. Returns why they are refused; nothing: they are accepted. Memory for the whole
  /// sample is allocated at its first fragment, and the sizes are those that the first one names. `is_known`: the
  /// participant has announced itself. `datagram` is the one that contains the claim.
  std::optional<Refusal> add(const Claim& claim, bool is_known, std::span<const std::uint8_t> datagram, Time now);
  /// Returns the whole sample as one datagram if no fragment of it is missing any more, and drops it.
  std::optional<MadeDatagram> take_whole(const Claim& claim, bool is_known, std::span<const std::uint8_t> header);

 private:
  struct Key {
    GuidPrefix of{};  ///< the participant; zeros: participants that are not known
    GuidPrefix prefix{};
    std::uint32_t entity = 0;
    std::uint64_t number = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Sample {
    Claim first;             ///< the first claim that came; `reader` is the reader that all its fragments are for, or 0
    std::uint32_t missing;   ///< fragments
    std::vector<bool> here;  ///< which fragments have arrived
    MadeDatagram datagram;
    Time touched{0};  ///< when something was added to it

    explicit Sample(const Claim& claim);
    void take(const Claim& claim, std::span<const std::uint8_t> datagram, Time now);
  };
  using Samples = std::map<Key, Sample>;

  static Key key_of(const Claim& claim, bool is_known);
  bool make_room(const Key& key, const Claim& claim, Time now);
  Samples::iterator erase(Samples::iterator sample);

  FragmentLimits limits_;
  Samples samples_;
  std::map<GuidPrefix, std::size_t> counts_;  ///< samples, by Key::of
  std::size_t bytes_ = 0;
};

}  // namespace aurasim::rtps
