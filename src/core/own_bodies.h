// Our bodies of a state, as interest matching needs them: their paths, and which of them are near the border of our
// region. Where a snapshot names what has changed, only that is looked at.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/used_room.h"
#include "core/vicinity.h"

namespace aurasim::core {

class OwnBodies {
 public:
  /// Keeps references to `aura` and `vicinity`.
  OwnBodies(const Aura& aura, const Vicinity& vicinity) : aura_(aura), vicinity_(vicinity) {}

  /// Takes in the next state.
  void look(const Snapshot& snapshot);
  /// True if the last state has the bodies of the one before, and changed() names all that differ.
  bool goes_on() const { return goes_on_; }
  std::span<const std::uint32_t> changed() const { return changed_; }
  /// Paths in the state before: of the bodies of changed() if goes_on(), else of those of ids_before().
  std::span<const Path> paths_before() const { return paths_before_; }
  std::span<const BodyId> ids_before() const { return ids_before_; }

  std::size_t size() const { return paths_.size(); }
  std::span<const Path> paths() const { return paths_; }
  const Path& path(std::uint32_t i) const { return paths_[i]; }
  BodyId id(std::uint32_t i) const { return ids_[i]; }
  std::optional<std::uint32_t> find(BodyId id) const;
  double top_speed() const { return top_speed_; }
  double top_radius() const { return top_radius_; }

  /// Finds the bodies that are not farther than `distance_m` inside of our region, or outside of it.
  void find_close(double distance_m);
  /// These bodies, and perhaps some others; ascending.
  std::span<const std::uint32_t> close() const { return close_; }

 private:
  void measure(std::uint32_t i, const BodyState& body, Step now);
  bool is_close(std::uint32_t i) const {
    return !vicinity_.deep_inside(paths_[i].pose.p_WB, close_m_ + paths_[i].radius_m);
  }

  const Aura& aura_;
  const Vicinity& vicinity_;
  std::uint64_t seen_ = 0;  ///< number of the last snapshot
  UsedRoom used_room_;      ///< of changed_ and of what was before
  bool goes_on_ = false;
  std::vector<std::uint32_t> changed_;
  std::vector<BodyId> ids_, ids_before_;  ///< ascending
  std::vector<Path> paths_, paths_before_;
  double resting_speed_ = 0;  ///< the fastest that a body which is not in changed_ says that it may be, m/s
  double top_speed_ = 0;
  double top_radius_ = 0;
  double close_m_ = 0;  ///< distance for which close_ was found
  std::vector<std::uint32_t> close_;
};

}  // namespace aurasim::core
