// How deep bodies are in each other and in what does not move, by their real shapes.
#pragma once

#include <memory>
#include <set>
#include <span>
#include <utility>

#include "core/clearance.h"
#include "core/scene.h"

namespace aurasim::lab {

class Overlaps {
 public:
  /// Shapes are those that a SpeedScene may have; others are refused with std::invalid_argument when they are met.
  explicit Overlaps(const core::Scene& scene);

  /// Deepest that two bodies are in each other, m; 0 where none are. Those that a joint holds together do not count.
  double between_bodies(std::span<const core::BodyRecord> bodies) const;
  /// Deepest that a body is in a static, m; 0 where none is.
  double with_statics(std::span<const core::BodyRecord> bodies) const;
  /// All of it is: nothing brings it back.
  bool is_inside_a_static(const core::BodyRecord& body) const;

 private:
  struct Placed;

  double depth(const Placed& a, const Placed& b) const;
  double depth_along(const Placed& a, const Placed& b, const core::Vec3& n_W) const;
  const core::Shape& shape_of(core::PrototypeId prototype) const;
  Placed placed(const core::BodyRecord& body) const;
  Placed placed_static(std::size_t index) const;

  /// Each static is a prototype, too, after the bodies' own: that is how the query knows shapes.
  core::Scene scene_;
  std::size_t first_static_;
  std::unique_ptr<core::ClearanceQuery> clearance_;
  std::set<std::pair<core::BodyId, core::BodyId>> joined_;
};

}  // namespace aurasim::lab
