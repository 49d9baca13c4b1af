// One node, given by hand what it hosts and receives.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/letters.h"
#include "core/protocol.h"
#include "core/round_shapes.h"

namespace aurasim::core::testing {

class ProtocolTest : public ::testing::Test {
 protected:
  ProtocolTest() {
    settings.aura.gravity = Vec3::Zero();
    settings.aura.contact_margin_m = 0;
    settings.neighbour_distance_m = 1e9;
    settings.generation = 3;
  }

  /// Starts as `self`, in state 0.
  void start(std::uint32_t self, RegionMap layout = RegionMap::columns(2, 100)) {
    map.emplace(std::move(layout));
    settings.self = region(self);
    protocol.emplace(settings, *map, shapes);
    observe();
  }
  BodyState& host(std::uint64_t id, const Vec3& p, const Vec3& v = Vec3::Zero()) {
    BodyState state;
    state.id = body(id);
    state.prototype = ball;
    state.pose.p_WB = p;
    state.v_WB = v;
    snapshot.bodies.push_back(state);
    return snapshot.bodies.back();
  }
  const std::vector<Departure>& observe() {
    snapshot.step = now;
    const std::vector<Departure>& departures = protocol->observe(snapshot);
    for (const Departure& d : departures) {
      ClusterState cluster;
      for (const BodyId id : d.bodies) {
        const auto found = std::find_if(snapshot.bodies.begin(), snapshot.bodies.end(),
                                        [&](const BodyState& b) { return b.id == id; });
        cluster.bodies.push_back(record_of(value_of(id), found->epoch));
        snapshot.bodies.erase(found);
      }
      protocol->hand_over(d, std::move(cluster));
    }
    return departures;
  }
  void receive(AuraBatch b) {
    b.generation = settings.generation;
    b.map_version = map->version();
    inbox.auras.push_back(std::move(b));
    protocol->accept(inbox);
  }
  void receive(HandOff h, std::uint64_t sequence) {
    h.generation = settings.generation;
    h.map_version = map->version();
    h.sequence = sequence;
    inbox.hand_offs.push_back(std::move(h));
    protocol->accept(inbox);
  }
  AuraRecord foreign(std::uint64_t id, const Vec3& p, Epoch epoch = 0, std::uint32_t at = 1) {
    AuraRecord a = aura(id, epoch);
    a.host = region(at);
    a.prototype = ball;
    a.pose.p_WB = p;
    return a;
  }
  /// Region 1 publishes its next batch, with these auras.
  void receive_batch_of_1(std::vector<AuraRecord> auras = {}) {
    AuraBatch b = batch(1, protocol->intake().neighbours()[0].received() + 1);
    for (AuraRecord& a : auras) a.stamp = b.stamp;
    b.updates = std::move(auras);
    receive(std::move(b));
  }
  const Changes& receive_next() { return protocol->receive(++now); }
  /// One state in which nothing is received but region 1's steps.
  void pass_step() {
    receive_batch_of_1();
    receive_next();
    observe();
  }

  ProtocolSettings settings;
  RoundShapes shapes;
  PrototypeId ball = shapes.sphere(0.5);
  PrototypeId large = shapes.sphere(4);
  std::optional<RegionMap> map;
  std::optional<Protocol> protocol;
  Snapshot snapshot;
  Inbox inbox;
  Step now = 0;
};

}  // namespace aurasim::core::testing
