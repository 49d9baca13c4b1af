// The graph of joints: finds the joints that connect two joints of a mechanism.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/ids.h"
#include "core/joint.h"

namespace aurasim::core {

/// The two bodies of a joint, by any numbers that differ for different bodies. `b` empty: the world.
struct JointEnds {
  std::uint64_t a = 0;
  std::optional<std::uint64_t> b;
};

std::vector<JointEnds> ends_of(std::span<const JointSpec> joints);

class JointWays {
 public:
  /// `joints` is indexed by JointId.
  explicit JointWays(std::vector<JointEnds> joints);

  /// A shortest chain of joints that leads from `from` to `to` over bodies, not over the world. The result leaves out
  /// `from` and ends with `to`. Of several shortest chains it is always the same one. Empty if there is none or `from`
  /// is `to`.
  std::vector<JointId> way(JointId from, JointId to) const;

 private:
  std::vector<JointEnds> joints_;
  /// by body, ascending; only looked up, never iterated
  std::unordered_map<std::uint64_t, std::vector<JointId>> joints_of_;
};

}  // namespace aurasim::core
