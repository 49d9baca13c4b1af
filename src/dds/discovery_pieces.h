// Discovery that comes in fragments, put together to be checked before its last one goes on: in pieces nobody can.
// Pure; time is passed in.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "dds/datagram_findings.h"
#include "dds/token_bucket.h"

namespace aurasim::dds {

class DiscoveryPieces {
 public:
  using Time = TokenBucket::Time;

  /// `claim` is of kind kFragments and was found in `datagram`. The datagram that the writer would have sent had it
  /// been allowed to, once all of it is there.
  std::optional<std::vector<std::uint8_t>> add(const Claim& claim, std::span<const std::uint8_t> datagram, Time now);

 private:
  struct Sample {
    std::uint32_t fragment_B = 0, missing = 0;
    std::vector<bool> here;
    std::vector<std::uint8_t> bytes;
    Time since{0};
  };
  using Key = std::tuple<GuidPrefix, std::uint32_t, std::uint64_t>;  // participant, writer, sequence number

  void make_room(Time now);

  std::map<Key, Sample> samples_;
};

}  // namespace aurasim::dds
