// The matching half of the protocol (interest matching). Finds which of our bodies belong together, which foreign auras
// they meet, and which have to be announced. What it finds follows from one state; where a snapshot names what has
// changed since the one before, it looks at nothing else but what is near other regions or foreign bodies.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/cluster.h"
#include "core/foreign.h"
#include "core/messages.h"
#include "core/neighbour.h"
#include "core/own_bodies.h"
#include "core/redo.h"
#include "core/vicinity.h"

namespace aurasim::core {

class InterestMatching {
 public:
  /// A foreign body and one of ours that may meet, as indices of foreign() and path().
  struct Pair {
    std::uint32_t foreign;
    std::uint32_t own;
  };

  /// `together`: pairs, a < b, that are treated as if their auras met until TogetherPair::until, so that they share a
  /// host.
  InterestMatching(const Aura& aura, const Vicinity& vicinity, std::span<const TogetherPair> together = {});

  /// Looks at a state, given what the neighbours have published and our own ghosts (bodies just sent away).
  void look(const Snapshot& snapshot, std::span<const Neighbour> neighbours, std::span<const AuraRecord> ghosts);

  const Clusters& clusters() const { return clusters_; }
  const OwnBodies& own() const { return own_; }
  const Path& path(std::uint32_t i) const { return own_.path(i); }
  BodyId id(std::uint32_t i) const { return own_.id(i); }
  /// Bodies that may have an audience, or be outside; ascending. All others have none and are inside.
  std::span<const std::uint32_t> near_others() const { return near_others_; }

  /// The regions that have to know of body i, because it is near their territory or near a body that they host.
  Audience audience(std::uint32_t i) const { return audiences_[i]; }
  /// No part of the body's bounding sphere is over its host's region (kNone: its centre is not).
  bool outside(std::uint32_t i) const;
  /// All bodies of which outside() is true; ascending.
  std::span<const std::uint32_t> all_outside() const { return outside_; }
  /// An aura from elsewhere has met the cluster of body i.
  bool touched(std::uint32_t i) const { return verdict(i).touched; }
  /// A foreign aura may meet the cluster so soon that another node could already be sending bodies here because of it.
  /// A cluster that goes home then would pass them on the way. Only known for bodies outside our region, and where
  /// states are not checked: elsewhere a redo costs less than such clusters that stay.
  bool expected(std::uint32_t i) const { return verdict(i).expected; }
  /// The lowest host among the auras that met the cluster, if it is lower than ours; otherwise our own region.
  RegionId pulled_to(std::uint32_t i) const { return verdict(i).pulled_to; }

  std::span<const Pair> pairs() const { return pairs_; }
  const Foreign& foreign(std::uint32_t i) const { return foreign_[i]; }

  const ForeignBodies& all_foreign() const { return foreign_; }
  double others_top_speed() const { return others_top_speed_; }
  std::size_t foreign_auras() const { return foreign_.size(); }
  double top_speed() const { return own_.top_speed(); }
  double top_radius() const { return own_.top_radius(); }

 private:
  /// One of our bodies, with what a search for foreign bodies near it needs.
  struct Candidate {
    Vec3 p_WB;
    double radius_m;
    double speed_m_s;  ///< speed at which ranges are evaluated
    std::size_t hops;  ///< hops at which ranges are evaluated
    std::uint32_t own;
  };

  /// What foreign auras make of a cluster.
  struct Verdict {
    RegionId pulled_to;
    bool touched = false;
    bool expected = false;
  };
  const Verdict& verdict(std::uint32_t i) const { return verdicts_[clusters_.of(i)]; }

  void clear_marks();
  void clear_verdicts();
  void form_clusters(const Snapshot& snapshot);
  void gather_foreign(const Snapshot& snapshot, std::span<const Neighbour> neighbours,
                      std::span<const AuraRecord> ghosts);
  void find_zones();
  Audience zone_of(std::uint32_t i);
  bool is_out_alone(const Vec3& p) const;
  void notice();
  void notice(const ForeignBlock& block);
  void announce(std::uint32_t own, Audience regions);
  void find_pairs(const ForeignBlock& block);
  bool is_in_range(std::size_t k, const Candidate& own) const;
  Candidate candidate(std::uint32_t own, double speed_m_s, int more_hops) const;
  template <class RangeOf>
  void take_ranges(const ForeignBlock& block, RangeOf&& range_of);
  double widest_range(double speed_m_s) const;
  void judge();
  void judge(const Pair& pair);
  void complete_who_may_leave();
  void judge_expected(const Pair& pair);
  void hit(std::uint32_t own, RegionId host);
  bool pulls_from(RegionId host, RegionId other) const;
  int homeward_hops() const { return aura_.rules().homeward_hops(); }
  void bring_together(const Snapshot& snapshot);
  bool meets(const Foreign& foreign, const Path& own, int hops) const;
  double band(double speed_m_s, int hops) const;

  const Aura& aura_;
  const Vicinity& vicinity_;
  std::span<const TogetherPair> together_;
  std::vector<Contact> joined_;           ///< our pairs that a redo holds together
  std::vector<std::uint32_t> expecting_;  ///< our bodies whose partner in a together_ pair is to come to the same host
  std::vector<Pair> together_pairs_;      ///< the together_ pairs of a foreign body and one of ours
  Clusters clusters_;
  OwnBodies own_;
  std::vector<std::uint32_t> near_others_;
  std::vector<RegionId> live_;  ///< neighbours that can take a cluster, ascending
  ForeignBodies foreign_;
  std::vector<Pair> pairs_;
  struct Place {
    Vec3 p_WB;
    double radius_m;
  };
  std::vector<Place> places_;             ///< of the bodies of the block
  std::vector<Range> ranges_;             ///< by foreign body of the block, then by hops
  std::size_t ranges_each_ = 0;           ///< entries of ranges_ for each body, from one hop on
  std::vector<Candidate> candidates_;     ///< our bodies that may be in range of a block
  std::vector<Audience> audiences_;       ///< by body: regions that have to know of it
  std::vector<std::uint8_t> hops_;        ///< by body: how many hops it looks ahead
  std::vector<std::uint32_t> outside_;    ///< our bodies outside of our region; ascending
  std::vector<std::uint32_t> announced_;  ///< bodies that others have to know of for other reasons than their place
  struct Hit {
    std::uint32_t own;
    RegionId host;
  };
  std::vector<Hit> hits_;              ///< our bodies that met an aura, and its host
  std::vector<Verdict> verdicts_;      ///< by cluster
  std::vector<std::uint32_t> judged_;  ///< clusters of which the verdict says something
  double others_top_speed_ = 0;
  double others_top_radius_ = 0;
};

}  // namespace aurasim::core
