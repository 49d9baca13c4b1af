// Which mover of the soft step is a body's: Bullet's companion id, for as long as a step takes.
#pragma once

#include <cstddef>
#include <cstdint>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

namespace aurasim::physics {

inline void set_mover(btCollisionObject& object, std::size_t mover) { object.setCompanionId(static_cast<int>(mover)); }

/// 0, which never moves, for statics and whoever is not awake.
inline std::uint32_t mover_of(const btCollisionObject& object) {
  return object.isStaticObject() ? 0U : static_cast<std::uint32_t>(object.getCompanionId());
}

}  // namespace aurasim::physics
