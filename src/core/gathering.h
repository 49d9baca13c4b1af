// The seeing half of the protocol: which of our bodies belong together, which of them are touched by auras from
// elsewhere, and which have to be announced. Looks at one state; remembers nothing but its buffers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/cluster.h"
#include "core/messages.h"
#include "core/neighbour.h"
#include "core/ranks.h"
#include "core/vicinity.h"

namespace aurasim::core {

class Gathering {
 public:
  struct Foreign {
    BodyId id;
    Path path;
    RegionId host;
    bool ghost;
    bool born;      ///< in the state that its aura describes
    Strike strike;  ///< what it may do to whom it hits
  };
  /// A foreign body and one of ours that may meet: indices of foreign() and path().
  struct Pair {
    std::uint32_t foreign;
    std::uint32_t own;
  };

  Gathering(const Aura& aura, const Vicinity& vicinity);

  /// Looks at a state, given what the neighbours have said and our own ghosts (bodies just sent away).
  void look(const Snapshot& snapshot, std::span<const Neighbour> neighbours, std::span<const AuraRecord> ghosts,
            const Ranks& ranks);

  const Clusters& clusters() const { return clusters_; }
  const Path& path(std::uint32_t i) const { return paths_[i]; }
  BodyId id(std::uint32_t i) const { return ids_[i]; }

  /// Is body i near enough to another region, or to a foreign body, that others have to know of it?
  bool must_be_announced(std::uint32_t i) const;
  /// No part of the body's bounding sphere is over its host's region (kNone: its centre is not).
  bool outside(std::uint32_t i) const;
  /// An aura from elsewhere has met the cluster of body i.
  bool touched(std::uint32_t i) const { return touched_[clusters_.of(i)] != 0; }
  /// An aura from elsewhere may meet the cluster soon enough that another node could already be sending bodies here
  /// because of it. Only known for bodies outside our region; whoever goes home then would pass them on the way.
  bool expected(std::uint32_t i) const { return expected_[clusters_.of(i)] != 0; }
  /// The highest-ranked host among the auras that met the cluster and outrank us; our own region if there is none.
  RegionId pulled_to(std::uint32_t i) const { return pulled_to_[clusters_.of(i)]; }

  /// A foreign aura is near body i.
  bool noticed(std::uint32_t i) const { return noticed_[i] != 0; }
  std::span<const Pair> pairs() const { return pairs_; }
  const Foreign& foreign(std::uint32_t i) const { return foreign_[i]; }

  std::size_t foreign_auras() const { return foreign_.size(); }
  double top_speed() const { return clusters_.near().top_speed(); }
  double top_radius() const { return clusters_.near().top_radius(); }

 private:
  void measure(const Snapshot& snapshot);
  void gather_foreign(const Snapshot& snapshot, std::span<const Neighbour> neighbours,
                      std::span<const AuraRecord> ghosts);
  void add_foreign(const AuraRecord& aura, Step known, Step now);
  void index_foreign();
  void mark_regions(int hops_each);
  void complete_near_boundaries();
  void pair_up();
  void notice(const Foreign& foreign);
  void notice_grown();
  void notice_again(std::uint32_t own);
  void note(std::uint32_t own, std::uint64_t region);
  void hear_news();
  void find_pairs();
  void pair_again(std::uint32_t own);
  template <class Visit>
  void for_each_foreign_near(std::uint32_t own, Visit&& visit) const;
  std::size_t take_hits(std::size_t first);
  Strike strike_of(const AuraRecord& aura) const;
  void judge(const Ranks& ranks);
  void judge(const Pair& pair, const Ranks& ranks);
  bool meets(const Foreign& foreign, const Path& own, int hops, int fewer_steps = 0) const;
  double band(double speed_m_s, int hops) const;

  const Aura& aura_;
  const Vicinity& vicinity_;
  Clusters clusters_;
  std::vector<BodyId> ids_;
  std::vector<Path> paths_;
  std::vector<double> speeds_, own_speeds_;
  std::vector<std::uint64_t> regions_;
  std::vector<RegionId> live_;  ///< neighbours that can take a cluster, ascending
  std::vector<Foreign> foreign_;
  std::vector<Path> foreign_paths_;
  NearIndex near_foreign_;
  double oldest_foreign_steps_ = 0;
  double most_foreign_blur_m_ = 0;
  std::vector<Pair> pairs_;
  std::vector<Aura::Range> ranges_;  ///< of one foreign body, by hops
  struct News {
    std::uint32_t own;
    std::uint64_t region;
  };
  std::vector<News> news_;              ///< our bodies that have been noticed by a region, and did not know
  std::vector<std::uint32_t> grown_;    ///< of our bodies, whose range has grown
  std::vector<std::uint32_t> changed_;  ///< likewise, since the pairs were found
  std::vector<std::uint32_t> near_;
  std::vector<double> drifts_;  ///< Aura::drift_m_s
  std::vector<std::uint8_t> noticed_;
  std::vector<std::uint64_t> noticed_by_;        ///< bits of regions
  std::vector<std::uint8_t> group_noticed_;      ///< by group of bodies near each other: all of them are
  std::vector<std::uint64_t> group_noticed_by_;  ///< regions that all of them are noticed by
  std::vector<std::uint8_t> touched_;            ///< by cluster
  std::vector<std::uint8_t> expected_;           ///< by cluster
  std::vector<RegionId> pulled_to_;              ///< by cluster
  int fewer_steps_ = 0;                          ///< how much less far than h K meetings are looked for
  double widest_band_m_ = 0;                     ///< beyond it, no body is near another region
  double others_top_speed_ = 0;
  double others_top_radius_ = 0;
};

}  // namespace aurasim::core
