// The definitions of docs/design.md, "What is counted", and sums over trials.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/ids.h"
#include "lab/conditions.h"
#include "lab/pair.h"

namespace aurasim::lab {

/// A pair's first contact.
struct Contact {
  core::Step step = 0;
  double penetration_m = 0;  ///< positive: the shapes overlap
  double relative_speed_m_s = 0;

  friend bool operator==(const Contact&, const Contact&) = default;
};

double penetration_time_s(const Contact& contact);

/// True if the penetration time is above one step. Rounding errors do not count.
bool is_late(const Contact& contact, double step_s);
/// True if the bodies met in one world, and passed through each other in several.
bool is_missed(const std::optional<Contact>& contact, bool met_in_one_world);
/// More than one hand-off of the pair before its first contact.
bool is_thrashed(std::uint64_t hand_offs);

/// One pair under one variant.
struct Trial {
  PairKind pairs{};
  std::string series;
  double tolerance = 0;  ///< in the figures' units: m/s, ms, ms, percent
  double value = 0;      ///< in the same unit
  bool within = false;   ///< the value keeps the tolerance
  Variant variant;
  std::uint32_t repeat = 0;
  std::optional<Contact> contact;
  std::optional<core::Step> central_step;  ///< state of the contact in the control
  bool same_bits = false;                  ///< all states are as in the control, to the last bit
  std::uint64_t hand_offs = 0;             ///< hand-offs before the contact, real or expected; a cluster counts once
  std::uint64_t pulls = 0;                 ///< hand-offs caused by an aura collision
  std::uint64_t violations = 0;            ///< broken promises before the contact, all nodes together
  bool flagged = false;                    ///< the node that saw the contact holds a violation for its possible cause
  double slow_down = 1;                    ///< time taken over time simulated

  friend bool operator==(const Trial&, const Trial&) = default;

  bool late() const { return contact && is_late(*contact, kStep_s); }
  bool missed() const { return is_missed(contact, central_step.has_value()); }
  bool thrashed() const { return is_thrashed(hand_offs); }
  /// Late without an earlier violation. A violation in the contact's own step is no warning.
  bool late_without_violation() const { return late() && (!flagged || violations == 0); }
  bool missed_without_violation() const { return missed() && violations == 0; }
  /// True if the contact came in a later state than in the control. Stricter than late(), because bodies that have
  /// passed each other overlap less again.
  bool later_than_central() const { return contact && central_step && contact->step > *central_step; }
};

struct Tally {
  std::uint64_t trials = 0;  ///< pairs that meet in the control
  std::uint64_t late = 0;
  std::uint64_t missed = 0;
  std::uint64_t thrashed = 0;
  std::uint64_t pulled_twice = 0;  ///< trials that thrash by the thesis's definition: more than one pull
  std::uint64_t late_without_violation = 0;
  std::uint64_t missed_without_violation = 0;
  std::uint64_t later_than_central = 0;
  std::uint64_t same_bits = 0;
  std::uint64_t with_violations = 0;  ///< trials with violations before the contact
  double slow_down_sum = 0;
  double slow_down_most = 1;
  double penetration_time_most_s = -1;

  void add(const Trial& trial);
  void add(const Tally& other);
  /// Share of the trials, percent.
  double percent(std::uint64_t part) const {
    return trials > 0 ? 100 * static_cast<double>(part) / static_cast<double>(trials) : 0;
  }
  double mean_slow_down() const { return trials > 0 ? slow_down_sum / static_cast<double>(trials) : 1; }
};

}  // namespace aurasim::lab
