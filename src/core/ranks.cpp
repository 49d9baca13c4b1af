#include "core/ranks.h"

#include <algorithm>
#include <limits>

#include "core/horizon.h"

namespace aurasim::core {
namespace {

/// Each step of weight means twice as many bodies. A lower node overtakes a higher one with four times as many bodies.
/// So two clusters of about the same size do not change ranks each time one of them grows.
constexpr int kMuchMore = 2;
/// A claim is given up after so many steps without a cluster of at least a quarter of the claimed size.
constexpr Step kPatience = 1200;
/// A node yields once a large cluster of another region has stayed for so many steps.
constexpr Step kHospitality = 10;
/// After that cluster has gone, a node that has yielded waits until its new host has claimed, at most so many steps.
constexpr Step kHumility = 120;

std::size_t least_bodies(std::uint8_t weight) {
  return RankClaimer::kLeastBodies << (weight - RankClaim::kNothing - 1);
}

std::uint8_t weight_of(std::size_t bodies) {
  std::uint8_t weight = RankClaim::kNothing;
  while (weight < 20 && bodies >= least_bodies(static_cast<std::uint8_t>(weight + 1))) ++weight;
  return weight;
}

/// A hash that is the same on every machine and gives no two inputs one value (splitmix64, Steele et al. 2014).
std::uint64_t scrambled(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

}  // namespace

void Ranks::begin(Step now, RegionId self, const RankClaims& claims) {
  now_ = now;
  nodes_.assign(1, {self, claims});
}

const Ranks::Node& Ranks::node(RegionId region) const {
  const auto found =
      std::find_if(nodes_.begin(), nodes_.end(), [region](const Node& node) { return node.region == region; });
  return found != nodes_.end() ? *found : nodes_.front();
}

const RankClaim& Ranks::claim(const Node& node, Step n) const {
  return n >= node.claims.next.stamp + horizon::rank_notice(lookahead_) ? node.claims.next : node.claims.held;
}

/// True if node `a` ranks higher than node `b` in state n. With equal weights the older claim ranks higher, so that two
/// clusters of one size do not change ranks all the time.
bool Ranks::outranks(const Node& a, const Node& b, Step n) const {
  const RankClaim& of_a = claim(a, n);
  const RankClaim& of_b = claim(b, n);
  if (of_a.weight != of_b.weight) return of_a.weight > of_b.weight;
  if (of_a.weight > RankClaim::kNothing && of_a.stamp != of_b.stamp) return of_a.stamp < of_b.stamp;
  return a.region < b.region;
}

bool Ranks::pulls(RegionId host) const {
  const RegionId self = nodes_.front().region;
  return outranks(host, self, now_) && outranks(host, self, now_ - horizon::after_ranks_change(lookahead_));
}

/// Does the node's rank among the others change in state `from`?
bool Ranks::changes(const Node& node, Step from) const {
  return std::any_of(nodes_.begin(), nodes_.end(),
                     [&](const Node& other) { return outranks(node, other, from - 1) != outranks(node, other, from); });
}

bool Ranks::changing() const {
  return std::any_of(nodes_.begin(), nodes_.end(), [this](const Node& node) {
    const Step from = node.claims.next.stamp + horizon::rank_notice(lookahead_);
    return now_ >= from - horizon::before_ranks_change(lookahead_) &&
           now_ <= from + horizon::after_ranks_change(lookahead_) && changes(node, from);
  });
}

bool Ranks::on_top() const {
  constexpr Step kAllCount = std::numeric_limits<Step>::max();
  return std::all_of(nodes_.begin() + 1, nodes_.end(),
                     [this](const Node& other) { return outranks(nodes_.front(), other, kAllCount); });
}

std::uint8_t Ranks::most_of_others() const {
  std::uint8_t most = 0;
  for (auto other = nodes_.begin() + 1; other != nodes_.end(); ++other)
    most = std::max(most, other->claims.next.weight);
  return most;
}

std::uint8_t RankClaimer::wanted_weight(Step now, const LargeClusters& large, const Ranks& ranks) {
  if (shuffle_steps_ > 0) {
    const auto turn = static_cast<std::uint64_t>(now / shuffle_steps_);
    const auto run = static_cast<std::uint64_t>(shuffle_steps_);
    if (turn == 0) return RankClaim::kNothing;
    return static_cast<std::uint8_t>(scrambled((run << 40) + (turn << 16) + value_of(self_)) % 4);
  }
  if (yields(now, large.guests, ranks)) return RankClaim::kYields;
  const std::uint8_t weight = weight_of(large.near);
  const std::uint8_t claimed = std::max(claims_.next.weight, RankClaim::kNothing);
  const bool claims = claimed > RankClaim::kNothing;
  if (claims && 4 * large.near >= least_bodies(claimed)) last_large_ = now;
  if (weight <= claimed) return claims && now - last_large_ > kPatience ? weight : claimed;
  const std::uint8_t others = ranks.most_of_others();
  const bool first = others <= RankClaim::kNothing || ranks.on_top();
  return first || weight >= others + kMuchMore ? weight : claimed;
}

/// Should our node yield to the home of a large foreign cluster? Never where K > 1: the wider look while ranks change
/// then joins that cluster with the one at home, and all of it goes to the other node, where most of it is foreign
/// again (docs/decisions/0016-ranks.md).
bool RankClaimer::yields(Step now, std::size_t guests, const Ranks& ranks) {
  const bool has_guests = lookahead_ == 1 && guests >= kLeastBodies;
  (has_guests ? last_guests_ : alone_) = now;
  if (claims_.next.weight != RankClaim::kYields) return now - alone_ >= kHospitality;
  return has_guests || (now - last_guests_ <= kHumility && ranks.most_of_others() <= RankClaim::kNothing);
}

void RankClaimer::reconsider(Step now, const LargeClusters& large, const Ranks& ranks) {
  const std::uint8_t weight = wanted_weight(now, large, ranks);
  if (weight == claims_.next.weight) return;
  // One change at a time, because every node remembers only two claims.
  if (claimed_ && now < claims_.next.stamp + horizon::between_claims(lookahead_)) return;
  claims_ = {claims_.next, {weight, now}};
  claimed_ = true;
  last_large_ = now;
}

}  // namespace aurasim::core
