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

/// Bodies that have not been announced yet. Every node keeps all of them, because any node may own the place of a
/// birth.
struct ToBeBorn {
  std::vector<core::Order> spawns;            ///< spawn orders received so far, in sequence
  std::vector<std::uint64_t> next_injection;  ///< per injector, the first index not yet announced

  /// Begins with the injectors of `scene`: bodies born up to state `known` count as announced.
  void begin(const core::Scene& scene, core::Step known, double step_s);
  /// Takes out what appears up to state `birth`: first the bodies of orders, then the injected ones.
  std::vector<NewBody> take_due(const core::Scene& scene, core::Step birth, double step_s);
};

/// Bodies that the scene's injectors make after state `after`, up to state `until`.
std::vector<core::BodyRecord> injected_between(const core::Scene& scene, core::Step after, core::Step until,
                                               double step_s);

}  // namespace aurasim::node
