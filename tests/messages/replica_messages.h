// A replica with something in every field.
#pragma once

#include "core/replica.h"
#include "messages/samples.h"

namespace aurasim::messages::testing {

inline core::Replica replica_of(std::size_t bodies, core::RegionId source = core::RegionId{1}) {
  core::Replica replica;
  replica.source = source;
  replica.generation = 7;
  replica.stamp = 99;
  replica.map_version = 0xfedc'ba98'7654'3210U;
  replica.sequence = 33;
  for (std::size_t i = 0; i < bodies; ++i) {
    const auto x = static_cast<float>(i);
    replica.bodies.push_back({.id = core::BodyId{3 * i + 1},
                              .epoch = static_cast<core::Epoch>(i),
                              .host = core::RegionId{static_cast<std::uint32_t>(i % 4)},
                              .prototype = core::PrototypeId{static_cast<std::uint32_t>(i % 7)},
                              .asleep = i % 2 == 1,
                              .p_WB = {0.1 * x, -x, 1e6},
                              .q_WB = turn(x).cast<float>(),
                              .v_WB = {x, 1, -2},
                              .w_WB = {0, x, 0.5F}});
  }
  replica.removed = {{core::BodyId{5}, 8}};
  return replica;
}

}  // namespace aurasim::messages::testing
