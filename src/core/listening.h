// The regions that a region listens to; the same regions listen to it. Regions near it always do. Others do from an
// agreed state on, after a third region has introduced the two, until an agreed state after the last introduction
// (docs/decisions/0059-listening-ends.md).
#pragma once

#include <span>
#include <vector>

#include "core/intake.h"
#include "core/vicinity.h"

namespace aurasim::core {

class Listening {
 public:
  /// Begins in state `start`. `earlier`: regions agreed on before a redo put the run back. Keeps references to
  /// `vicinity` and `intake`. `ends`: false: whoever listens once does so for ever.
  Listening(Vicinity& vicinity, Intake& intake, int lookahead, Step start, std::span<const Listened> earlier,
            bool ends);

  /// Adds regions that listen from the start. Call before the first state.
  void add(std::span<const Listened> regions);
  /// Takes in the introductions of our region, of those from batches that took effect since the last call, our own
  /// included.
  void receive(std::span<const Neighbour::Introduced> introductions);
  /// Adds the regions whose time has come in state `now`, and removes those whose time is over. Returns true if any has
  /// come; the next batch then has to be full.
  bool begin(Step now);

  /// All regions that listen now, besides those near us, ascending by region.
  std::span<const Listened> all() const { return all_; }
  /// Introduced regions that do not listen yet.
  std::vector<RegionId> expected() const;
  /// Does region `id` listen until whatever is handed to it in state `now` has been acknowledged?
  bool stays(RegionId id, Step now) const;
  /// The regions of which both sides know when both have done state `then`, also those that do not listen yet, and
  /// those that listened in state `cut` or later. The same on both sides in every later state.
  std::vector<Listened> agreed(Step then, Step cut) const;

 private:
  struct Expected {
    Listened who;
    Step introduced = 0;
  };
  struct Ended {
    Listened who;
    Step end = 0;  ///< the first state in which it did not listen
  };
  /// The newest introduction of a region that listens.
  struct Use {
    RegionId region{};
    Step counted = 0;              ///< of those of which both sides know, lookahead states after their stamps
    Step newest = 0;               ///< of all
    std::vector<Step> fresh = {};  ///< stamps of those that do not count yet, ascending
  };
  void insert(const Listened& who, Step used);
  void expect(const Listened& who, Step introduced);
  void note_use(RegionId other, Step stamp);
  bool may_end(RegionId id) const { return ends_ && !vicinity_.are_near(vicinity_.self, id); }
  void end(Step now);
  /// The last time that region `id` listened; null: it never ended to.
  const Ended* ended(RegionId id) const;

  Vicinity& vicinity_;
  Intake& intake_;
  int lookahead_;
  Step start_;
  bool ends_;
  std::vector<Listened> all_;
  std::vector<Expected> expected_;
  std::vector<Use> uses_;     ///< of regions that may end to listen
  std::vector<Ended> ended_;  ///< the last time of each region
};

}  // namespace aurasim::core
