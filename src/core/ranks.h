// Ranks: of two hosts whose bodies may meet, the higher one keeps its own and gets the other's. The thesis ranks by
// region alone. Here a node with a large cluster ranks higher, because moving that cluster costs more than moving what
// it meets (docs/decisions/0016-ranks.md). A claim is made long before it counts, so that all nodes change ranks in the
// same state.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"

namespace aurasim::core {

struct RankClaim {
  /// Weight of a node that yields. It hosts a large cluster that lies in another region and can only go home to a
  /// higher node.
  static constexpr std::uint8_t kYields = 0;
  /// Weight of a node that claims nothing.
  static constexpr std::uint8_t kNothing = 1;

  std::uint8_t weight = kNothing;
  Step stamp = 0;  ///< state in which the claim was made

  bool operator==(const RankClaim&) const = default;
};

/// The last two claims of a node: `next` counts from next.stamp + horizon::rank_notice on, `held` until then.
struct RankClaims {
  RankClaim held;
  RankClaim next;
};

/// The ranks of a node and of its neighbours in one state.
class Ranks {
 public:
  explicit Ranks(int lookahead) : lookahead_(lookahead) {}

  /// Starts state `now` of node `self`. Then call add() for each live neighbour.
  void begin(Step now, RegionId self, const RankClaims& claims);
  void add(RegionId region, const RankClaims& claims) { nodes_.push_back({region, claims}); }

  /// Do bodies of ours that may meet one of `host`'s bodies go to it? False for K - 1 states after it came to outrank
  /// us, because the last bodies that it sent us may still be under way.
  bool pulls(RegionId host) const;
  /// Does `a` rank higher than `b` now? Of two hosts that pull, bodies go to the higher one.
  bool outranks(RegionId a, RegionId b) const { return outranks(a, b, now_); }
  /// Are two of the nodes about to change ranks, or have they just done so? A pull that begins now may have to wait and
  /// to come all the way back, so pulls have to begin earlier.
  bool changing() const;

  /// Will our node rank highest once all claims made so far count?
  bool on_top() const;
  /// The largest weight that another node has claimed last.
  std::uint8_t most_of_others() const;

 private:
  struct Node {
    RegionId region;
    RankClaims claims;
  };
  const Node& node(RegionId region) const;
  const RankClaim& claim(const Node& node, Step n) const;
  bool outranks(RegionId a, RegionId b, Step n) const { return outranks(node(a), node(b), n); }
  bool outranks(const Node& a, const Node& b, Step n) const;
  bool changes(const Node& node, Step from) const;

  int lookahead_;
  Step now_ = 0;
  std::vector<Node> nodes_;  ///< our node first
};

/// Decides which rank a node claims for itself.
class RankClaimer {
 public:
  /// The largest clusters of a node, in bodies.
  struct LargeClusters {
    std::size_t near = 0;    ///< largest cluster that other nodes could pull
    std::size_t guests = 0;  ///< largest cluster that lies mostly outside our region
  };
  /// Smaller clusters do not count as large.
  static constexpr std::size_t kLeastBodies = 256;

  /// `shuffle_steps` > 0, tests only: claims another weight every so many steps, whatever the clusters are.
  RankClaimer(RegionId self, int lookahead, Step shuffle_steps)
      : self_(self), lookahead_(lookahead), shuffle_steps_(shuffle_steps) {}

  const RankClaims& claims() const { return claims_; }
  /// Makes a new claim if our largest cluster is much larger than what the nodes above us have claimed. Where K = 1,
  /// yields if a large cluster of another region stays here.
  void reconsider(Step now, const LargeClusters& large, const Ranks& ranks);

 private:
  std::uint8_t wanted_weight(Step now, const LargeClusters& large, const Ranks& ranks);
  bool yields(Step now, std::size_t guests, const Ranks& ranks);

  RegionId self_;
  int lookahead_;
  Step shuffle_steps_;
  RankClaims claims_;
  bool claimed_ = false;  ///< a claim has been made
  Step last_large_ = 0;   ///< last state in which the largest cluster was nearly as large as claimed
  Step alone_ = 0;        ///< last state without a large cluster of another region here
  Step last_guests_ = 0;  ///< last state with such a cluster
};

}  // namespace aurasim::core
