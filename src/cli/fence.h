// When a node has to stop because the rest of the run may go on without it: the others hold it for dead, it was held up
// for so long that they may, or it has lost touch with the majority. Two hosts of one body are worse than none. Time is
// passed in.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "node/quorum.h"

namespace aurasim::cli {

struct FenceSettings {
  core::RegionId region{};
  std::uint32_t regions = 1;  ///< of the run
  bool can_be_cut = false;    ///< the others may be on other hosts
  bool never_waits = false;   ///< free_running
  /// Nobody goes on without a node unless another process has taken its region over: who is cut off stands, and waits.
  bool recovers = false;
};

class Fence {
 public:
  using Clock = std::chrono::steady_clock;

  /// Asked only when there is something to find out.
  struct Senses {
    std::function<bool()> was_held_up;                                ///< for longer than its participant's lease
    std::function<std::map<core::RegionId, node::PeerSign>()> peers;  ///< all regions but this one
  };

  Fence(const FenceSettings& settings, Senses senses);

  /// True while the node may compute its next state. `held_for_dead`: by a neighbour. `dead`: neighbours that it holds
  /// for dead itself. Cheap while there are none.
  bool open(bool held_for_dead, const std::vector<core::RegionId>& dead, Clock::time_point now);
  /// Hears too few of the others to know what they do.
  bool is_cut_off() const { return standing_ == node::Standing::kCutOff; }
  /// For good: the node has to stop.
  bool closed() const { return !reason_.empty(); }
  /// `reason`: for people.
  void close(std::string reason) { reason_ = std::move(reason); }
  /// The node stands, because somebody has died: what was judged before that does not count any more, and every call
  /// judges anew. With `recovers` the statuses alone say from then on who is lost.
  void watch_closely() { watches_closely_ = true; }
  /// All regions have nodes again. With `recovers` or without, from now on.
  void begin_anew(bool recovers);
  /// Why it is closed, for people.
  const std::string& reason() const { return reason_; }

 private:
  std::string why_stop(bool held_for_dead, const std::vector<core::RegionId>& dead, Clock::time_point now);
  void look(const std::vector<core::RegionId>& dead, Clock::time_point now);

  FenceSettings settings_;
  Senses senses_;
  node::Quorum quorum_;
  node::Standing standing_ = node::Standing::kGoOn;
  bool watches_closely_ = false;
  std::size_t dead_ = 0;  ///< neighbours when last looked
  Clock::time_point next_look_;
  std::string reason_;
};

}  // namespace aurasim::cli
