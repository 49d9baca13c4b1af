// The bodies that one world holds, in ascending order of id.
#pragma once

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
  bool born = false;                   ///< is in Bullet's world
  std::unique_ptr<btRigidBody> rigid;  ///< its user index is the place in the table

  core::BodyRecord record() const;
  core::BodyState state() const;
};

/// Statics have negative user indices.
inline bool is_static(int user_index) { return user_index < 0; }

class BodyTable {
 public:
  std::span<HostedBody> bodies() { return bodies_; }
  std::span<const HostedBody> bodies() const { return bodies_; }
  HostedBody& operator[](std::size_t index) { return bodies_[index]; }
  const HostedBody& operator[](std::size_t index) const { return bodies_[index]; }
  std::size_t size() const { return bodies_.size(); }

  /// Null if it is not here. Valid until bodies come or go.
  HostedBody* find(core::BodyId id);
  const HostedBody* find(core::BodyId id) const;
  /// Of several in ascending order: without a search where nobody is in between. `near`: where the one before would be,
  /// 0 for the first.
  HostedBody* find(core::BodyId id, std::size_t& near);
  const HostedBody* find(core::BodyId id, std::size_t& near) const;

  /// None of them may be here yet.
  void insert(std::vector<HostedBody> arrivals);
  /// Destroys the bodies of which `leaving`, as long as the table, says so.
  void erase(const std::vector<bool>& leaving);

 private:
  void number_from(std::size_t first);

  std::vector<HostedBody> bodies_;
};

}  // namespace aurasim::physics
