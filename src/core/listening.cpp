#include "core/listening.h"

#include <algorithm>
#include <utility>

#include "core/horizon.h"

namespace aurasim::core {

Listening::Listening(Vicinity& vicinity, Intake& intake, int lookahead, Step start, std::span<const Listened> earlier,
                     bool ends)
    : vicinity_(vicinity), intake_(intake), lookahead_(lookahead), start_(start), ends_(ends) {
  for (const Listened& who : earlier) insert(who, start);
  for (const RegionId near : vicinity_.neighbours) insert({near, start, {}}, start);
}

/// `used`: the state of its newest introduction, as far as anybody knows.
void Listening::insert(const Listened& who, Step used) {
  const auto place = std::ranges::lower_bound(all_, who.region, {}, &Listened::region);
  if (place != all_.end() && place->region == who.region) return;
  all_.insert(place, who);
  if (may_end(who.region)) uses_.push_back({who.region, used, used});
}

void Listening::add(std::span<const Listened> regions) {
  for (const Listened& who : regions) {
    vicinity_.listen_to(who.region);
    intake_.listen_to(who.region, start_);
    insert(who, start_);
  }
}

/// Both regions receive an introduction by the same state, because both listen to the node that made it.
void Listening::receive(std::span<const Neighbour::Introduced> introductions) {
  for (const Neighbour::Introduced& introduced : introductions) {
    const auto [a, b] = introduced.pair;
    if (a != vicinity_.self && b != vicinity_.self) continue;
    const RegionId other = a == vicinity_.self ? b : a;
    if (vicinity_.is_neighbour(other)) {
      note_use(other, introduced.stamp);
      continue;
    }
    // One from before the end may be unknown to the other region when it hears the end.
    const Ended* const before = ended(other);
    if (before != nullptr && introduced.stamp < before->end) continue;
    expect({other, introduced.stamp + horizon::introduction(lookahead_), introduced.by}, introduced.stamp);
  }
}

/// The earliest of several introductions counts. If messages take effect as they arrive, a later one may be the first
/// that one of the two regions receives.
void Listening::expect(const Listened& who, Step introduced) {
  const auto place = std::ranges::find_if(expected_, [&](const Expected& e) { return e.who.region == who.region; });
  if (place == expected_.end()) {
    expected_.push_back({who, introduced});
  } else if (std::pair(introduced, who.introduced_by) < std::pair(place->introduced, place->who.introduced_by)) {
    *place = {who, introduced};
  }
}

void Listening::note_use(RegionId other, Step stamp) {
  const auto use = std::ranges::find(uses_, other, &Use::region);
  if (use == uses_.end() || stamp <= use->counted) return;
  use->newest = std::max(use->newest, stamp);
  use->fresh.push_back(stamp);
}

bool Listening::begin(Step now) {
  for (const Expected& expected : expected_) {
    if (expected.introduced <= now - lookahead_) intake_.listen_to(expected.who.region, expected.who.since);
  }
  const bool anybody_came = std::erase_if(expected_, [&](const Expected& expected) {
                              if (expected.who.since > now) return false;
                              vicinity_.listen_to(expected.who.region);
                              insert(expected.who, expected.who.since);
                              return true;
                            }) > 0;
  end(now);
  return anybody_came;
}

/// Counts the introductions of which the other region knows by now, too, and ends to listen to those that had none for
/// long. So both end in the same state.
void Listening::end(Step now) {
  const Step known = now - lookahead_;
  std::erase_if(uses_, [&](Use& use) {
    std::erase_if(use.fresh, [&](Step stamp) {
      if (stamp > known) return false;
      use.counted = std::max(use.counted, stamp);
      return true;
    });
    if (known - use.counted < horizon::listening(lookahead_) || !intake_.is_alive(use.region)) return false;
    const auto who = std::ranges::find(all_, use.region, &Listened::region);
    std::erase_if(ended_, [&](const Ended& one) { return one.who.region == use.region; });
    ended_.push_back({*who, now});
    all_.erase(who);
    vicinity_.leave(use.region);
    intake_.leave(use.region, now);
    return true;
  });
}

const Listening::Ended* Listening::ended(RegionId id) const {
  const auto found = std::ranges::find_if(ended_, [id](const Ended& one) { return one.who.region == id; });
  return found == ended_.end() ? nullptr : &*found;
}

bool Listening::stays(RegionId id, Step now) const {
  const auto use = std::ranges::find(uses_, id, &Use::region);
  return use == uses_.end() || now < use->newest + horizon::listening(lookahead_);
}

std::vector<RegionId> Listening::expected() const {
  std::vector<RegionId> regions;
  for (const Expected& expected : expected_) regions.push_back(expected.who.region);
  return regions;
}

/// Leaves out introductions younger than K states: if messages take effect as they arrive, the other region may not
/// have received them.
std::vector<Listened> Listening::agreed(Step then, Step cut) const {
  const Step introduced = then - lookahead_;
  std::vector<Listened> all = all_;
  std::erase_if(all, [&](const Listened& who) { return who.since - horizon::introduction(lookahead_) > introduced; });
  for (const Expected& expected : expected_) {
    if (expected.introduced <= introduced) all.push_back(expected.who);
  }
  for (const Ended& before : ended_) {
    const bool is_there = std::ranges::find(all, before.who.region, &Listened::region) != all.end();
    if (before.end > cut && !is_there) all.push_back(before.who);
  }
  return all;
}

}  // namespace aurasim::core
