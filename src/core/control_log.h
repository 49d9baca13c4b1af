// The setpoints of programs, as one node has heard them: what is in effect in which state. Every node hears all of
// them, so a body's setpoints need not travel with it, and a state that is computed again, or made up later, has the
// same.
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
  /// Quantities of bodies that programs have said something about.
  std::size_t body_quantities() const { return bodies_.keys(); }

  /// visit(id, quantity, value, is_new) for what is in effect on bodies in state `step`, ascending (id, quantity).
  /// `is_new`: it was not in the state before. Then also for what is let go of, without value. Only for bodies that
  /// is_wanted(id).
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
  /// visit(quantity, value, is_new): likewise for one body.
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
  /// visit(id, drive, is_new): likewise for joints.
  template <class Visit>
  void for_each_joint(Step step, Visit&& visit) const {
    Silence silence;
    joints_.for_each(
        step, [](JointId) { return true; },
        [&](const HeldOfJoint& held) {
          visit_effect(held, step, silence, [&](const auto& drive, bool is_new) { visit(held.key, drive, is_new); });
        });
  }
  /// What is in effect on bodies in state `step`, and what is known to come up to state `last`: visit(id, quantity,
  /// value), first the one, ascending (id, quantity), then each message.
  template <class IsWanted, class Visit>
  void for_each_ahead(Step step, Step last, IsWanted&& is_wanted, Visit&& visit) const {
    for_each_body(step, is_wanted, [&](BodyId id, Quantity quantity, const auto& value, bool) {
      if (value) visit(id, quantity, *value);
    });
    bodies_.for_each_later(step, last, [&](const MessageStamp&, const SaidOfBody& said) {
      if (said.value && is_wanted(said.key.first)) visit(said.key.first, said.key.second, *said.value);
    });
  }

  /// What is in effect from state `step` on, as messages for a node that knows nothing, in order.
  std::vector<Setpoints> since(Step step) const;
  /// States before this one are never computed again. To be called once a state: what is to be forgotten goes bit by
  /// bit.
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

  /// Whether the client of the last entry was silent in a state and in the one before: mostly it is that of the next,
  /// too.
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
  std::map<std::uint64_t, std::deque<Step>> words_;  ///< by client: states that it has said something for, ascending
};

}  // namespace aurasim::core
