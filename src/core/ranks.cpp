#include "core/ranks.h"

#include <algorithm>

namespace aurasim::core {
namespace {

/// A cluster of so many bodies counts, and every four times as many count more.
constexpr std::size_t kFirstLarge = 256;
/// So many steps without a cluster of nearly that size, and the claim is given up.
constexpr Step kPatience = 240;

std::size_t least_bodies(std::uint8_t weight) { return kFirstLarge << (2 * (weight - 1)); }

std::uint8_t weight_of(std::size_t bodies) {
  std::uint8_t weight = 0;
  while (weight < 20 && bodies >= least_bodies(static_cast<std::uint8_t>(weight + 1))) ++weight;
  return weight;
}

/// The same on every machine; no two runs, steps and regions alike (splitmix64, Steele et al. 2014).
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
  return n >= node.claims.next.stamp + rank_notice(lookahead_) ? node.claims.next : node.claims.held;
}

/// Of equal weights the older claim is higher: two heaps of one size do not change places all the time.
bool Ranks::outranks(const Node& a, const Node& b, Step n) const {
  const RankClaim& of_a = claim(a, n);
  const RankClaim& of_b = claim(b, n);
  if (of_a.weight != of_b.weight) return of_a.weight > of_b.weight;
  if (of_a.weight > 0 && of_a.stamp != of_b.stamp) return of_a.stamp < of_b.stamp;
  return a.region < b.region;
}

bool Ranks::pulls(RegionId host) const {
  const RegionId self = nodes_.front().region;
  return outranks(host, self, now_) && outranks(host, self, now_ - (lookahead_ - 1));
}

/// Does the node's rank among the others change in state `from`?
bool Ranks::changes(const Node& node, Step from) const {
  return std::any_of(nodes_.begin(), nodes_.end(),
                     [&](const Node& other) { return outranks(node, other, from - 1) != outranks(node, other, from); });
}

bool Ranks::changing() const {
  return std::any_of(nodes_.begin(), nodes_.end(), [this](const Node& node) {
    const Step from = node.claims.next.stamp + rank_notice(lookahead_);
    // Three pulls in a row, the longest chain (docs/decisions/0006-hops.md), and all of it has to be announced before.
    return now_ >= from - 4 * lookahead_ - 1 && now_ < from + lookahead_ && changes(node, from);
  });
}

std::uint8_t RankClaimer::wanted_weight(Step now, std::size_t bodies) {
  if (shuffle_steps_ > 0) {
    const auto turn = static_cast<std::uint64_t>(now / shuffle_steps_);
    const auto run = static_cast<std::uint64_t>(shuffle_steps_);
    return turn == 0 ? 0 : static_cast<std::uint8_t>(scrambled((run << 40) + (turn << 16) + value_of(self_)) % 4);
  }
  const std::uint8_t weight = weight_of(bodies);
  const std::uint8_t claimed = claims_.next.weight;
  if (claimed > 0 && 4 * bodies >= least_bodies(claimed)) last_large_ = now;
  return weight > claimed || now - last_large_ > kPatience ? weight : claimed;
}

void RankClaimer::reconsider(Step now, std::size_t bodies) {
  const std::uint8_t weight = wanted_weight(now, bodies);
  if (weight == claims_.next.weight) return;
  // One change at a time: everybody remembers two claims.
  if (claimed_ && now < claims_.next.stamp + rank_notice(lookahead_) + 2 * lookahead_) return;
  claims_ = {claims_.next, {weight, now}};
  claimed_ = true;
  last_large_ = now;
}

}  // namespace aurasim::core
