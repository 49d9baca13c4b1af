// All endpoints that a node of a run has, on one participant, and something to say on each.
#pragma once

#include "dds/checkpoint_bus.h"
#include "dds/command_bus.h"
#include "dds/overlay_bus.h"
#include "dds/replica_bus.h"
#include "dds/scene_additions_bus.h"
#include "messages/control_samples.h"
#include "messages/replica_messages.h"
#include "transport_fixture.h"

namespace aurasim::dds::testing {

struct RunEndpoints {
  RunEndpoints(std::uint32_t domain, std::uint32_t region, std::initializer_list<std::uint32_t> neighbours)
      : RunEndpoints(settings_for(domain), region, neighbours) {}
  RunEndpoints(const Settings& settings, std::uint32_t region, std::initializer_list<std::uint32_t> neighbours)
      : peer(settings, region, neighbours),
        control(peer.participant, {.region = peer.region()}),
        replicas(peer.participant, peer.region()),
        replica_reader(peer.participant, observed()),
        server(peer.participant, peer.region(), kMapVersion),
        client(peer.participant),
        checkpoints(peer.participant, peer.region()),
        additions(peer.participant, peer.region()),
        additions_reader(peer.participant),
        aura_watch(peer.participant, observed()) {
    checkpoints.use_keepers(regions(neighbours), 0);
  }

  static ObserverSettings observed() { return {kMapVersion, 16, 100}; }

  /// A bit of everything. Now and then something that comes in parts.
  void say(core::Step step) {
    peer.send_batch(step, step % 20 == 0 ? 3000 : 5);
    messages::Status status = messages::testing::status_of(static_cast<std::uint32_t>(core::value_of(peer.region())));
    status.step = step;
    control.publish_status(status);
    replicas.send(messages::testing::replica_of(step % 30 == 0 ? 2000 : 8, peer.region()));
    if (step % 50 == 0) {
      control.publish_map(messages::testing::map_of(kMapVersion));
      checkpoints.send_to_keepers(
          {peer.region(), messages::Checkpoint::Kind::kToKeep, 1, step, std::string(200'000, 'x')});
      core::CommandReply reply;
      reply.source = peer.region();
      reply.request = static_cast<std::uint64_t>(step) + 1;
      reply.text = "seen";
      server.reply(reply);
      control.send(messages::testing::command_of(messages::RunCommandKind::kRate));
    }
  }

  void listen() {
    peer.transport.take(peer.inbox);
    peer.inbox = {};
    control.take_commands();
    control.statuses();
    replica_reader.take();
    server.take();
    client.take();
    checkpoints.take();
    additions_reader.take();
    aura_watch.take();
  }

  Peer peer;
  ControlBus control;
  ReplicaWriter replicas;
  ReplicaReader replica_reader;
  CommandServerEndpoint server;
  CommandClientEndpoint client;
  CheckpointBus checkpoints;
  SceneAdditionsWriter additions;
  SceneAdditionsReader additions_reader;
  AuraWatch aura_watch;
};

}  // namespace aurasim::dds::testing
