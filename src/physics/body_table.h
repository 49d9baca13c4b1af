// The bodies that one world holds, in ascending order of id.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/body_state.h"

namespace aurasim::physics {

struct HostedBody {
  core::BodyId id{};
  core::Epoch epoch = 0;
  core::PrototypeId prototype{};
  core::Step birth = 0;
  bool born = false;                   ///< true: the body is in Bullet's world
  bool is_guest = false;               ///< another region hosts it (physics/coupling.h)
  std::unique_ptr<btRigidBody> rigid;  ///< a MovingBody; its user index is its place in the table
  std::uint64_t hash = 0;              ///< its part of KeptHash::sum()

  core::BodyRecord record() const;
  core::BodyState state() const;
};

/// True if the user index is that of a static. User indices of statics are negative.
inline bool is_static(int user_index) { return user_index < 0; }

class BodyTable {
 public:
  std::span<HostedBody> bodies() { return bodies_; }
  std::span<const HostedBody> bodies() const { return bodies_; }
  HostedBody& operator[](std::size_t index) { return bodies_[index]; }
  const HostedBody& operator[](std::size_t index) const { return bodies_[index]; }
  std::size_t size() const { return bodies_.size(); }

  /// The body with this id, or null if it is not here. Valid until bodies come or go.
  HostedBody* find(core::BodyId id);
  const HostedBody* find(core::BodyId id) const;
  /// Like find(id), for a series of ascending ids: the search is short where few other bodies lie between two of them.
  /// `near` is 0 for the first call and is updated by each.
  HostedBody* find(core::BodyId id, std::size_t& near);
  const HostedBody* find(core::BodyId id, std::size_t& near) const;

  /// Adds bodies. Precondition: none of them is here yet.
  void insert(std::vector<HostedBody> arrivals);
  /// Destroys the bodies at these places, which ascend.
  void erase(std::span<const std::uint32_t> leaving);

 private:
  void number_from(std::size_t first);

  std::vector<HostedBody> bodies_;
};

}  // namespace aurasim::physics
