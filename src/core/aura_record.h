#pragma once

#include "core/aura.h"
#include "core/aura_precision.h"
#include "core/messages.h"

namespace aurasim::core {

/// The aura of a body in state `stamp`. The caller sets speed_m_s, the top speed that the body may come to have.
inline AuraRecord aura_record(const BodyState& body, RegionId host, Step stamp) {
  AuraRecord aura;
  aura.id = body.id;
  aura.epoch = body.epoch;
  aura.host = host;
  aura.prototype = body.prototype;
  aura.flags = body.awake ? 0 : kAuraAsleep;
  aura.stamp = stamp;
  aura.birth = body.birth;
  aura.pose = body.pose;
  aura.v_WB = body.v_WB;
  aura.w_WB = body.w_WB;
  return aura;
}

/// The path of the body of `aura` from the aura's own state on.
inline Path path_of(const AuraRecord& aura, const ClearanceQuery& clearance) {
  Path path = path_from(aura, (aura.flags & kAuraAsleep) == 0, aura.stamp, clearance);
  path.speed_m_s = aura.speed_m_s;
  path.blur_m = rounded_within_m(path.radius_m);
  return path;
}

}  // namespace aurasim::core
