#include "core/listening.h"

#include <algorithm>

#include "core/horizon.h"

namespace aurasim::core {

Listening::Listening(Vicinity& vicinity, Intake& intake, int lookahead, Step start, std::span<const Listened> earlier)
    : vicinity_(vicinity), intake_(intake), lookahead_(lookahead), start_(start) {
  for (const Listened& who : earlier) insert(who);
  for (const RegionId near : vicinity_.neighbours) insert({near, start, {}});
}

void Listening::insert(const Listened& who) {
  const auto place = std::ranges::lower_bound(all_, who.region, {}, &Listened::region);
  if (place == all_.end() || place->region != who.region) all_.insert(place, who);
}

void Listening::add(std::span<const Listened> regions) {
  for (const Listened& who : regions) {
    vicinity_.listen_to(who.region);
    intake_.listen_to(who.region, start_);
    insert(who);
  }
}

/// Both regions receive an introduction by the same state, because both listen to the node that made it.
void Listening::receive(std::span<const Neighbour::Introduced> introductions) {
  for (const Neighbour::Introduced& introduced : introductions) {
    const auto [a, b] = introduced.pair;
    if (a != vicinity_.self && b != vicinity_.self) continue;
    const RegionId other = a == vicinity_.self ? b : a;
    const bool is_expected = std::ranges::any_of(expected_, [&](const Expected& e) { return e.who.region == other; });
    if (vicinity_.is_neighbour(other) || is_expected) continue;
    const Step since = introduced.stamp + horizon::introduction(lookahead_);
    expected_.push_back({{other, since, introduced.by}, introduced.stamp});
    intake_.listen_to(other, since);
  }
}

bool Listening::begin(Step now) {
  return std::erase_if(expected_, [&](const Expected& expected) {
           if (expected.who.since > now) return false;
           vicinity_.listen_to(expected.who.region);
           insert(expected.who);
           return true;
         }) > 0;
}

std::vector<RegionId> Listening::expected() const {
  std::vector<RegionId> regions;
  for (const Expected& expected : expected_) regions.push_back(expected.who.region);
  return regions;
}

/// Leaves out introductions younger than K states: if messages take effect as they arrive, the other region may not
/// have received them.
std::vector<Listened> Listening::agreed(Step then) const {
  const Step introduced = then - lookahead_;
  std::vector<Listened> all = all_;
  std::erase_if(all, [&](const Listened& who) { return who.since - horizon::introduction(lookahead_) > introduced; });
  for (const Expected& expected : expected_) {
    if (expected.introduced <= introduced) all.push_back(expected.who);
  }
  return all;
}

}  // namespace aurasim::core
