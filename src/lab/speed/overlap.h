// Measures how deep bodies overlap each other and statics, by their real shapes.
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
  /// Supports the shapes that a SpeedScene may have. The measurements throw std::invalid_argument for others.
  explicit Overlaps(const core::Scene& scene);

  /// Deepest overlap of two bodies, metres; 0 if there is none. Bodies that a joint connects do not count.
  double between_bodies(std::span<const core::BodyRecord> bodies) const;
  /// Deepest overlap of a body with a static, metres; 0 if there is none.
  double with_statics(std::span<const core::BodyRecord> bodies) const;
  /// True if the whole body is inside a static, so that no contact can push it out.
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
