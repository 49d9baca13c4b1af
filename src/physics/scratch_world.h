// A world in which clusters that arrive late make up the states that they have missed.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "physics/simulation.h"

namespace aurasim::physics {

/// A world in which the states that a late body missed are computed. It is empty between two uses, and its Simulation
/// is created at the first use.
class ScratchWorld {
 public:
  ScratchWorld(const core::Scene& scene, const Settings& settings, std::shared_ptr<const ShapeSet> shapes,
               std::shared_ptr<const StaticPlaces> places, const Timeline& timeline);

  /// Simulates the cluster from state `from` to state `to` and returns it. Calls `caught_up` for each state. First
  /// contacts on the way are appended to `collisions`.
  core::ClusterState catch_up(const core::ClusterState& cluster, core::Step from, core::Step to,
                              const CatchUpListener& caught_up, std::vector<Collision>& collisions);

  /// Switches the sums of contact impulses on or off for states made up from now on.
  void watch_contacts(bool wanted) { watches_contacts_ = wanted; }
  std::vector<MadeUpContacts> take_contacts() { return std::exchange(contacts_, {}); }

  std::vector<Removal> take_removed();
  std::vector<std::uint64_t> take_applied();
  std::vector<Declined> take_declined();
  std::uint64_t take_unbearable();

 private:
  const core::Scene* scene_;
  Settings settings_;
  std::shared_ptr<const ShapeSet> shapes_;
  std::shared_ptr<const StaticPlaces> places_;
  const Timeline& timeline_;
  std::optional<Simulation> simulation_;
  bool watches_contacts_ = false;
  std::vector<MadeUpContacts> contacts_;
};

}  // namespace aurasim::physics
