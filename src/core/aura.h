// The aura: how far ahead, and how far away, two bodies must know of each other so that they share a host before
// they can touch. Distances and their derivation: docs/design.md, "The aura and its reach". Each kind of aura is a
// class of its own (make_aura.h).
#pragma once

#include <algorithm>
#include <optional>

#include "core/body_state.h"
#include "core/clearance.h"
#include "core/horizon.h"

namespace aurasim::core {

enum class AuraKind : std::uint8_t {
  kNone,    ///< the naive control: a body goes to the owner of its centre, and nobody is warned of it
  kThesis,  ///< eq. 3.4 of the thesis: spheres, one top speed for all, frames not aligned
  kTight,   ///< the bound for aligned frames: spheres, one top speed for all
  kSwept,   ///< real shapes on predicted paths, a top speed for each body
};

/// Rules of auras. All nodes of a run have to have the same.
struct AuraRules {
  AuraKind kind = AuraKind::kSwept;
  double step_s = 1.0 / 60;   ///< T_P
  int substeps = 4;           ///< S
  bool looks_once = false;    ///< contacts are looked for once a step; a body that touches nothing falls on a parabola
  int lookahead = 1;          ///< K, steps
  double top_speed_m_s = 32;  ///< V; promised by the user, used by kThesis and kTight
  double frame_s = 0.015;     ///< T_F
  double latency_s = 0.002;   ///< T_L
  double uncertainty = 0.5;   ///< U: share of its speed by which a body may leave its predicted path
  /// contacts begin at a gap of 0.02 (physics/dispatcher.h); the rest covers shapes given to 1 mm, with a reserve
  double contact_margin_m = 0.03;
  double reach_scale = 1;        ///< tests only: auras that are a little too small must fail
  double check_scale = 1;        ///< tests only: a check without its margin must miss something
  bool sweeps = false;           ///< physics also finds what a fast body meets between two looks for contacts
  bool redo = false;             ///< states in which bodies of two nodes touched are computed again
  Vec3 gravity = {0, 0, -9.81};  ///< m/s^2

  /// How often contacts are looked for in a step.
  int looks() const { return looks_once ? 1 : substeps; }
  /// Does a look for contacts also find those that begin before the next look (physics/soft/ahead.h)?
  bool looks_ahead() const { return looks_once && sweeps; }
  /// The most hops of a pull for which clusters look ahead. Where states are checked, a pull that chains through a
  /// third region is left to a redo: each further hop lets links reach farther, and dense worlds come to be one cluster
  /// (docs/decisions/0033-no-pushes.md).
  int most_hops() const { return redo ? 1 : horizon::kMostHops; }
  /// Number of hops by which a cluster looks further ahead than usual before it goes home, and by which auras are
  /// announced earlier. It is 0 where states are checked: in dense worlds, clusters that are in no hurry fill the
  /// neighbours' regions (docs/decisions/0046-home-soon.md).
  int homeward_hops() const { return redo ? 0 : horizon::kHomewardHops; }
  /// At how many instants of each step of two paths an aura tests whether the bodies touch.
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
  double age_steps = 0;     ///< how old the known state is
  double unborn_steps = 0;  ///< the body appears this many steps from now
  double speed_m_s = 0;     ///< the stated speed; scales the uncertainty (Aura::speed_of)
  double blur_m = 0;  ///< how far its surface may be from where the path has it, because its aura was sent rounded
};

/// The path from state `now` on of what `body`, a BodyState or an AuraRecord, describes.
template <class Body>
Path path_from(const Body& body, bool moves, Step now, const ClearanceQuery& clearance) {
  Path path;
  path.prototype = body.prototype;
  path.radius_m = clearance.bounding_radius(body.prototype);
  path.pose = body.pose;
  path.v_WB = body.v_WB;
  path.w_WB = body.w_WB;
  path.moves = moves;
  path.unborn_steps = static_cast<double>(std::max<Step>(0, body.birth - now));
  return path;
}
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

  /// Are auras published, and do bodies that may touch move together?
  virtual bool warns() const { return true; }
  /// Do auras carry a path and a speed for each body, on which the receivers rely?
  virtual bool predicts() const { return false; }

  /// The speed that the body's aura states, m/s: it may leave its path at U times this speed. Kinds with one top speed
  /// return the promised V.
  virtual double speed_of(const BodyState& body) const = 0;

  /// Do a foreign body and one of ours have to share a host? Looks h K steps ahead from now. `hops` (h) is the
  /// number of regions through which a pull can chain (1 away from corners).
  virtual bool meets(const Path& foreign, const Path& own, int hops) const = 0;
  /// Do two bodies of one host have to move together (belong to one cluster)?
  virtual bool linked(const Path& a, const Path& b, int hops) const = 0;
  /// Like meets(), for a ghost (a body that was just handed over) and one of ours.
  virtual bool meets_ghost(const Path& ghost, const Path& own, int hops) const = 0;

  /// A body whose surface is this near to another region's territory projects its aura (metres). `other_speed_m_s`,
  /// `other_radius_m`: the largest of the other region's bodies.
  double zone(double speed_m_s, int hops, double other_speed_m_s, double other_radius_m) const;
  /// A body projects to the host of a foreign one when their bounding spheres are this near, wherever they are.
  /// Evaluate the range at the own body's speed.
  Range notice(double foreign_speed_m_s, double foreign_age_steps, int hops) const;
  /// May a foreign body and one of ours come together so soon that ours has to be announced to that one's host? Only
  /// asked within notice().
  virtual bool may_approach(const Path& /*foreign*/, const Path& /*own*/, int /*hops*/) const { return true; }
  /// Beyond this distance between bounding spheres neither meets() nor meets_ghost() is true for a foreign body.
  /// Evaluate the range at drift_m_s() of the own body.
  Range meet_range(const Path& foreign, int hops) const;
  /// Largest distance between bounding spheres at which linked() can be true. Evaluate the range at the sum of both
  /// speeds.
  Range link_range(int hops) const;
  /// Regions at most this far apart have to listen to each other: the widest zone away from corners, for bodies at the
  /// promised top speed.
  double listening_distance_m(double largest_radius_m) const;

  /// How fast a body may leave its present place, along its path and off it, m/s.
  double drift_m_s(const Path& path) const { return path.v_WB.norm() + rules_.uncertainty * path.speed_m_s; }
  /// Place of the body of `path`, `steps` from now.
  Vec3 place_ahead(const Path& path, double steps) const;
  /// Pose of the body of `path`, `steps` from now.
  Pose ahead(const Path& path, double steps) const;

 protected:
  /// Why two bodies are compared.
  enum class Question { kZone, kNotice, kMeeting, kLink };
  /// For how many steps each of the two bodies moves before they have to share a host.
  struct Steps {
    double own = 0;
    double other = 0;  ///< where paths are predicted, the age of its known state is added
  };

  Aura(const AuraRules& rules, const ClearanceQuery& clearance)
      : rules_(rules), gravity_m_s2_(rules.gravity.norm()), clearance_(clearance) {}

  virtual Steps steps(Question question, int hops) const = 0;
  /// How far a body can come in so many steps; evaluate the range at its drift_m_s().
  virtual Range span(double steps) const = 0;
  /// Extra distance (m), because one of the two may stand on something and not fall as span() assumes.
  virtual double unfallen_m(double /*steps*/) const { return 0; }

  double gravity_m_s2() const { return gravity_m_s2_; }

 private:
  double time_ahead(const Path& path, double steps) const;
  Range reach(const Steps& steps, double other_drift_m_s) const;
  double most_drift(double speed_m_s) const { return (1 + rules_.uncertainty) * speed_m_s; }
  Range by_speed(const Range& by_drift) const { return {by_drift.fixed_m, most_drift(by_drift.per_speed_s)}; }

  AuraRules rules_;
  double gravity_m_s2_;
  const ClearanceQuery& clearance_;
};

}  // namespace aurasim::core
