// The statics that a world holds: those in cells (static_places.h) near its bodies, and those that are everywhere.
// Cells come before the contacts of what is near them are looked for, and go when nothing has been near them for a
// while. So what a world holds changes no bit (docs/design.md, "Statics by place").
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/ids.h"
#include "core/scene.h"
#include "physics/bounds.h"
#include "physics/broadphase.h"
#include "physics/dynamics_world.h"
#include "physics/shapes.h"
#include "physics/static_places.h"
#include "physics/timeline.h"

namespace aurasim::physics {

class HeldStatics final : public BringsStatics {
 public:
  /// All have to outlive this object, and the objects that it makes have to outlive `world`. Statics may be appended to
  /// the scene: show() takes them in, and they are always held.
  HeldStatics(const core::Scene& scene, std::shared_ptr<const ShapeSet> shapes,
              std::shared_ptr<const StaticPlaces> places, DynamicsWorld& world);

  /// Changes the world to the statics of state `n`. Returns the bounds of those that come or go.
  std::vector<Bounds> show(const Timeline& timeline, core::Step n);
  /// Number of statics that show() has taken in. Precondition of other functions: index < size().
  std::size_t size() const { return size_; }

  /// The object of a static; null if it is not held.
  btRigidBody* find(std::uint32_t index) const;
  /// True if the static is held, and exists in the state that is shown.
  bool is_in(std::uint32_t index) const;
  Bounds bounds(std::uint32_t index) const;

  /// Holds what is near `places`.
  void bring(std::span<const Bounds> places) override;
  /// Holds a static for now.
  void hold(std::uint32_t index);
  /// Holds a static from now on.
  btRigidBody& hold_always(std::uint32_t index);
  /// Looks at a few cells, and lets go of those that nothing is near. Call once a step.
  void drop_some();

  /// Number of statics that are held.
  std::size_t held_count() const { return held_.size(); }

  /// Bodies hold the cells to which they come nearer than this, m. No less than InnerEdges::kReach_m.
  static constexpr double kNear_m = 2;
  /// Cells go if no body is so near, m.
  static constexpr double kFar_m = 8;

 private:
  struct Held {
    std::unique_ptr<btRigidBody> object;
    std::uint32_t needed_by = 0;  ///< number of held cells that it is in, and one more if it is always held
    bool is_always = false;
    bool is_in = false;  ///< it is in the Bullet world
  };
  Held& need(std::uint32_t index);
  bool is_absent(std::uint32_t index) const;
  bool is_idle(std::uint32_t cell) const;
  void hold_cell(std::uint32_t cell);
  void drop_idle();
  void place(std::uint32_t index, Held& held);

  const core::Scene& scene_;
  std::shared_ptr<const ShapeSet> shapes_;
  std::shared_ptr<const StaticPlaces> places_;
  DynamicsWorld& world_;
  std::size_t size_ = 0;
  bool has_shown_ = false;
  std::unordered_map<std::uint32_t, Held> held_;  ///< by static
  std::vector<bool> is_held_;                     ///< by cell
  std::vector<std::uint32_t> held_cells_;
  std::size_t next_ = 0;               ///< of held_cells_, to be looked at by drop_some()
  std::vector<std::uint32_t> idle_;    ///< cells that nothing was near when drop_some() looked at them
  std::vector<std::uint32_t> absent_;  ///< statics that do not exist in the state that is shown; ascending
  std::size_t freed_ = 0;              ///< number of statics that went since memory was given back
};

}  // namespace aurasim::physics
