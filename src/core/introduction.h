#pragma once

#include <compare>
#include <optional>

#include "core/ids.h"

namespace aurasim::core {

/// Two regions that are to listen to each other, a < b (core/introductions.h). Where regions are coupled: two that are
/// to exchange parcels in the next step (core/seam_partners.h).
struct Introduction {
  RegionId a{};
  RegionId b{};

  auto operator<=>(const Introduction&) const = default;
};

/// A region that listens to ours and that ours listens to, from state `since` on.
struct Listened {
  RegionId region{};
  Step since = 0;
  std::optional<RegionId> introduced_by;  ///< none: it is near ours, or had bodies near ours at the start

  bool operator==(const Listened&) const = default;
};

}  // namespace aurasim::core
