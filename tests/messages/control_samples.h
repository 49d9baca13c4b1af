// A status, a map and a command with something in every field.
#pragma once

#include "dds/control.h"

namespace aurasim::messages::testing {

inline Status status_of(std::uint32_t region) {
  Status status;
  status.region = static_cast<core::RegionId>(region);
  status.generation = 2;
  status.step = 1234;
  status.run = 11;
  status.pid = 4321;
  status.map_version = 77;
  status.agreement = 88;
  status.state = NodeState::kRunning;
  status.holds_at = 1240;
  status.bodies = 10;
  status.saved = {~std::uint64_t{0}, 12};
  status.not_saved = {13};
  status.awake = 9;
  status.foreign_auras = 8;
  status.hand_offs_out = 7;
  status.hand_offs_in = 6;
  status.violations = {1, 2, 3, 4, 5};
  status.late_collisions = 6;
  status.missed_collisions = 7;
  status.listens_to = {{core::RegionId{0}, 0, {}}, {core::RegionId{3}, 120, core::RegionId{2}}};
  status.frame = {1.5, 2.5, 3.5};
  status.physics = {0.1, 0.2, 0.3};
  status.protocol = {0.4, 0.5, 0.6};
  status.transport = {0.7, 0.8, 0.9};
  status.exchange_times = {0.05, 0.06, 0.07};
  status.exchange = ExchangeInUse::kCoupled;
  status.round_trip_ms = 0.12;
  status.real_time_factor = 0.99;
  status.largest_cluster = 5;
  status.footprint.x1 = 20;  // the other sides are infinite
  status.lookahead = 2;
  status.text = "all is well";
  status.dead = {core::RegionId{3}};
  return status;
}

inline WorldMap map_of(std::uint64_t version) {
  WorldMap map;
  map.map_version = version;
  map.agreement = 88;
  map.generation = 2;
  map.from_step = 5;
  map.scene = "tower";
  core::Rectangle left;
  left.x1 = 0;
  core::Rectangle right;
  right.x0 = 0;
  map.regions = {left, right};
  return map;
}

inline RunCommand command_of(RunCommandKind kind) {
  RunCommand command;
  command.kind = kind;
  command.generation = 2;
  command.map_version = 77;
  command.run = 0;
  command.at_step = 600;
  command.count = 10;
  command.epoch_ns = 1'700'000'000'123'456'789;
  return command;
}

}  // namespace aurasim::messages::testing
