// How joints hang together over the bodies that they bind.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/ids.h"
#include "core/joint.h"

namespace aurasim::core {

/// What a joint binds: bodies, by any number that tells them apart. Nothing: the world.
struct JointEnds {
  std::uint64_t a = 0;
  std::optional<std::uint64_t> b;
};

std::vector<JointEnds> ends_of(std::span<const JointSpec> joints);

class JointWays {
 public:
  /// By JointId.
  explicit JointWays(std::vector<JointEnds> joints);

  /// A shortest way over bodies, not over the world: the joints after `from` up to `to`, which is the last. Of several
  /// always the same. Empty: there is none, or the two are one.
  std::vector<JointId> way(JointId from, JointId to) const;

 private:
  std::vector<JointEnds> joints_;
  std::unordered_map<std::uint64_t, std::vector<JointId>> joints_of_;  ///< of a body, ascending; asked only
};

}  // namespace aurasim::core
