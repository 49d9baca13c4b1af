// The sum of the state hashes of a table's bodies (state_hash.h), renewed only for those that have changed.
#pragma once

#include <array>
#include <cstdint>

#include "physics/changed_bodies.h"

namespace aurasim::physics {

class KeptHash {
 public:
  /// Sum over the born bodies of the table, modulo 2^64. Takes in the changes since the last call.
  std::uint64_t sum(BodyTable& table, ChangedBodies& changed);
  /// Call before a body leaves the table.
  void drop(const HostedBody& body) { sum_ -= body.hash; }

 private:
  static constexpr std::size_t kAtOnce = 16;

  void renew();

  std::uint64_t sum_ = 0;
  std::array<core::BodyRecord, kAtOnce> records_;
  std::array<HostedBody*, kAtOnce> bodies_{};
  std::size_t count_ = 0;  ///< entries of records_ and bodies_ that wait for renew()
};

}  // namespace aurasim::physics
