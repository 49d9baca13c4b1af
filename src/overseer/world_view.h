// Puts one world together from what its regions publish of their parts (core/replica.h). No clock, no thread, no wire:
// the caller passes in replicas and the time.
//
// The host with the highest epoch owns a body. A body that its host has handed over keeps its last pose until the new
// host publishes it, so it neither vanishes nor doubles. A key frame corrects what was missed.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/replica.h"
#include "overseer/world_frame.h"

namespace aurasim::overseer {

struct ViewSettings {
  std::size_t region_count = 1;
  /// A body that no host has published for this many states is gone: its host died, or its removal was missed.
  core::Step unclaimed_patience = 180;
  /// How long a tick waits for regions that have not published theirs.
  double wait_s = 0.3;
};

/// Counters since the start.
struct ViewCounters {
  std::uint64_t frames = 0;
  std::uint64_t gaps = 0;        ///< ticks of a region that never arrived
  std::uint64_t incomplete = 0;  ///< frames composed without a region that is alive
  std::uint64_t stale = 0;       ///< rows that a higher epoch or a newer state had overtaken
  std::uint64_t given_up = 0;    ///< bodies removed because no host published them
};

class WorldView {
 public:
  explicit WorldView(const ViewSettings& settings);

  /// Takes in a replica. Replicas of one source must come in order of their ticks; key frames and different sources may
  /// come in any order.
  void accept(core::Replica replica, double now_s);

  /// State of a region. A live one is waited for. The bodies of a dead one are removed unless others claim them.
  enum class RegionState : std::uint8_t { kAbsent, kLive, kDead };
  void set_region(core::RegionId region, RegionState state);

  /// The next frame, if every live region has published its tick or the wait is over; null otherwise. Call until null.
  /// Valid until the next call.
  const WorldFrame* compose(double now_s);

  core::Generation generation() const { return generation_; }
  core::Step stamp() const { return stamp_; }
  /// True when a key frame of this generation has been received from the region, so that all its bodies are here.
  bool is_whole(core::RegionId region) const { return sources_.at(core::value_of(region)).is_whole; }
  std::size_t body_count() const { return slots_.size(); }
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const Body& body : bodies_) {
      if (body.alive) visit(static_cast<const ViewBody&>(body));
    }
  }
  /// Returns a body; null if there is none.
  const ViewBody* find(core::BodyId id) const;
  const ViewCounters& counters() const { return counters_; }

 private:
  struct Body : ViewBody {
    bool alive = false;
    core::Step stamp = 0;                                                            ///< state of the pose
    core::Step unclaimed_since = -1;                                                 ///< -1: its host claims it
    bool created = false, host_changed = false, moved = false, handed_over = false;  ///< since the last frame
  };
  struct Pending {
    core::Replica replica;
    double came_s = 0;
  };
  struct Source {
    RegionState state = RegionState::kAbsent;
    core::Step published = -1;
    std::uint64_t sequence = 0;
    bool is_whole = false;
    std::deque<Pending> pending;  ///< by stamp; deltas before key frames
  };
  struct Tombstone {
    core::Epoch epoch = 0;
    core::Step since = 0;
  };

  void begin_generation(core::Generation generation);
  std::optional<core::Step> oldest_pending() const;
  bool is_ready(core::Step stamp, double now_s);
  void apply(const core::Replica& replica);
  void apply_row(const core::ReplicaBody& row, const core::Replica& replica);
  void take_row(Body& body, const core::ReplicaBody& row, const core::Replica& replica);
  void create(const core::ReplicaBody& row, const core::Replica& replica);
  void apply_removal(const core::RemovedBody& removed);
  void doubt_missing(const core::Replica& key_frame);
  void doubt(Body& body, core::Step since);
  void give_up_the_unclaimed();
  void erase(Body& body);
  void touch(Body& body);
  Slot free_slot();
  void write_frame();

  ViewSettings settings_;
  std::vector<Source> sources_;
  std::vector<Body> bodies_;  ///< by slot
  std::unordered_map<core::BodyId, Slot> slots_;
  std::vector<Slot> free_;       ///< slots that may be reused
  std::vector<Slot> unclaimed_;  ///< slots of unclaimed bodies; some may be claimed again
  std::vector<Slot> touched_;    ///< slots that changed since the last frame
  std::unordered_map<core::BodyId, Tombstone> tombstones_;
  core::Generation generation_ = 0;
  core::Step stamp_ = -1;
  bool restart_ = true;
  WorldFrame frame_;
  ViewCounters counters_;
};

}  // namespace aurasim::overseer
