// Bodies that orders and injectors will make: which of them are announced when.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/order.h"
#include "core/scene.h"

namespace aurasim::node {

/// A body that appears in a later state.
struct NewBody {
  core::BodyRecord record;
  std::optional<core::Order> order;  ///< the order that makes it; nothing: an injector does
};

/// The next body of each injector of a scene. It follows from the scene and a state alone, so no cut needs it.
class Injections {
 public:
  /// Bodies that the scene's injectors make after state `after`, up to state `until`; by injector. Calls for successive
  /// states look at one number for each injector that makes nothing.
  std::vector<core::BodyRecord> between(const core::Scene& scene, core::Step after, core::Step until, double step_s);

 private:
  struct Next {
    core::Step birth = 0;
    std::uint64_t index = 0;
  };

  core::Step known_ = 0;    ///< next_ is of the bodies born after this state
  std::vector<Next> next_;  ///< by injector; empty at first
};

/// Bodies that have not been announced yet. Every node keeps all of them, because any node may own the place of a
/// birth.
struct ToBeBorn {
  std::vector<core::Order> spawns;  ///< spawn orders received so far, in sequence
  core::Step injected = 0;          ///< bodies that injectors make up to this state have been announced

  /// Takes out what appears up to state `birth`: first the bodies of orders, then the injected ones.
  std::vector<NewBody> take_due(const core::Scene& scene, Injections& injections, core::Step birth, double step_s);
};

}  // namespace aurasim::node
