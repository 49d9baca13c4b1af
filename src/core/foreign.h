// A node's knowledge, in one state, of the bodies that other nodes host.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/aura.h"
#include "core/messages.h"
#include "core/near_index.h"

namespace aurasim::core {

struct Foreign {
  BodyId id{};
  Path path;
  RegionId host{};
  bool ghost = false;
  bool born = true;  ///< it exists in the state that its aura describes
};

/// A block of bodies of one host that are near each other, and all slow or all fast. Neighbours are searched for the
/// whole block at once, because a body near one of them is mostly near all.
struct ForeignBlock {
  RegionId host{};
  std::span<const std::uint32_t> bodies;  ///< indices of ForeignBodies
  Vec3 lo, hi;                            ///< a box that holds their bounding spheres
};

class ForeignBodies {
 public:
  void clear() { bodies_.clear(); }
  /// Adds the body of `aura`, as seen in state `now`. `known` is the stamp of the last batch of its source.
  void add(const AuraRecord& aura, Step known, Step now, const Aura& rules);
  /// Call once after the last add() and before blocks().
  void build();

  std::size_t size() const { return bodies_.size(); }
  const Foreign& operator[](std::uint32_t i) const { return bodies_[i]; }
  std::span<const ForeignBlock> blocks() const { return blocks_; }
  /// The index of a body; nothing if no aura of it was added.
  std::optional<std::uint32_t> find(BodyId id) const;

 private:
  void add_block(std::span<const std::uint32_t> bodies);

  std::vector<Foreign> bodies_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;  ///< block and body
  std::vector<std::uint32_t> sorted_;
  std::vector<ForeignBlock> blocks_;
};

}  // namespace aurasim::core
