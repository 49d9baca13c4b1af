// How fast can contacts make a body while messages about it are under way? A push goes from body to body, and whatever
// lies between is dragged along: what a chain of bodies that do not bounce gains is the momentum of what hit it, shared
// by all of their masses. So a faller makes its pile fast where it lands, not everywhere.
#pragma once

#include <algorithm>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "core/clearance.h"

namespace aurasim::core {

/// The most that a push can do: what it makes move, of mass m, becomes 1 / (1 / speed_m_s + m / momentum_kg_m_s) fast.
struct Push {
  double speed_m_s = 0;
  double momentum_kg_m_s = 0;

  /// Of a body by itself, to whatever it hits: at most (1 + restitution) of its momentum, shared with the other one. A
  /// promise leaves room for the share `uncertainty` of the speed that it states, so speeds are stated so much larger
  /// than they can be.
  static Push of(double speed_m_s, const BodyTraits& traits, double uncertainty);

  double speed_with(double more_kg) const {
    return more_kg <= 0 || speed_m_s <= 0 ? speed_m_s : 1 / (1 / speed_m_s + more_kg / momentum_kg_m_s);
  }
  /// What is left of it for a body that is pushed by the one it is of.
  Push through(double more_kg) const { return {speed_with(more_kg), momentum_kg_m_s}; }
  /// Is nothing that `other` can do, beyond kUnfelt_m_s, more than this can do?
  bool covers(const Push& other) const;
  /// A push that covers both.
  Push joined_with(const Push& other) const {
    return {std::max(speed_m_s, other.speed_m_s), std::max(momentum_kg_m_s, other.momentum_kg_m_s)};
  }

  /// A change of speed for which every stated speed has room (Aura::calm_speed).
  static constexpr double kUnfelt_m_s = 0.1;
};

/// What a body may do to whom it hits: by itself, and by what pushes it.
struct Impact {
  Push own;
  Push received;

  /// By itself it gives a part of its momentum, which both share; what goes through it is lost only to bodies that do
  /// not bounce.
  Push on(const BodyTraits& other) const {
    return own.through(other.mass_kg).joined_with(received.through((1 - other.restitution) * other.mass_kg));
  }
};

/// Pushes of all bodies of a node along contacts, joints, and pairs that may touch.
class Pushes {
 public:
  /// Starts a step: bodies that move at `own_m_s` by themselves and push nobody yet. `traits` stay the caller's.
  void begin(std::span<const double> own_m_s, std::span<const BodyTraits> traits, double uncertainty);

  /// Two bodies touch, may touch, or are jointed (`rigid`): what pushes one pushes the other.
  void add(std::uint32_t a, std::uint32_t b, bool rigid);
  /// What pushes body `i` is to be passed on by the next spread().
  void start(std::uint32_t i);
  /// Passes on what pushes the bodies that have been started, and whoever is pushed by them. Whoever gets faster is
  /// appended to `raised`, some more than once.
  void spread(std::vector<std::uint32_t>& raised);

  /// What the body's own speed and all that pushes it make of it, m/s.
  double speed(std::uint32_t i) const { return std::max(own_m_s_[i], received_[i].speed_m_s); }
  /// How fast it may leave its path, m/s: pushed by others, or because it hits something itself, be it the ground. That
  /// changes its own speed by as much as it gives to the lightest of bodies.
  double off_path_m_s(std::uint32_t i) const { return std::max(alone(i).speed_m_s, received_[i].speed_m_s); }
  /// What it may do to whom it hits.
  Impact impact(std::uint32_t i) const { return {own_[i], received_[i]}; }
  /// Would a contact make body `to` much faster than it is known to become? What pushes one reaches the other through
  /// contacts, too, where both are in one pile, and speeds are stated with room (Push::of).
  bool raises(std::uint32_t from, std::uint32_t to) const {
    return impact(from).on(traits_[to]).speed_m_s > kMuch * speed(to) + Push::kUnfelt_m_s;
  }
  /// Bodies that are pushed that much are not raised by body `i`, m/s.
  double raises_none_above(std::uint32_t i) const {
    return (impact(i).on(lightest_).speed_m_s - Push::kUnfelt_m_s) / kMuch;
  }

 private:
  struct Link {
    std::uint32_t to;
    std::uint32_t next;  ///< of the same body
    bool rigid;
  };
  static constexpr std::uint32_t kNone = ~0u;
  static constexpr double kMuch = 1.5;

  /// A lever may give its end more than its centre gets: jointed bodies pass on all that they get.
  Push along(std::uint32_t from, const Link& link) const {
    if (link.rigid) return {speed(from), std::max(own_[from].momentum_kg_m_s, received_[from].momentum_kg_m_s)};
    return impact(from).on(traits_[link.to]);
  }

  Push alone(std::uint32_t i) const { return Push::of(own_m_s_[i], traits_[i], uncertainty_); }

  double uncertainty_ = 1;
  std::vector<double> own_m_s_;
  std::vector<Push> own_, received_;
  std::span<const BodyTraits> traits_;
  BodyTraits lightest_;  ///< nothing takes less of a push
  std::vector<std::uint32_t> first_link_;
  std::vector<Link> links_;
  std::priority_queue<std::pair<double, std::uint32_t>> to_do_;  ///< fastest first, so that most are done once
};

}  // namespace aurasim::core
