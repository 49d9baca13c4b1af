#include "core/box_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace aurasim::core {
namespace {

constexpr std::uint32_t kMostInLeaf = 4;

BoxTree::Box around(const BoxTree::Box& a, const BoxTree::Box& b) {
  return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

}  // namespace

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (!boxes_.empty()) build(0, static_cast<std::uint32_t>(boxes_.size()));
}

/// Builds a node by halving along the axis on which the boxes' middles are farthest apart. Equal middles are ordered by
/// their numbers, so that the tree is balanced there, too.
std::uint32_t BoxTree::build(std::uint32_t begin, std::uint32_t end) {
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({boxes_[order_[begin]], begin, end, 0});
  const auto middle = [this](std::uint32_t i) -> Vec3 { return 0.5 * (boxes_[i].low + boxes_[i].high); };
  Box middles{middle(order_[begin]), middle(order_[begin])};
  for (std::uint32_t place = begin; place < end; ++place) {
    const std::uint32_t i = order_[place];
    nodes_[at].box = around(nodes_[at].box, boxes_[i]);
    middles = around(middles, {middle(i), middle(i)});
  }
  if (end - begin <= kMostInLeaf) return at;
  Eigen::Index axis = 0;
  (middles.high - middles.low).maxCoeff(&axis);
  const std::uint32_t half = begin + (end - begin) / 2;
  std::nth_element(
      order_.begin() + begin, order_.begin() + half, order_.begin() + end,
      [&](std::uint32_t i, std::uint32_t j) { return std::pair(middle(i)[axis], i) < std::pair(middle(j)[axis], j); });
  nodes_[at].end = 0;
  build(begin, half);
  nodes_[at].second = build(half, end);
  return at;
}

}  // namespace aurasim::core
