// The bodies of a soft step, as its kernels compute them. Bodies that touch nothing are moved on their parabola at
// once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <LinearMath/btQuaternion.h>
#include <LinearMath/btVector3.h>

#include "physics/soft/lanes.h"
#include "physics/soft/patches.h"
#include "physics/soft/seams.h"
#include "physics/soft/threads.h"
#include "physics/soft/touch.h"

class btRigidBody;
class btTypedConstraint;

namespace aurasim::physics {

class SoftShared;
struct Settings;

/// The bodies of a step, and the touches and joints that hold them.
struct SoftBodies {
  std::span<btRigidBody* const> awake;
  std::span<btRigidBody* const> moving_statics;  ///< they push bodies, and their own poses are not changed
  std::span<const SoftTouch> touches;
  std::span<btTypedConstraint* const> joints;
  btVector3 gravity;             ///< m/s^2
  SoftShared* shared = nullptr;  ///< the contacts with bodies of other regions; null if there are none
};

/// A mover is the state of a body within the step. Movers are numbered: 0 never moves (statics that stand, and
/// sleepers), moving statics are negative, bodies follow from 1 on.
class SoftMovers {
 public:
  SoftMovers(const Settings& settings, soft::Team& team);

  /// Makes the movers of all bodies that touch something or have a joint. Moves the others.
  void take_in(const SoftBodies& bodies);
  /// Number of movers from 0 on, in whole rows.
  std::size_t size() const { return held_.size(); }
  /// The movers; moving statics lie before them.
  soft::Mover* data() { return movers_; }
  const std::vector<SoftInertia>& inertias() const { return inertias_; }
  /// Number of the mover of a body or static.
  std::int32_t number_of(int user_index) const {
    const auto of_static = static_cast<std::size_t>(-1 - user_index);
    if (user_index < 0) return of_static < mover_of_static_.size() ? mover_of_static_[of_static] : 0;
    return is_held(user_index) ? std::max(0, mover_at_[static_cast<std::size_t>(user_index)]) : 0;
  }
  /// Contacts with statics have a phase of their own, whatever this returns for them.
  SoftPhase phase_of(std::int32_t a, std::int32_t b) const;
  std::size_t group_of(SoftPhase phase, std::int32_t a) const {
    return physics::group_of(phase, places_[static_cast<std::size_t>(std::max(0, a))]);
  }
  /// Centre of a body at the start of the step, m.
  const btVector3& start_of(std::int32_t mover) const { return bodies_[static_cast<std::size_t>(mover)].p; }

  // In a substep. Called by each worker for its share, which is the same in both.
  /// Adds what gravity and forces do to velocities.
  void push(const soft::Worker& worker);
  /// Moves and turns.
  void move(const soft::Worker& worker);

  /// Writes poses and velocities into the bodies.
  void show();

 private:
  static constexpr std::int32_t kHeld = -1;

  /// A body at the start of the step.
  struct Body {
    btVector3 p{0, 0, 0};
    btQuaternion q{0, 0, 0, 1};
    btVector3 v{0, 0, 0}, w{0, 0, 0};
  };
  /// A mover, and what its velocities gain in each substep.
  struct PushedMover {
    std::size_t mover;
    soft::Real v[3], w[3];
  };
  struct alignas(64) PushedMovers {
    std::vector<PushedMover> all;  ///< ascending mover
  };
  struct Held {
    btRigidBody* body;
    std::size_t group;
  };

  bool is_held(int user_index) const {
    const auto place = static_cast<std::size_t>(user_index);
    return user_index >= 0 && place < mover_at_.size() && mover_at_[place] != 0;
  }
  void hold(int user_index);
  void order_by_block();
  void make_room(std::size_t moving_statics);
  void take_in_statics(std::span<btRigidBody* const> moving_statics);
  void take_in_row(std::size_t row);
  void take_in(std::size_t i);
  void take_in_pushes(std::size_t first, std::size_t last, std::vector<PushedMover>& of_thread) const;
  void prefetch_after(std::size_t i) const;
  void show(std::size_t i) const;

  soft::Team& team_;
  btScalar step_s_;
  soft::Real h_s_;  ///< length of a substep
  double block_m_;
  btVector3 gravity_{0, 0, 0};
  /// by user index; 0: touches nothing; kHeld: touches something and has no mover yet
  std::vector<std::int32_t> mover_at_;
  std::vector<std::int32_t> mover_of_static_;  ///< by -1 - user index; 0: it stands
  std::vector<btRigidBody*> flying_;
  std::vector<btRigidBody*> held_;  ///< bodies by mover; block by block, if there are several threads
  std::vector<Held> unordered_;
  /// in whole rows: an empty row and those of moving statics, if any; then those of bodies
  std::vector<soft::Mover> all_movers_;
  soft::Mover* movers_ = nullptr;
  std::vector<soft::Tumblers> steady_;    ///< by row of moving statics
  std::vector<soft::Tumblers> tumblers_;  ///< by row of bodies
  std::vector<SoftInertia> inertias_;     ///< by mover, as the following vectors
  std::vector<Body> bodies_;
  std::vector<SoftPlace> places_;
  std::vector<PushedMovers> pushes_;  ///< by thread
};

}  // namespace aurasim::physics
