// The aura: how far ahead, and how far away, two bodies must know of each other so that they share a host before
// they can touch. Distances and their derivation: docs/design.md, "The aura and its reach". Each kind of aura is a
// class of its own (make_aura.h).
#pragma once

#include <optional>

#include "core/body_state.h"
#include "core/clearance.h"

namespace aurasim::core {

enum class AuraKind : std::uint8_t {
  kNone,    ///< the naive control: a body goes where its centre is, and nobody is warned
  kThesis,  ///< eq. 3.4, spheres, one top speed, frames not aligned
  kTight,   ///< the bound for aligned frames, spheres, one top speed
  kSwept,   ///< real shapes on predicted paths, a top speed for each body
};

/// What all nodes of a run agree on about auras.
struct AuraRules {
  AuraKind kind = AuraKind::kSwept;
  double step_s = 1.0 / 60;        ///< T_P
  int substeps = 4;                ///< S
  bool looks_once = false;         ///< what touches is found once a step, and who touches nothing falls on a parabola
  int lookahead = 1;               ///< K
  double top_speed_m_s = 32;       ///< V; promised by the user, used by kThesis and kTight
  double frame_s = 0.015;          ///< T_F
  double latency_s = 0.002;        ///< T_L
  double uncertainty = 0.5;        ///< U: share of its speed by which a body may leave its predicted path
  double contact_margin_m = 0.03;  ///< contacts begin at 0.02 (physics/), shapes are given to 1 mm, and a little more
  double reach_scale = 1;          ///< tests only: auras that are a little too small must fail
  double check_scale = 1;          ///< tests only: a check without its margin must miss something
  bool sweeps = false;             ///< physics finds what is in the way of fast bodies between two looks, too
  bool redo = false;               ///< what was computed with two bodies apart that touched is computed again
  Vec3 gravity = {0, 0, -9.81};    ///< m/s^2

  /// How often in a step it is found what touches.
  int looks() const { return looks_once ? 1 : substeps; }
  /// Does a look find what will touch before the next one (physics/soft/ahead.h)?
  bool looks_ahead() const { return looks_once && sweeps; }
  /// How often in a step of a path auras ask whether two bodies touch.
  int instants() const { return looks_ahead() ? 4 : looks(); }
};

/// One body's predicted motion from the state in which it was last known.
struct Path {
  PrototypeId prototype{};
  double radius_m = 0;
  Pose pose;
  Vec3 v_WB = Vec3::Zero();
  Vec3 w_WB = Vec3::Zero();
  bool moves = true;        ///< false: asleep, stays where it is
  double age_steps = 0;     ///< how long ago the state was known, seen from now
  double unborn_steps = 0;  ///< the body appears this many steps from now
  double speed_m_s = 0;     ///< top speed that it may come to have, for the uncertainty
  double blur_m = 0;        ///< its surface may be this far from where it seems: it was sent in few bytes
};

/// The path of one of our own bodies from its state now.
Path path_of(const BodyState& body, Step now, const ClearanceQuery& clearance);

/// A distance that grows with a speed.
struct Range {
  double fixed_m = 0;
  double per_speed_s = 0;
  double at(double speed_m_s) const { return fixed_m + per_speed_s * speed_m_s; }
};

class Aura {
 public:
  virtual ~Aura() = default;
  Aura(const Aura&) = delete;
  Aura& operator=(const Aura&) = delete;

  const AuraRules& rules() const { return rules_; }
  const ClearanceQuery& clearance() const { return clearance_; }

  /// Are others warned of bodies, and do bodies that may touch move together?
  virtual bool warns() const { return true; }
  /// Does each body have a path and a speed of its own, which others are sent and can rely on?
  virtual bool predicts() const { return false; }

  /// How much faster than its own speed a body that nothing pushes may become: 0.1 m/s; 0.05 m/s asleep. What gravity
  /// adds is in its path. The promised V where one top speed is all that is known.
  virtual double calm_speed(bool awake) const = 0;
  /// What it has besides, by itself, and can push others with: its own speed, and a kick that is on its way, m/s.
  virtual double own_speed_of(const BodyState& body) const = 0;
  /// Top speed that a body alone can have.
  double speed_of(const BodyState& body) const { return calm_speed(body.awake) + own_speed_of(body); }

  /// Do two bodies have to share a host? A foreign body and one of ours, seen now, looking h K - `fewer_steps` ahead.
  /// `hops` is the number of regions through which a pull can chain (1 away from corners).
  virtual bool meets(const Path& foreign, const Path& own, int hops, int fewer_steps = 0) const = 0;
  /// Do two bodies of one host have to move together?
  virtual bool linked(const Path& a, const Path& b, int hops) const = 0;
  /// A body sent away a moment ago and one of ours.
  virtual bool meets_ghost(const Path& ghost, const Path& own, int hops, int fewer_steps = 0) const = 0;

  /// A body whose surface is this near to another region's territory projects its aura (metres).
  /// `other_speed_m_s`, `other_radius_m`: the largest over there.
  double zone(double speed_m_s, int hops, double other_speed_m_s, double other_radius_m) const;
  /// A body projects to the host of a foreign one when their bounding spheres are this near, wherever it is. For the
  /// body's own speed.
  Range notice(double foreign_speed_m_s, double foreign_age_steps, int hops) const;
  /// Beyond this distance between bounding spheres neither meets() nor meets_ghost() is true for a foreign body. For
  /// drift_m_s() of the own one.
  Range meet_range(const Path& foreign, int hops) const;
  /// Largest distance between bounding spheres at which linked() can be true. For the sum of both speeds.
  Range link_range(int hops) const;
  /// How far apart two regions may be that have to listen to each other: the widest zone away from corners, also while
  /// ranks change, where everything is as fast as promised.
  double listening_distance_m(double largest_radius_m) const;

  /// How fast a body may leave the place where it is: on its path, and off it.
  double drift_m_s(const Path& path) const { return path.v_WB.norm() + rules_.uncertainty * path.speed_m_s; }
  /// Where a body of `path` is `steps` from now.
  Pose ahead(const Path& path, double steps) const;

 protected:
  /// Why two bodies are compared.
  enum class Question { kZone, kNotice, kMeeting, kLink };
  /// For how long each of the two is on its way before they have to share a host.
  struct Steps {
    double own = 0;
    double other = 0;  ///< besides the age of what is known of it, where paths are predicted
  };

  Aura(const AuraRules& rules, const ClearanceQuery& clearance)
      : rules_(rules), gravity_m_s2_(rules.gravity.norm()), clearance_(clearance) {}

  virtual Steps steps(Question question, int hops) const = 0;
  /// How far a body can come in so many steps, by its drift_m_s().
  virtual Range span(double steps) const = 0;
  /// One of the two may stand on something, and not fall as its span says.
  virtual double unfallen_m(double /*steps*/) const { return 0; }

  double gravity_m_s2() const { return gravity_m_s2_; }

 private:
  Range reach(const Steps& steps, double other_drift_m_s) const;
  double most_drift(double speed_m_s) const { return (1 + rules_.uncertainty) * speed_m_s; }
  Range by_speed(const Range& by_drift) const { return {by_drift.fixed_m, most_drift(by_drift.per_speed_s)}; }

  AuraRules rules_;
  double gravity_m_s2_;
  const ClearanceQuery& clearance_;
};

}  // namespace aurasim::core
