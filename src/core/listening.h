// Whom a region listens to, and who listens to it: the same regions. Those that are near it, always, and others from an
// agreed state on, because a third region has introduced the two (decisions/0003-listening-follows-bodies.md).
#pragma once

#include <span>
#include <vector>

#include "core/intake.h"
#include "core/vicinity.h"

namespace aurasim::core {

class Listening {
 public:
  /// Of state `start` on. `earlier`: what is known of a run that was put back. Keeps references.
  Listening(Vicinity& vicinity, Intake& intake, int lookahead, Step start, std::span<const Listened> earlier);

  /// Before the first state: these, too.
  void add(std::span<const Listened> regions);
  /// Those that neighbours have introduced to us in the batches that took effect since the last call.
  void receive();
  /// True when there are any who listen from state `now` on: they are told of all our auras.
  bool begin(Step now);

  /// By region, ascending.
  std::span<const Listened> all() const { return all_; }
  /// Those whose time has not come yet.
  std::vector<RegionId> expected() const;
  /// All of whom both sides know when state `now` is done, also those whose time has not come yet.
  std::vector<Listened> agreed(Step now) const;

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
