// The setpoints of programs that one node has received: which are in effect in which state. Every node receives all of
// them, so hand-offs carry no setpoints. A state that is computed again or made up later has the same setpoints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "core/setpoint.h"
#include "core/setpoint_history.h"

namespace aurasim::core {

enum class Heard : std::uint8_t {
  kInTime,
  kLate,     ///< its state had been computed; ControlRules::late decides its use
  kRefused,  ///< too far ahead, too many, or a joint that is not there
};

class ControlLog {
 public:
  void use(const ControlRules& rules) { rules_ = rules; }
  const ControlRules& rules() const { return rules_; }

  /// Adds a received message. `computed`: the newest state computed here. `notice`: a message that names no state takes
  /// effect so many states after it. `joint_count`: joints of the scene. Refused messages change nothing.
  Heard hear(const Setpoints& setpoints, Step computed, Step notice, std::size_t joint_count);
  /// Adds a message that takes effect in its at_step, even if that state has been computed.
  void recall(const Setpoints& setpoints);

  bool empty() const { return bodies_.empty() && joints_.empty(); }
  /// Number of (body, quantity) pairs for which setpoints are remembered.
  std::size_t body_quantities() const { return bodies_.keys(); }

  /// Calls visit(id, quantity, value, is_new) for each setpoint in effect on a body in state `step`, ascending (id,
  /// quantity), if is_wanted(id). `is_new`: it was not in effect in the state before. A setpoint that ends in `step` is
  /// visited once, without value.
  template <class IsWanted, class Visit>
  void for_each_body(Step step, IsWanted&& is_wanted, Visit&& visit) const {
    Silence silence;
    bodies_.for_each(
        step, [&](const BodyKey& key) { return is_wanted(key.first); },
        [&](const HeldOfBody& held) {
          visit_effect(held, step, silence,
                       [&](const auto& value, bool is_new) { visit(held.key.first, held.key.second, value, is_new); });
        });
  }
  /// Like for_each_body(), for one body: visit(quantity, value, is_new).
  template <class Visit>
  void for_each_of(BodyId id, Step step, Visit&& visit) const {
    Silence silence;
    bodies_.for_each_from(
        BodyKey(id, Quantity{}), step, [id](const BodyKey& key) { return key.first == id; },
        [&](const HeldOfBody& held) {
          visit_effect(held, step, silence,
                       [&](const auto& value, bool is_new) { visit(held.key.second, value, is_new); });
        });
  }
  /// Like for_each_body(), for all joints: visit(id, drive, is_new).
  template <class Visit>
  void for_each_joint(Step step, Visit&& visit) const {
    Silence silence;
    joints_.for_each(
        step, [](JointId) { return true; },
        [&](const HeldOfJoint& held) {
          visit_effect(held, step, silence, [&](const auto& drive, bool is_new) { visit(held.key, drive, is_new); });
        });
  }
  /// Calls visit(id, quantity, value) for each setpoint in effect on a body in state `step`, ascending (id, quantity),
  /// and then for each one that messages received so far bring up to state `last`.
  template <class IsWanted, class Visit>
  void for_each_ahead(Step step, Step last, IsWanted&& is_wanted, Visit&& visit) const {
    for_each_body(step, is_wanted, [&](BodyId id, Quantity quantity, const auto& value, bool) {
      if (value) visit(id, quantity, *value);
    });
    bodies_.for_each_later(step, last, [&](const MessageStamp&, const SaidOfBody& said) {
      if (said.value && is_wanted(said.key.first)) visit(said.key.first, said.key.second, *said.value);
    });
  }

  /// All setpoints in effect in state `step` or later, as messages in order: enough for a node that has received none.
  std::vector<Setpoints> since(Step step) const;
  /// States before `step` are never computed again. Call once a state: each call forgets only a part of what is over.
  void forget_before(Step step);

 private:
  using OfBodies = SetpointHistory<BodyKey, Vec3>;
  using OfJoints = SetpointHistory<JointId, JointDrive>;
  using SaidOfBody = OfBodies::Said;
  using HeldOfBody = OfBodies::Held;
  using HeldOfJoint = OfJoints::Held;

  void take_in(const Setpoints& setpoints, Step from);
  void note_word(std::uint64_t client, Step from);
  bool is_silent(std::uint64_t client, Step step) const;
  std::optional<Vec3> value_in_silence(const HeldOfBody& held) const;
  std::optional<JointDrive> value_in_silence(const HeldOfJoint& held) const;

  /// Caches whether a client was silent in a state and in the one before. Consecutive entries mostly have the same
  /// client.
  struct Silence {
    std::optional<std::uint64_t> client;
    bool now = false, before = false;
  };
  void look_at(std::uint64_t client, Step step, Silence& silence) const {
    if (silence.client == client) return;
    silence.client = client;
    silence.now = rules_.on_silence != OnSilence::kLast && is_silent(client, step);
    silence.before = rules_.on_silence != OnSilence::kLast && is_silent(client, step - 1);
  }
  template <class Held, class Visit>
  void visit_effect(const Held& held, Step step, Silence& silence, Visit&& visit) const {
    look_at(held.stamp.client, step, silence);
    const bool silenced = held.value && silence.now;
    const bool is_new = held.stamp.from == step || silenced != (held.value && silence.before);
    if (!silenced) {
      if (held.value || is_new) visit(held.value, is_new);
    } else if (const auto value = value_in_silence(held); value || is_new) {
      visit(value, is_new);
    }
  }

  ControlRules rules_;
  OfBodies bodies_;
  OfJoints joints_;
  std::map<std::uint64_t, std::deque<Step>> words_;  ///< by client: states for which it sent a message, ascending
};

}  // namespace aurasim::core
