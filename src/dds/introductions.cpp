#include "dds/introductions.h"

#include <algorithm>

#include <fnmatch.h>

#include "rtps/readdressed.h"

namespace aurasim::dds {

bool share_a_partition(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  if (a.empty() || b.empty()) {
    static const std::vector<std::string> kUnnamed = {""};
    if (a.empty() && b.empty()) return true;
    return share_a_partition(a.empty() ? kUnnamed : a, b.empty() ? kUnnamed : b);
  }
  const auto match = [](const std::string& x, const std::string& y) {
    return x == y || ::fnmatch(x.c_str(), y.c_str(), 0) == 0 || ::fnmatch(y.c_str(), x.c_str(), 0) == 0;
  };
  return std::ranges::any_of(
      a, [&](const std::string& x) { return std::ranges::any_of(b, [&](const auto& y) { return match(x, y); }); });
}

void Introductions::hear(std::span<const std::uint8_t> announcement) {
  auto datagram = rtps::for_everybody(announcement);
  if (!datagram) return;
  const std::lock_guard lock(mutex_);
  const rtps::GuidPrefix sender = rtps::sender_of(announcement);
  Known* const known = known_or_new(sender);
  if (known == nullptr) return;
  known->announcement = std::move(*datagram);
  ++known->heard;
}

void Introductions::add(const rtps::GuidPrefix& participant, MeetingPoint where) {
  const std::lock_guard lock(mutex_);
  if (Known* const known = known_or_new(participant)) known->where = where;
}

/// Null: there is no room. Those of whom only an announcement has come make room: it may have come after their end.
Introductions::Known* Introductions::known_or_new(const rtps::GuidPrefix& participant) {
  if (participants_.size() >= kMostParticipants && !participants_.contains(participant)) {
    std::erase_if(participants_, [](const auto& entry) { return entry.second.where.port == 0; });
    if (participants_.size() >= kMostParticipants) return nullptr;
  }
  return &participants_[participant];
}

void Introductions::remove(const rtps::GuidPrefix& participant) {
  const std::lock_guard lock(mutex_);
  participants_.erase(participant);
  std::erase_if(
      pairs_, [&](const auto& entry) { return entry.first.first == participant || entry.first.second == participant; });
  const auto is_its = [&](const DiscoveredEndpoint& one) { return one.guid.prefix == participant; };
  for (auto& [topic, endpoints] : topics_) {
    std::erase_if(endpoints.writers, is_its);
    std::erase_if(endpoints.readers, is_its);
  }
}

void Introductions::add(DiscoveredEndpoint endpoint) {
  const std::lock_guard lock(mutex_);
  OfTopic& of_topic = topics_[endpoint.topic];
  match(endpoint, endpoint.is_writer ? of_topic.readers : of_topic.writers);
  std::vector<DiscoveredEndpoint>& same = endpoint.is_writer ? of_topic.writers : of_topic.readers;
  const auto known = std::ranges::find(same, endpoint.guid, &DiscoveredEndpoint::guid);
  if (known != same.end()) {
    *known = std::move(endpoint);
  } else {
    same.push_back(std::move(endpoint));
  }
}

void Introductions::match(const DiscoveredEndpoint& endpoint, const std::vector<DiscoveredEndpoint>& others) {
  for (const DiscoveredEndpoint& other : others) {
    if (other.guid.prefix == endpoint.guid.prefix) continue;
    const Key key = std::minmax(endpoint.guid.prefix, other.guid.prefix);
    if (!pairs_.contains(key) && share_a_partition(endpoint.partitions, other.partitions)) pairs_.try_emplace(key);
  }
}

void Introductions::remove(const rtps::WireGuid& endpoint) {
  const std::lock_guard lock(mutex_);
  for (auto& [topic, endpoints] : topics_) {
    std::erase_if(endpoints.writers, [&](const auto& one) { return one.guid == endpoint; });
    std::erase_if(endpoints.readers, [&](const auto& one) { return one.guid == endpoint; });
  }
}

std::vector<Introduction> Introductions::take_due(Time now) {
  const std::lock_guard lock(mutex_);
  std::vector<Introduction> due;
  for (auto& [key, pair] : pairs_) {
    if (now < pair.next) continue;
    const auto first = participants_.find(key.first), second = participants_.find(key.second);
    if (first == participants_.end() || second == participants_.end()) continue;
    const std::array both = {&first->second, &second->second};
    const auto is_known = [](const Known* one) { return !one->announcement.empty() && one->where.port != 0; };
    if (!std::ranges::all_of(both, is_known)) continue;  // looked at again when it is
    if (pair.since < Time(0)) pair.since = now;
    const bool is_eager = pair.eager < kEagerly.size();
    for (std::size_t i = 0; i < both.size(); ++i) {
      if (!is_eager && pair.passed_on[i] == both[i]->heard) continue;
      pair.passed_on[i] = both[i]->heard;
      due.push_back({both[i]->announcement, both[1 - i]->where});
    }
    if (is_eager) ++pair.eager;
    pair.next = pair.eager < kEagerly.size() ? pair.since + kEagerly[pair.eager] : now + kPeriod;
  }
  return due;
}

std::size_t Introductions::pairs() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(
      std::ranges::count_if(pairs_, [](const auto& entry) { return entry.second.eager > 0; }));
}

}  // namespace aurasim::dds
