// When a node process tells whom what of the world that it computes (node/observation_feed.h), over topic observation
// (dds/observation_bus.h). Nothing is done while nobody asks.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "cli/observer_pace.h"
#include "config/launch.h"
#include "dds/observation_bus.h"
#include "node/node.h"
#include "node/observation_feed.h"

namespace aurasim::cli {

class ObservationPublisher {
 public:
  ObservationPublisher(const config::Launch& launch, dds::Participant& participant, core::RegionId region);

  void begin_generation(core::Generation generation, std::uint64_t map_version);
  /// The run goes back: states that were told are told again when they have been computed again.
  void put_back() { feed_.reset(); }
  /// After the first state and after every step.
  void after_step(node::Node& node, const node::StepReport& report);
  /// As often as you like while the run stands: the state in which it does, to whoever has not been told.
  void while_paused(node::Node& node);

 private:
  bool look(node::Node& node);
  /// False: it takes no more now.
  bool tell(node::Node& node, const dds::ObservationServer::Asked& asked);
  void tell_made_up(const node::Node& node, const node::StepReport& report);
  void tell_foreseen(node::Node& node);

  struct State {
    std::uint64_t arrivals = 0;
    core::Generation generation = 0;
    std::uint32_t redo = 0;
    core::Step step = -1;

    bool operator==(const State&) const = default;
  };
  struct Told {
    State state;
    std::size_t hand_offs = 0;  ///< that had come and did not take effect yet: what they bring was told, too
  };

  struct Served {
    Told told;  ///< last
    ObserverPace pace;
  };

  node::FeedSettings settings_;
  dds::ObservationServer server_;
  std::optional<node::ObservationFeed> feed_;  ///< while somebody asks
  std::map<std::uint64_t, Served> served_;     ///< by observer
  bool is_observed_ = false;
};

}  // namespace aurasim::cli
