// The regions that a region listens to; the same regions listen to it. Regions near it always do. Others do from an
// agreed state on, after a third region has introduced the two (docs/decisions/0003-listening-follows-bodies.md).
#pragma once

#include <span>
#include <vector>

#include "core/intake.h"
#include "core/vicinity.h"

namespace aurasim::core {

class Listening {
 public:
  /// Begins in state `start`. `earlier`: regions agreed on before a redo put the run back. Keeps references to
  /// `vicinity` and `intake`.
  Listening(Vicinity& vicinity, Intake& intake, int lookahead, Step start, std::span<const Listened> earlier);

  /// Adds regions that listen from the start. Call before the first state.
  void add(std::span<const Listened> regions);
  /// Takes in the introductions of our region, of those from batches that took effect since the last call.
  void receive(std::span<const Neighbour::Introduced> introductions);
  /// Adds the regions whose time has come in state `now`. Returns true if there are any; the next batch then has to be
  /// full.
  bool begin(Step now);

  /// All regions that listen now, besides those near us, ascending by region.
  std::span<const Listened> all() const { return all_; }
  /// Introduced regions that do not listen yet.
  std::vector<RegionId> expected() const;
  /// The regions of which both sides know when both have done state `then`, also those that do not listen yet. The same
  /// on both sides in every later state.
  std::vector<Listened> agreed(Step then) const;

 private:
  struct Expected {
    Listened who;
    Step introduced = 0;
  };
  void insert(const Listened& who);

  Vicinity& vicinity_;
  Intake& intake_;
  int lookahead_;
  Step start_;
  std::vector<Listened> all_;
  std::vector<Expected> expected_;
};

}  // namespace aurasim::core
