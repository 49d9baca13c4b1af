// How orders spread: each node publishes once, in its next aura batch, what it has received. Batches are in step and in
// order, so after as many hops as two regions can be apart everybody knows, and nobody knows an order but not the one
// before.
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

  /// Our own: gives it the next number.
  const Order& announce(Order order);
  /// The run has been put back by an order, which all have received, and with it those before it: what was ordered
  /// later goes round once more, since what was under way is not taken any more.
  void put_back(std::uint64_t redo_sequence);
  /// From a neighbour's batch. Copies and anything out of sequence are left out.
  void receive(std::span<const Order> orders);

  std::uint64_t last() const { return last_; }
  /// Received or announced since the last take_news(), in sequence.
  std::vector<Order> take_news();
  std::span<const Order> news() const { return news_; }
  /// What the next batch has to publish, given out once.
  std::vector<Order> take_to_publish();

 private:
  void add(const Order& order);

  std::uint64_t last_;
  std::vector<Order> recent_;  ///< those that may not have gone round yet
  std::vector<Order> news_;
  std::vector<Order> to_publish_;
};

/// How many times a message is passed on from region to region, at most, until all have it.
int hops_across(const RegionMap& map, double neighbour_distance_m);

}  // namespace aurasim::core
