#pragma once

#include <compare>
#include <optional>

#include "core/ids.h"

namespace aurasim::core {

/// Two regions that are to listen to each other, a < b (core/introductions.h).
struct Introduction {
  RegionId a{};
  RegionId b{};

  auto operator<=>(const Introduction&) const = default;
};

/// A region that another one listens to, and that listens to it.
struct Listened {
  RegionId region{};
  Step since = 0;
  std::optional<RegionId> introduced_by;  ///< none: it is near, or had bodies near ours at the start

  bool operator==(const Listened&) const = default;
};

}  // namespace aurasim::core
