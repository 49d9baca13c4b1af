// Children of compounds.
#pragma once

#include <compare>

namespace aurasim::physics {

/// The children of two compounds that a manifold is between; -1 where a body is no compound.
struct Parts {
  int part0 = -1;
  int part1 = -1;

  auto operator<=>(const Parts&) const = default;
};

}  // namespace aurasim::physics
