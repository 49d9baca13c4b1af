// Spreads orders: each node publishes every order that it receives once, in its next aura batch after the order has
// arrived. So every node has an order after as many batches as two regions are hops apart, and never without the one
// before it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/order.h"

namespace aurasim::core {

class OrderLog {
 public:
  explicit OrderLog(std::uint64_t last = 0) : last_(last) {}

  /// Numbers an order of our own and adds it, in state `now`. Returns the numbered order.
  const Order& announce(Order order, Step now);
  /// Call after a redo in state `now`. Orders that may not have reached all nodes are published once more, because
  /// nodes no longer accept messages from before the redo. `round`: states within which an order reaches all nodes.
  void put_back(Step now, Step round);
  /// Adds orders of neighbours' batches, in state `now`. Copies and orders out of sequence are ignored.
  void receive(std::span<const Order> orders, Step now);

  std::uint64_t last() const { return last_; }
  /// Orders received or announced since the last take_news(), in sequence.
  std::vector<Order> take_news();
  std::span<const Order> news() const { return news_; }
  /// Orders that the next batch has to publish; each is returned once.
  std::vector<Order> take_to_publish();

 private:
  struct Recent {
    Order order;
    Step known_since = 0;
  };
  void add(const Order& order, Step now);

  std::uint64_t last_;
  std::vector<Recent> recent_;  ///< newest orders, which may not have reached all nodes yet
  std::vector<Order> news_;
  std::vector<Order> to_publish_;
};

}  // namespace aurasim::core
