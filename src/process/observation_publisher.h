// Publishes to each observer what it asked for of the node's world (node/observation_feed.h), over topic observation
// (dds/observation_bus.h). Does nothing while nobody observes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "config/launch.h"
#include "dds/observation_bus.h"
#include "node/node.h"
#include "node/observation_feed.h"
#include "process/held_back.h"
#include "process/observer_pace.h"

namespace aurasim::process {

class ObservationPublisher {
 public:
  ObservationPublisher(const config::Launch& launch, dds::Participant& participant, core::RegionId region);

  void begin_generation(core::Generation generation, std::uint64_t map_version);
  /// To be called when the run goes back to state `step`. Later states that have not been published yet are published
  /// when they have been computed again.
  void put_back(core::Step step, core::Step confirmed);
  /// To be called after the first state and after every step.
  void after_step(node::Node& node, const node::StepReport& report);
  /// Publishes the state in which the run is paused to observers that have not received it. May be called as often as
  /// wanted.
  void while_paused(node::Node& node);

 private:
  bool look(node::Node& node);
  void hold_present_state(node::Node& node);
  core::Observation compose(node::Node& node, const core::Interest& interest) const;
  void hold_made_up(const node::Node& node, const node::StepReport& report);
  void publish_foreseen(node::Node& node);

  struct State {
    std::uint64_t arrivals = 0;
    core::Generation generation = 0;
    std::uint32_t redo = 0;
    core::Step step = -1;

    bool operator==(const State&) const = default;
    /// Is `later` a later state for the same observer in the same world?
    bool goes_on_with(const State& later) const {
      return arrivals == later.arrivals && generation == later.generation && step < later.step;
    }
  };
  bool publish(std::uint64_t observer, const State& state, core::Observation& observation);
  struct Published {
    State state;
    std::size_t hand_offs = 0;  ///< hand-offs that had come without effect yet; their bodies were published, too
  };

  struct Served {
    Published published;  ///< what was published last
    ObserverPace pace;
  };

  node::FeedSettings settings_;
  dds::ObservationServer server_;
  std::optional<node::ObservationFeed> feed_;  ///< set while somebody observes
  std::map<std::uint64_t, Served> served_;     ///< by observer
  HeldBack held_;
  bool is_observed_ = false;
};

}  // namespace aurasim::process
