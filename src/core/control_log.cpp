#include "core/control_log.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace aurasim::core {
namespace {

/// Of a message for a later state.
constexpr Step kFarthestAhead = 3600;
/// Of all programs together, under way and remembered.
constexpr std::size_t kMostEntries = 4'000'000;
constexpr std::size_t kMostClients = 1000;

}  // namespace

Heard ControlLog::hear(const Setpoints& setpoints, Step computed, Step notice, std::size_t joint_count) {
  const auto is_unknown = [joint_count](const JointSetpoint& joint) { return core::value_of(joint.id) >= joint_count; };
  const bool has_room = entries_ + setpoints.bodies.size() + setpoints.joints.size() <= kMostEntries &&
                        (words_.size() < kMostClients || words_.contains(setpoints.client));
  if (!has_room || setpoints.at_step > computed + kFarthestAhead || std::ranges::any_of(setpoints.joints, is_unknown)) {
    return Heard::kRefused;
  }
  const bool is_late = setpoints.at_step != 0 && setpoints.at_step <= computed;
  if (is_late && rules_.late == LateSetpoint::kDropped) {
    note_word(setpoints.client, computed + 1);  // it is there all the same
    return Heard::kLate;
  }
  Setpoints in_time = setpoints;
  if (setpoints.at_step == 0) in_time.at_step = computed + notice;
  if (is_late) in_time.at_step = computed + 1;
  recall(in_time);
  return is_late ? Heard::kLate : Heard::kInTime;
}

void ControlLog::recall(const Setpoints& setpoints) {
  const auto& [client, sequence, generation, from, bodies, joints, statics] = setpoints;
  std::size_t of_body = 0, of_joint = 0;
  for (const BodySetpoint& body : bodies) {
    add(bodies_, std::pair(body.id, body.quantity), Entry<Vec3>{from, client, sequence, body.value}, of_body);
  }
  for (const JointSetpoint& joint : joints) {
    add(joints_, joint.id, Entry<JointDrive>{from, client, sequence, joint.drive}, of_joint);
  }
  note_word(client, from);
}

template <class Key, class Value>
void ControlLog::add(std::vector<Track<Key, Value>>& tracks, const Key& key, Entry<Value> entry, std::size_t& place) {
  if (place >= tracks.size() || tracks[place].key != key) {
    auto found = std::ranges::lower_bound(tracks, key, {}, &Track<Key, Value>::key);
    if (found == tracks.end() || found->key != key) found = tracks.insert(found, {key, {}});
    place = static_cast<std::size_t>(found - tracks.begin());
  }
  auto& entries = tracks[place++].entries;
  const auto order_of = [](const Entry<Value>& e) { return std::tuple(e.from, e.client, e.sequence); };
  auto later = entries.end();  // where it mostly belongs
  while (later != entries.begin() && order_of(*(later - 1)) >= order_of(entry)) --later;
  if (later != entries.end() && order_of(*later) == order_of(entry)) {
    *later = entry;
    return;
  }
  entries.insert(later, std::move(entry));
  ++entries_;
}

void ControlLog::note_word(std::uint64_t client, Step from) {
  if (client == kRecordedClient) return;
  std::deque<Step>& words = words_[client];
  const auto place = std::ranges::lower_bound(words, from);
  if (place == words.end() || *place != from) words.insert(place, from);
}

bool ControlLog::is_silent(std::uint64_t client, Step step) const {
  const auto words = words_.find(client);
  if (words == words_.end()) return client != kRecordedClient;
  const auto later = first_later(words->second, step, std::identity{});
  return later == words->second.begin() || step - *(later - 1) > rules_.silence;
}

std::optional<Vec3> ControlLog::in_silence(const Vec3&, Quantity quantity) const {
  const bool stands_still =
      quantity == Quantity::kVelocity || quantity == Quantity::kSpin || quantity == Quantity::kDriving;
  if (rules_.on_silence == OnSilence::kZero || !stands_still) return std::nullopt;
  return Vec3(Vec3::Zero());
}

std::optional<JointDrive> ControlLog::in_silence(const JointDrive& value) const {
  if (rules_.on_silence == OnSilence::kZero) return std::nullopt;
  JointDrive stopped = value;
  stopped.speed = stopped.effort = 0;
  return stopped;
}

std::optional<Vec3> ControlLog::in_effect(BodyId id, Quantity quantity, Step step) const {
  const std::pair key(id, quantity);
  const auto track = std::ranges::lower_bound(bodies_, key, {}, &BodyTrack::key);
  return track != bodies_.end() && track->key == key ? in_effect(*track, step) : std::nullopt;
}

std::optional<JointDrive> ControlLog::in_effect(JointId id, Step step) const {
  const auto track = std::ranges::lower_bound(joints_, id, {}, &JointTrack::key);
  return track != joints_.end() && track->key == id ? in_effect(*track, step) : std::nullopt;
}

std::vector<Setpoints> ControlLog::since(Step step) const {
  std::map<std::tuple<Step, std::uint64_t, std::uint64_t>, Setpoints> messages;
  const auto message = [&](Step from, std::uint64_t client, std::uint64_t sequence) -> Setpoints& {
    Setpoints& made = messages[{from, client, sequence}];
    made.at_step = from, made.client = client, made.sequence = sequence;
    return made;
  };
  // From the newest that is in effect by then.
  const auto each = [&](const auto& track, const auto& put) {
    auto entry = std::ranges::upper_bound(track.entries, step, {}, [](const auto& entry) { return entry.from; });
    if (entry != track.entries.begin()) --entry;
    for (; entry != track.entries.end(); ++entry) put(message(entry->from, entry->client, entry->sequence), *entry);
  };
  for (const BodyTrack& track : bodies_) {
    each(track, [&](Setpoints& to, const Entry<Vec3>& entry) {
      to.bodies.push_back({track.key.first, track.key.second, entry.value});
    });
  }
  for (const JointTrack& track : joints_) {
    each(track, [&](Setpoints& to, const Entry<JointDrive>& entry) { to.joints.push_back({track.key, entry.value}); });
  }
  for (const auto& [client, words] : words_) {
    for (const Step word : words) message(word, client, 0);
  }
  std::vector<Setpoints> list;
  for (auto& [place, one] : messages) list.push_back(std::move(one));
  return list;
}

template <class Key, class Value>
void ControlLog::forget_before(std::vector<Track<Key, Value>>& tracks, Step step, std::size_t& next) {
  const auto forget = [&](Track<Key, Value>& track) {
    const auto later = std::ranges::upper_bound(track.entries, step, {}, &Entry<Value>::from);
    if (later == track.entries.begin()) return false;
    entries_ -= static_cast<std::size_t>(later - 1 - track.entries.begin());
    track.entries.erase(track.entries.begin(), later - 1);
    const Entry<Value>& first = track.entries.front();
    const bool is_over = track.entries.size() == 1 && first.from < step - 1 &&
                         (!first.value || (rules_.on_silence == OnSilence::kZero && is_silenced(first, step - 1)));
    entries_ -= is_over ? 1 : 0;
    return is_over;
  };
  if (next >= tracks.size()) next = 0;
  const auto first = tracks.begin() + static_cast<std::ptrdiff_t>(next);
  const auto last =
      first + static_cast<std::ptrdiff_t>(std::min(tracks.size() - next, tracks.size() / kForgetCalls + 1));
  const auto rest = std::remove_if(first, last, forget);
  next = static_cast<std::size_t>(rest - tracks.begin());
  tracks.erase(rest, last);
}

void ControlLog::forget_before(Step step) {
  forget_before(bodies_, step, next_body_);
  forget_before(joints_, step, next_joint_);
  for (auto& [client, words] : words_) {
    const auto later = std::ranges::upper_bound(words, step);
    if (later - words.begin() > 1) words.erase(words.begin(), later - 1);
  }
  std::erase_if(words_, [&](const auto& of_client) { return of_client.second.back() + rules_.silence < step - 1; });
}

}  // namespace aurasim::core
