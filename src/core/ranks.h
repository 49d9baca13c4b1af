// Of two hosts whose bodies may meet, the one that ranks higher keeps its own and gets the other's. The thesis ranks by
// region alone; here a node whose bodies hang together in a large cluster ranks higher, because moving that costs more
// than moving what it meets (docs/decisions/0016-ranks.md). Ranks are claimed long before they count, so that all nodes
// change them in the same state.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"

namespace aurasim::core {

struct RankClaim {
  /// Of a node that yields: it hosts a large cluster of somebody else's region, which can only go home to a higher
  /// node.
  static constexpr std::uint8_t kYields = 0;
  /// Of a node that claims nothing.
  static constexpr std::uint8_t kNothing = 1;

  std::uint8_t weight = kNothing;
  Step stamp = 0;  ///< when it was made

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

  /// Starts state `now` of node `self`; then one add() for each that is alive.
  void begin(Step now, RegionId self, const RankClaims& claims);
  void add(RegionId region, const RankClaims& claims) { nodes_.push_back({region, claims}); }

  /// Bodies of ours go to `host` if they may meet one of its bodies. Not for K - 1 states after it came to outrank us:
  /// the last bodies that it sent us may still be under way.
  bool pulls(RegionId host) const;
  /// Of two that pull, bodies go to the higher one.
  bool outranks(RegionId a, RegionId b) const { return outranks(a, b, now_); }
  /// Two of the nodes are about to change places, or just have: a pull that begins now may have to wait, and to come
  /// all the way back. So it has to begin earlier.
  bool changing() const;

  /// Once all claims that have been made count: are we the highest?
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
  std::vector<Node> nodes_;  ///< ours first
};

/// What a node claims for itself.
class RankClaimer {
 public:
  /// The largest clusters of a node, in bodies.
  struct LargeClusters {
    std::size_t near = 0;    ///< others could pull it
    std::size_t guests = 0;  ///< most of it is outside our region
  };
  /// Smaller ones do not count.
  static constexpr std::size_t kLeastBodies = 256;

  /// `shuffle_steps` > 0, tests only: another weight every so many steps, whatever the clusters are.
  RankClaimer(RegionId self, int lookahead, Step shuffle_steps)
      : self_(self), lookahead_(lookahead), shuffle_steps_(shuffle_steps) {}

  const RankClaims& claims() const { return claims_; }
  /// Claims anew if our clusters ask for it: if they are much larger than what anyone who is above us has claimed.
  /// Where K = 1, yields if a large cluster of guests stays.
  void reconsider(Step now, const LargeClusters& large, const Ranks& ranks);

 private:
  std::uint8_t wanted_weight(Step now, const LargeClusters& large, const Ranks& ranks);
  bool yields(Step now, std::size_t guests, const Ranks& ranks);

  RegionId self_;
  int lookahead_;
  Step shuffle_steps_;
  RankClaims claims_;
  bool claimed_ = false;  ///< ever
  Step last_large_ = 0;   ///< when the largest cluster last was nearly as large as claimed
  Step alone_ = 0;        ///< when no large cluster of guests was here last
  Step last_guests_ = 0;  ///< when one was
};

}  // namespace aurasim::core
