// Finds which of many boxes at rest meet a given box. A balanced tree: built in O(n log n), the first hit found in
// O(log n). That holds even where all boxes lie in one place, where a grid would compare every pair.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/body_state.h"

namespace aurasim::core {

class BoxTree {
 public:
  struct Box {
    Vec3 low = Vec3::Zero();
    Vec3 high = Vec3::Zero();

    bool meets(const Box& other) const {
      return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
    }
  };

  /// Later calls name a box by its index in `boxes`.
  explicit BoxTree(std::vector<Box> boxes);

  const Box& operator[](std::uint32_t i) const { return boxes_[i]; }

  /// Calls `found(i)` for boxes that meet `box`, until it returns true. The sequence of calls follows from the boxes
  /// alone. Returns whether `found` has returned true.
  template <class Found>
  bool any(const Box& box, Found&& found) const {
    return !nodes_.empty() && any_below(0, box, found);
  }

 private:
  struct Node {
    Box box;                   ///< holds all boxes below this node
    std::uint32_t begin = 0;   ///< leaf: its boxes are order_[begin, end)
    std::uint32_t end = 0;     ///< 0: an inner node
    std::uint32_t second = 0;  ///< the second child; the first is behind its parent
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  template <class Found>
  bool any_below(std::uint32_t at, const Box& box, Found& found) const {
    const Node& node = nodes_[at];
    if (!node.box.meets(box)) return false;
    if (node.end == 0) return any_below(at + 1, box, found) || any_below(node.second, box, found);
    for (std::uint32_t place = node.begin; place < node.end; ++place) {
      const std::uint32_t i = order_[place];
      if (boxes_[i].meets(box) && found(i)) return true;
    }
    return false;
  }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace aurasim::core
