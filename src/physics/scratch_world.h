// Where bodies that arrive late make up the steps that they have missed.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "physics/simulation.h"

namespace aurasim::physics {

/// Empty between two uses; made when it is first needed.
class ScratchWorld {
 public:
  ScratchWorld(const core::Scene& scene, const Settings& settings, std::shared_ptr<const ShapeSet> shapes,
               const Timeline& timeline);

  /// The cluster, whose state is that of step `from`, in the state of step `to`. Contacts that begin on the way are
  /// appended to `collisions`.
  core::ClusterState catch_up(const core::ClusterState& cluster, core::Step from, core::Step to,
                              const CatchUpListener& caught_up, std::vector<Collision>& collisions);

  /// In states that are made up from now on.
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
  const Timeline& timeline_;
  std::optional<Simulation> simulation_;
  bool watches_contacts_ = false;
  std::vector<MadeUpContacts> contacts_;
};

}  // namespace aurasim::physics
