// Names of contact points by the features (corners, edges, faces, ends) of the two bodies on which they lie.
#pragma once

#include <cstdint>

namespace aurasim::physics {

/// The two features of which a contact point consists. The same two have the same number in every step, whichever body
/// has the feature that the other one is compared with.
struct ContactFeatures {
  std::int32_t of_a = -1, of_b = -1;

  bool operator==(const ContactFeatures&) const = default;
};

}  // namespace aurasim::physics
