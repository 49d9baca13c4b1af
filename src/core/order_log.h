// Spreads orders: each node publishes every order that it receives once, in its next aura batch. Batches take effect in
// step and in sequence. So every node has an order after as many hops as two regions can be apart, and never without
// the one before it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/order.h"
#include "core/region_map.h"

namespace aurasim::core {

class OrderLog {
 public:
  explicit OrderLog(std::uint64_t last = 0) : last_(last) {}

  /// Numbers an order of our own and adds it. Returns the numbered order.
  const Order& announce(Order order);
  /// Call after a redo. All nodes have received the order of the redo and those before it. Later orders are published
  /// once more, because nodes no longer accept messages from before the redo.
  void put_back(std::uint64_t redo_sequence);
  /// Adds orders of a neighbour's batch. Copies and orders out of sequence are ignored.
  void receive(std::span<const Order> orders);

  std::uint64_t last() const { return last_; }
  /// Orders received or announced since the last take_news(), in sequence.
  std::vector<Order> take_news();
  std::span<const Order> news() const { return news_; }
  /// Orders that the next batch has to publish; each is returned once.
  std::vector<Order> take_to_publish();

 private:
  void add(const Order& order);

  std::uint64_t last_;
  std::vector<Order> recent_;  ///< newest orders, which may not have reached all nodes yet
  std::vector<Order> news_;
  std::vector<Order> to_publish_;
};

/// Largest number of hops between two regions: after so many passes from neighbour to neighbour all have a message.
int hops_across(const RegionMap& map, double neighbour_distance_m);

}  // namespace aurasim::core
