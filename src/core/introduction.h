#pragma once

#include <compare>

#include "core/ids.h"

namespace aurasim::core {

/// Two regions that are to listen to each other, a < b (core/introductions.h).
struct Introduction {
  RegionId a{};
  RegionId b{};

  auto operator<=>(const Introduction&) const = default;
};

}  // namespace aurasim::core
