// Messages as the tests write them.
#pragma once

#include <initializer_list>

#include "core/handoff.h"
#include "core/messages.h"

namespace aurasim::core::testing {

inline RegionId region(std::uint32_t id) { return RegionId{id}; }
inline BodyId body(std::uint64_t id) { return BodyId{id}; }

inline BodyRecord record_of(std::uint64_t id, Epoch epoch) {
  BodyRecord record;
  record.id = BodyId{id};
  record.epoch = epoch;
  return record;
}

/// Bodies that are kept until they are acknowledged.
inline std::size_t open_bodies(const DepartureLedger& departures) {
  std::size_t bodies = 0;
  for (const HandOff& h : departures.open()) bodies += h.cluster.bodies.size();
  return bodies;
}

inline HandOff hand_off(std::uint32_t from, std::uint32_t to, Step stamp, std::initializer_list<BodyRecord> bodies) {
  HandOff h;
  h.source = RegionId{from};
  h.destination = RegionId{to};
  h.stamp = stamp;
  h.cluster.bodies = bodies;
  return h;
}

inline AuraBatch batch(std::uint32_t from, Step stamp) {
  AuraBatch b;
  b.source = RegionId{from};
  b.stamp = stamp;
  return b;
}

inline AuraRecord aura(std::uint64_t id, Epoch epoch = 0) {
  AuraRecord a;
  a.id = BodyId{id};
  a.epoch = epoch;
  return a;
}

}  // namespace aurasim::core::testing
