#include "core/interest.h"

#include <algorithm>

namespace aurasim::core {

bool Interest::wants(BodyId id, PrototypeId prototype, const Vec3& p_WB) const {
  return all || std::ranges::binary_search(bodies, id) || std::ranges::binary_search(prototypes, prototype) ||
         std::ranges::any_of(boxes, [&](const WorldBox& box) { return box.holds(p_WB); });
}

}  // namespace aurasim::core
