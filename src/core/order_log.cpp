#include "core/order_log.h"

#include <algorithm>
#include <utility>

namespace aurasim::core {

namespace {

/// More orders than clients send within a second or two, in which an order reaches all nodes.
constexpr std::size_t kMostRecent = 4096;

}  // namespace

void OrderLog::add(const Order& order, Step now) {
  last_ = order.sequence;
  news_.push_back(order);
  to_publish_.push_back(order);
  recent_.push_back({order, now});
  if (recent_.size() > kMostRecent) recent_.erase(recent_.begin());
}

/// An order that came here in state s has reached every node by that one's state s + round, and other nodes are at most
/// `round` states behind this one.
void OrderLog::put_back(Step now, Step round) {
  std::erase_if(recent_, [=](const Recent& recent) { return recent.known_since < now - 2 * round; });
  to_publish_.clear();
  for (const Recent& recent : recent_) to_publish_.push_back(recent.order);
}

const Order& OrderLog::announce(Order order, Step now) {
  order.sequence = last_ + 1;
  add(order, now);
  return news_.back();
}

void OrderLog::receive(std::span<const Order> orders, Step now) {
  for (const Order& order : orders) {
    if (order.sequence == last_ + 1) add(order, now);
  }
}

std::vector<Order> OrderLog::take_news() { return std::exchange(news_, {}); }

std::vector<Order> OrderLog::take_to_publish() { return std::exchange(to_publish_, {}); }

}  // namespace aurasim::core
