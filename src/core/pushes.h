// How fast can contacts make a body while messages about it are under way? A push goes from body to body and drags
// along what lies between. A chain of bodies that do not bounce gains the momentum of the body that hit it, shared by
// all of their masses. So a falling body makes its pile fast where it lands, not everywhere.
#pragma once

#include <algorithm>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "core/clearance.h"

namespace aurasim::core {

/// Upper bound of a push: it makes a mass m at most 1 / (1 / speed_m_s + m / momentum_kg_m_s) fast.
struct Push {
  double speed_m_s = 0;
  double momentum_kg_m_s = 0;

  /// The push that a body of this speed gives to a body that it hits: at most (1 + restitution) of its momentum, shared
  /// with that one. An aura allows for `uncertainty` times its stated speed off the path. So the stated speed is the
  /// possible one divided by `uncertainty`.
  static Push of(double speed_m_s, const BodyTraits& traits, double uncertainty);

  double speed_with(double more_kg) const {
    return more_kg <= 0 || speed_m_s <= 0 ? speed_m_s : 1 / (1 / speed_m_s + more_kg / momentum_kg_m_s);
  }
  /// The rest of the push after `more_kg` have been dragged along.
  Push through(double more_kg) const { return {speed_with(more_kg), momentum_kg_m_s}; }
  /// Does `other` make no mass faster than this push does, apart from kUnfelt_m_s?
  bool covers(const Push& other) const;
  /// A push that covers both.
  Push joined_with(const Push& other) const {
    return {std::max(speed_m_s, other.speed_m_s), std::max(momentum_kg_m_s, other.momentum_kg_m_s)};
  }

  /// Changes of speed up to this one are ignored: every stated speed has room for them (Aura::calm_speed).
  static constexpr double kUnfelt_m_s = 0.1;
};

/// What a body may do to one that it hits: by its own motion, and by what pushes it.
struct Impact {
  Push own;
  Push received;

  /// The push on a body that is hit. Its own momentum is shared by both bodies. What pushes it passes through
  /// undiminished, except where the other body does not bounce.
  Push on(const BodyTraits& other) const {
    return own.through(other.mass_kg).joined_with(received.through((1 - other.restitution) * other.mass_kg));
  }
};

/// Passes the pushes of all bodies of a node along contacts, joints, and pairs that may touch.
class Pushes {
 public:
  /// Starts a step with bodies that move at `own_m_s` by themselves and push no other yet. The caller owns `traits`.
  void begin(std::span<const double> own_m_s, std::span<const BodyTraits> traits, double uncertainty);

  /// Two bodies touch, may touch, or are jointed (`rigid`): what pushes one pushes the other.
  void add(std::uint32_t a, std::uint32_t b, bool rigid);
  /// The next spread() passes on what pushes body `i`.
  void start(std::uint32_t i);
  /// Passes on the pushes of all started bodies, and of the bodies that they push. Bodies that become faster are
  /// appended to `raised`, some more than once.
  void spread(std::vector<std::uint32_t>& raised);

  /// Top speed of the body from its own speed and all that pushes it, m/s.
  double speed(std::uint32_t i) const { return std::max(own_m_s_[i], received_[i].speed_m_s); }
  /// How fast the body may leave its path, m/s: pushed by others, or because it hits something itself, such as the
  /// ground. A hit changes its speed by at most what it could give to a body without mass.
  double off_path_m_s(std::uint32_t i) const { return std::max(alone(i).speed_m_s, received_[i].speed_m_s); }
  /// What body i may do to a body that it hits.
  Impact impact(std::uint32_t i) const { return {own_[i], received_[i]}; }
  /// Would a contact make body `to` much faster than it is known to become? Smaller gains do not count: within one pile
  /// a push also arrives through contacts, and speeds are stated with room (Push::of).
  bool raises(std::uint32_t from, std::uint32_t to) const {
    return impact(from).on(traits_[to]).speed_m_s > kMuch * speed(to) + Push::kUnfelt_m_s;
  }
  /// Body `i` raises no body whose speed() is above this, m/s.
  double raises_none_above(std::uint32_t i) const {
    return (impact(i).on(lightest_).speed_m_s - Push::kUnfelt_m_s) / kMuch;
  }

 private:
  struct Link {
    std::uint32_t to;
    std::uint32_t next;  ///< next link of the same body; kNone: the last
    bool rigid;
  };
  static constexpr std::uint32_t kNone = ~0u;
  static constexpr double kMuch = 1.5;

  /// The push along a link. A rigid link passes on all of it, because a lever may move its end faster than its centre.
  Push along(std::uint32_t from, const Link& link) const {
    if (link.rigid) return {speed(from), std::max(own_[from].momentum_kg_m_s, received_[from].momentum_kg_m_s)};
    return impact(from).on(traits_[link.to]);
  }

  Push alone(std::uint32_t i) const { return Push::of(own_m_s_[i], traits_[i], uncertainty_); }

  double uncertainty_ = 1;
  std::vector<double> own_m_s_;
  std::vector<Push> own_, received_;
  std::span<const BodyTraits> traits_;
  BodyTraits lightest_;  ///< no body reduces a push less
  std::vector<std::uint32_t> first_link_;
  std::vector<Link> links_;
  /// fastest first, so that most bodies are handled once
  std::priority_queue<std::pair<double, std::uint32_t>> to_do_;
};

}  // namespace aurasim::core
