// How fast can contacts make a body while messages about it are under way? A push goes from body to body, and whatever
// lies between is dragged along: what a chain of bodies that do not bounce gains is the momentum of what hit it, shared
// by all of their masses. So a faller makes its heap fast where it lands, not everywhere.
#pragma once

#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "core/clearance.h"

namespace aurasim::core {

/// The most that a push can do: it makes a body `speed_m_s` fast, and what it makes move beyond `free_kg` shares its
/// momentum, speed(m) = 1 / (1 / speed_m_s + max(0, m - free_kg) / momentum_kg_m_s).
struct Push {
  double speed_m_s = 0;
  double momentum_kg_m_s = 0;
  double free_kg = 0;

  /// Of a body by itself. Where it hits, it gives at most (1 + restitution) of its momentum away; a promise leaves room
  /// for the share `uncertainty` of the speed that it states, so speeds are stated so much larger than they can be.
  static Push of(double speed_m_s, const BodyTraits& traits, double uncertainty);

  double speed_with(double more_kg) const {
    if (more_kg <= free_kg || speed_m_s <= 0) return speed_m_s;
    return 1 / (1 / speed_m_s + (more_kg - free_kg) / momentum_kg_m_s);
  }
  /// What is left of it for a body that is pushed by the one it is of.
  Push through(double more_kg) const {
    return {speed_with(more_kg), momentum_kg_m_s, more_kg < free_kg ? free_kg - more_kg : 0};
  }
  /// Is nothing that `other` can do, beyond kUnfelt_m_s, more than this can do?
  bool covers(const Push& other) const;
  /// A push that covers both.
  Push joined_with(const Push& other) const;

  /// A change of speed for which every stated speed has room (Aura::calm_speed).
  static constexpr double kUnfelt_m_s = 0.1;
};

/// Pushes of all bodies of a node along contacts, joints, and pairs that may touch.
class Pushes {
 public:
  /// Starts a step: bodies that move at `own_m_s` by themselves and push nobody yet.
  void begin(std::span<const double> own_m_s, std::span<const BodyTraits> traits, double uncertainty);

  /// Two bodies touch, may touch, or are jointed (`rigid`): what pushes one pushes the other.
  void add(std::uint32_t a, std::uint32_t b, bool rigid);
  /// What pushes body `i` is to be passed on by the next spread().
  void start(std::uint32_t i);
  /// Passes on what pushes the bodies that have been started, and whoever is pushed by them. Whoever gets faster is
  /// appended to `raised`, some more than once.
  void spread(std::vector<std::uint32_t>& raised);

  /// What the body's own speed and all that pushes it make of it, m/s.
  double speed(std::uint32_t i) const { return pushes_[i].speed_m_s; }
  /// Would a contact make body `to` much faster than it is known to become? What pushes one reaches the other through
  /// contacts, too, where both are in one heap, and speeds are stated with room (Push::of).
  bool raises(std::uint32_t from, std::uint32_t to) const {
    return pushes_[from].through(inert_kg_[to]).speed_m_s > kMuch * pushes_[to].speed_m_s + Push::kUnfelt_m_s;
  }
  /// Bodies that are pushed that much are not raised by body `i`, m/s.
  double raises_none_above(std::uint32_t i) const { return (speed(i) - Push::kUnfelt_m_s) / kMuch; }

 private:
  struct Link {
    std::uint32_t to;
    std::uint32_t next;  ///< of the same body
    bool rigid;
  };
  static constexpr std::uint32_t kNone = ~0u;
  static constexpr double kMuch = 1.5;

  Push along(std::uint32_t from, const Link& link) const {
    // A lever may give its end more than its centre gets: jointed bodies pass on all that they get.
    return link.rigid ? pushes_[from] : pushes_[from].through(inert_kg_[link.to]);
  }

  std::vector<Push> pushes_;
  std::vector<double> inert_kg_;  ///< what a body takes of the momentum that goes through it
  std::vector<std::uint32_t> first_link_;
  std::vector<Link> links_;
  std::priority_queue<std::pair<double, std::uint32_t>> to_do_;  ///< fastest first, so that most are done once
};

}  // namespace aurasim::core
