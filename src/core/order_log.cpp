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

int hops_across(const RegionMap& map, double neighbour_distance_m) {
  std::vector<std::vector<RegionId>> neighbours;
  for (std::uint32_t r = 0; r < map.size(); ++r) {
    neighbours.push_back(map.neighbours(RegionId{r}, neighbour_distance_m));
  }
  int most = 0;
  for (std::uint32_t start = 0; start < map.size(); ++start) {
    std::vector<int> hops(map.size(), -1);
    std::vector<RegionId> wave = {RegionId{start}};
    hops[start] = 0;
    for (int hop = 1; !wave.empty(); ++hop) {
      std::vector<RegionId> next;
      for (const RegionId region : wave) {
        for (const RegionId neighbour : neighbours[value_of(region)]) {
          if (hops[value_of(neighbour)] >= 0) continue;
          hops[value_of(neighbour)] = hop;
          next.push_back(neighbour);
        }
      }
      wave = std::move(next);
    }
    most = std::max(most, *std::max_element(hops.begin(), hops.end()));
  }
  return most;
}

}  // namespace aurasim::core
