// The setpoints of programs, as one node has heard them: what is in effect in which state. Every node hears all of
// them, so a body's setpoints need not travel with it, and a state that is computed again, or made up later, has the
// same.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "core/setpoint.h"

namespace aurasim::core {

enum class Heard : std::uint8_t {
  kInTime,
  kLate,     ///< its state had been computed; the rules say what becomes of it
  kRefused,  ///< too far ahead, too many, or a joint that is not there
};

class ControlLog {
 public:
  void use(const ControlRules& rules) { rules_ = rules; }
  const ControlRules& rules() const { return rules_; }

  /// `computed`: the newest state here. `notice`: so many states later what names no state takes effect.
  Heard hear(const Setpoints& setpoints, Step computed, Step notice, std::size_t joint_count);
  /// Takes effect in its state, whatever has been computed.
  void recall(const Setpoints& setpoints);

  bool empty() const { return bodies_.empty() && joints_.empty(); }

  /// visit(id, quantity, value, is_new) for what is in effect on bodies in state `step`, ascending (id, quantity).
  /// `is_new`: it was not in the state before. Then also for what is let go of, without value. Only for bodies that
  /// is_wanted(id).
  template <class IsWanted, class Visit>
  void for_each_body(Step step, IsWanted&& is_wanted, Visit&& visit) const {
    Silence silence;
    for (const BodyTrack& track : bodies_) {
      if (!is_wanted(track.key.first)) continue;
      visit_track(track, step, silence,
                  [&](const auto& value, bool is_new) { visit(track.key.first, track.key.second, value, is_new); });
    }
  }
  /// visit(quantity, value, is_new): likewise for one body.
  template <class Visit>
  void for_each_of(BodyId id, Step step, Visit&& visit) const {
    Silence silence;
    for (auto track = first_of(id); track != bodies_.end() && track->key.first == id; ++track)
      visit_track(*track, step, silence,
                  [&](const auto& value, bool is_new) { visit(track->key.second, value, is_new); });
  }
  /// visit(id, drive, is_new): likewise for joints.
  template <class Visit>
  void for_each_joint(Step step, Visit&& visit) const {
    Silence silence;
    for (const JointTrack& track : joints_)
      visit_track(track, step, silence, [&](const auto& value, bool is_new) { visit(track.key, value, is_new); });
  }
  /// What is in effect on one body in state `step`, and what is known to come up to state `last`: visit(quantity,
  /// value). `hint`: where the body before was, of several in order of their ids; 0 for the first.
  template <class Visit>
  void for_each_ahead(BodyId id, Step step, Step last, std::size_t& hint, Visit&& visit) const {
    const bool is_there =
        hint < bodies_.size() && bodies_[hint].key.first >= id && (hint == 0 || bodies_[hint - 1].key.first < id);
    auto track = is_there ? bodies_.begin() + static_cast<std::ptrdiff_t>(hint) : first_of(id);
    for (; track != bodies_.end() && track->key.first == id; ++track) {
      if (const auto value = in_effect(*track, step)) visit(track->key.second, *value);
      auto entry = first_later(track->entries, last, &Entry<Vec3>::from);
      while (entry != track->entries.begin() && (--entry)->from > step) {
        if (entry->value) visit(track->key.second, *entry->value);
      }
    }
    hint = static_cast<std::size_t>(track - bodies_.begin());
  }
  std::optional<Vec3> in_effect(BodyId id, Quantity quantity, Step step) const;
  std::optional<JointDrive> in_effect(JointId id, Step step) const;

  /// What is in effect from state `step` on, as messages for a node that knows nothing, in order.
  std::vector<Setpoints> since(Step step) const;
  /// States before this one are never computed again. To be called once a state: what is to be forgotten goes bit by
  /// bit, all of it in kForgetCalls calls.
  void forget_before(Step step);
  static constexpr std::size_t kForgetCalls = 30;

 private:
  template <class Value>
  struct Entry {
    Step from = 0;
    std::uint64_t client = 0;
    std::uint64_t sequence = 0;
    std::optional<Value> value;
  };
  template <class Key, class Value>
  struct Track {
    Key key;
    std::deque<Entry<Value>> entries;  ///< ascending (from, client, sequence)
  };
  using BodyTrack = Track<std::pair<BodyId, Quantity>, Vec3>;
  using JointTrack = Track<JointId, JointDrive>;

  /// `place`: of the track to look at first, and afterwards of the one behind: messages mostly go on from key to key.
  template <class Key, class Value>
  void add(std::vector<Track<Key, Value>>& tracks, const Key& key, Entry<Value> entry, std::size_t& place);
  template <class Key, class Value>
  void forget_before(std::vector<Track<Key, Value>>& tracks, Step step, std::size_t& next);
  void note_word(std::uint64_t client, Step from);
  bool is_silent(std::uint64_t client, Step step) const;
  std::optional<Vec3> in_silence(const Vec3& value, Quantity quantity) const;
  std::optional<JointDrive> in_silence(const JointDrive& value) const;

  auto first_of(BodyId id) const {
    return std::ranges::lower_bound(bodies_, std::pair(id, Quantity{}), {}, &BodyTrack::key);
  }
  /// The first that is later than state `step`. Mostly it is asked for the newest states, so it is looked for from the
  /// end: a search through all of them would touch memory that nobody else does.
  template <class List, class StepOf>
  static auto first_later(const List& list, Step step, StepOf step_of) {
    constexpr int kNewest = 8;
    auto later = list.end();
    for (int i = 0; i < kNewest; ++i) {
      if (later == list.begin() || std::invoke(step_of, *(later - 1)) <= step) return later;
      --later;
    }
    return std::ranges::upper_bound(list.begin(), later, step, {}, step_of);
  }
  /// The newest of state `step` or before; null: none.
  template <class Key, class Value>
  static const Entry<Value>* newest(const Track<Key, Value>& track, Step step) {
    const auto later = first_later(track.entries, step, &Entry<Value>::from);
    return later == track.entries.begin() ? nullptr : &*(later - 1);
  }
  /// Whether the client of the last entry was silent in a state and in the one before: mostly it is that of the next,
  /// too.
  struct Silence {
    std::optional<std::uint64_t> client;
    bool now = false, before = false;
  };
  template <class Value>
  void look_at(const Entry<Value>& entry, Step step, Silence& silence) const {
    if (silence.client == entry.client) return;
    silence.client = entry.client;
    silence.now = rules_.on_silence != OnSilence::kLast && is_silent(entry.client, step);
    silence.before = rules_.on_silence != OnSilence::kLast && is_silent(entry.client, step - 1);
  }
  template <class Value>
  bool is_silenced(const Entry<Value>& entry, Step step) const {
    return entry.value && rules_.on_silence != OnSilence::kLast && is_silent(entry.client, step);
  }
  std::optional<Vec3> value_of(const BodyTrack& track, const Entry<Vec3>& entry, bool silenced) const {
    return silenced ? in_silence(*entry.value, track.key.second) : entry.value;
  }
  std::optional<JointDrive> value_of(const JointTrack&, const Entry<JointDrive>& entry, bool silenced) const {
    return silenced ? in_silence(*entry.value) : entry.value;
  }
  template <class AnyTrack>
  auto in_effect(const AnyTrack& track, Step step) const -> decltype(value_of(track, track.entries.front(), false)) {
    const auto* const entry = newest(track, step);
    if (entry == nullptr) return std::nullopt;
    return value_of(track, *entry, is_silenced(*entry, step));
  }
  template <class AnyTrack, class Visit>
  void visit_track(const AnyTrack& track, Step step, Silence& silence, Visit&& visit) const {
    const auto* const entry = newest(track, step);
    if (entry == nullptr) return;
    look_at(*entry, step, silence);
    const bool silenced = entry->value && silence.now;
    const bool is_new = entry->from == step || silenced != (entry->value && silence.before);
    const auto value = value_of(track, *entry, silenced);
    if (value || is_new) visit(value, is_new);
  }

  ControlRules rules_;
  std::vector<BodyTrack> bodies_;                    ///< ascending key
  std::vector<JointTrack> joints_;                   ///< ascending key
  std::map<std::uint64_t, std::deque<Step>> words_;  ///< by client: states that it has said something for, ascending
  std::size_t entries_ = 0;
  std::size_t next_body_ = 0, next_joint_ = 0;  ///< tracks that are looked at next for what to forget
};

}  // namespace aurasim::core
