// A process that knows what anybody can learn of a run, and says what is not its to say: for tests of a run that goes
// on all the same. It begins when a node has come to state AFTER, prints "done" when it has said everything, and stays,
// with all its endpoints.
//   dds_stranger_process DOMAIN AFTER [deaf]
// deaf: it says nothing, but listens to everything, reliably, with 17 readers that take no samples: each heartbeat is
// answered with a request for all that is missing.
#include <array>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "aurasim.h"
#include "core/mesh_hash.h"
#include "dds/command_bus.h"
#include "dds/random_id.h"
#include "dds/typed_endpoints.h"
#include "messages/checkpoint_codec.h"
#include "messages/codec.h"
#include "messages/command_codec.h"
#include "messages/control_codec.h"
#include "messages/control_samples.h"
#include "transport_fixture.h"

namespace aurasim::dds::testing {
namespace {

using core::RegionId;
using core::value_of;

/// Reliable, and takes nothing: after the first sample it acknowledges no more.
class DeafReader {
 public:
  DeafReader(Domain& domain, TopicId topic, const topics::Route& route, RegionId region) {
    eprosima::fastdds::dds::SubscriberQos subscriber_qos;
    subscriber_qos.partition().push_back(topics::partition_of(topic, route).c_str());
    auto* const subscriber = domain.participant().create_subscriber(subscriber_qos);
    auto qos = domain.profiles().reader(*subscriber, std::string(name_of(topic)) + "_reader");
    qos.history().kind = eprosima::fastdds::dds::KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples = qos.resource_limits().max_samples_per_instance = 1;
    qos.resource_limits().max_instances = qos.resource_limits().allocated_samples = 1;
    qos.user_data().setValue(user_data_of(region));
    if (subscriber->create_datareader(&domain.topic(topic), qos) == nullptr) throw DdsError("no deaf reader");
  }
};

class Stranger {
 public:
  explicit Stranger(std::uint32_t domain)
      : participant_(settings_for(domain)), domain_(participant_.domain()), control_(participant_, {}) {}

  void wait_for(core::Step step) {
    while (control_.statuses().size() < kRegions || newest().step < step) control_.wait(10ms);
    for (const auto& [region, seen] : control_.statuses()) nodes_.push_back(seen.status);
  }

  void listen_and_never_read() {
    for (const messages::Status& node : nodes_) {
      const RegionId r = node.region;
      deaf_.emplace_back(domain_, TopicId::kAura, topics::Route{.source = r}, next(r));
      deaf_.emplace_back(domain_, TopicId::kMigration, topics::Route{.source = r, .destination = next(r)}, next(r));
      deaf_.emplace_back(domain_, TopicId::kReplica, topics::Route{.source = r}, next(r));
    }
    deaf_.emplace_back(domain_, TopicId::kRunControl, topics::Route{}, RegionId{0});
  }

  /// "I am the node of region R", on every topic that nodes have.
  void write_where_regions_do() {
    for (const messages::Status& node : nodes_) {
      const RegionId r = node.region;
      auras_.push_back(writer<wire::AuraBatch>(TopicId::kAura, topics::Route{.source = r}, r));
      hand_offs_.push_back(
          writer<wire::Migration>(TopicId::kMigration, topics::Route{.source = r, .destination = next(r)}, r));
      statuses_.push_back(writer<wire::NodeStatus>(TopicId::kNodeStatus, topics::Route{.source = r}, r));
    }
    nobody_ = writer<wire::NodeStatus>(TopicId::kNodeStatus, topics::Route{.source = RegionId{9}}, RegionId{9});
    runs_ = writer<wire::RunControl>(TopicId::kRunControl, topics::Route{});
    maps_ = writer<wire::RegionMap>(TopicId::kRegionMap, topics::Route{});
    parts_ = writer<wire::Checkpoint>(TopicId::kCheckpoint, topics::Route{});
    orders_ = writer<wire::AuraBatch>(TopicId::kOrders, topics::Route{});
    std::this_thread::sleep_for(500ms);  // all are matched
  }

  void forge_batches() {
    for (std::size_t r = 0; r < kRegions; ++r) {
      core::AuraBatch batch = messages::testing::batch_of(3, nodes_[r].region);
      batch.generation = nodes_[r].generation;
      batch.map_version = nodes_[r].map_version;
      batch.redo = 0;
      batch.orders.clear();
      batch.adopted = {{next(nodes_[r].region), 1'000'000}};
      for (core::Step ahead = 0; ahead < 200; ++ahead) {
        batch.stamp = newest().step + ahead;
        auras_[r]->send(batch);
      }
      batch.stamp = 1'000'000'000;
      auras_[r]->send(batch);
      batch.top_speed_m_s = 1e300;
      auras_[r]->send(batch);
    }
  }

  void forge_hand_offs() {
    for (std::size_t r = 0; r < kRegions; ++r) {
      core::HandOff hand_off = messages::testing::hand_off_of(2, nodes_[r].region, next(nodes_[r].region));
      hand_off.generation = nodes_[r].generation;
      hand_off.map_version = nodes_[r].map_version;
      for (std::uint64_t number = 1; number <= 200; ++number) {
        hand_off.sequence = number;
        hand_off.stamp = newest().step;
        hand_offs_[r]->send(hand_off);
      }
      hand_off.cluster.bodies[0].prototype = core::PrototypeId{5000};
      hand_offs_[r]->send(hand_off);
      hand_off.cluster.bodies[0].v_WB = core::Vec3(1e308, 0, 0);
      hand_offs_[r]->send(hand_off);
    }
  }

  void forge_statuses() {
    messages::Status ninth = nodes_[0];
    ninth.region = RegionId{9};
    ninth.process = draw_id();
    nobody_->send(ninth);
    for (const messages::NodeState state : {messages::NodeState::kRunning, messages::NodeState::kRecovering,
                                            messages::NodeState::kFailed, messages::NodeState::kSpare}) {
      for (std::size_t r = 0; r < kRegions; ++r) {
        messages::Status status = nodes_[r];
        status.process = draw_id();
        status.state = state;
        status.generation += 5;
        statuses_[r]->send(status);
        status.region = next(status.region);  // beside its partition
        statuses_[r]->send(status);
      }
    }
  }

  void forge_run_commands() {
    messages::RunCommand command;
    command.generation = nodes_[0].generation;
    command.run = nodes_[0].run;
    const auto say = [&](messages::RunCommandKind kind, core::Step at_step, std::int64_t epoch_ns) {
      command.kind = kind;
      command.at_step = at_step;
      command.epoch_ns = epoch_ns;
      command.request = draw_id();
      runs_->send(command, sender_);
    };
    constexpr std::int64_t kDecadesAhead = 4'000'000'000'000'000'000;
    for (int i = 0; i < 5; ++i) {
      say(messages::RunCommandKind::kStop, 0, 0);
      say(messages::RunCommandKind::kPause, 1, 0);
      say(messages::RunCommandKind::kReset, 1, kDecadesAhead);
      say(messages::RunCommandKind::kReset, newest().step + 60, kDecadesAhead);
      say(messages::RunCommandKind::kStart, 0, kDecadesAhead);
      command.rate = 0.01;
      say(messages::RunCommandKind::kRate, newest().step + 1, 0);
    }
    command.count = 1;
    for (const messages::Status& node : nodes_) command.members.push_back({draw_id(), node.region, true});
    command.generation += 1;
    say(messages::RunCommandKind::kRestore, 0, 0);
    command.members.clear();
    for (const messages::Status& node : nodes_) {
      command.region = node.region;
      command.process = node.process;
      say(messages::RunCommandKind::kLost, 0, 0);
    }
  }

  void forge_the_rest() {
    for (const messages::Status& node : nodes_) {
      messages::WorldMap map = messages::testing::map_of(node.map_version ^ 1U);
      map.agreement = node.agreement;
      map.generation = node.generation + 1;
      maps_->send(map);
      for (const auto kind : {messages::Checkpoint::Kind::kToKeep, messages::Checkpoint::Kind::kGoBack,
                              messages::Checkpoint::Kind::kOrders}) {
        parts_->send(messages::Checkpoint{node.region, kind, 4'000'000'000U, 1, std::string(1 << 20, 'x')});
      }
      core::AuraBatch orders;
      orders.source = node.region;
      orders.generation = node.generation;
      orders.orders = messages::testing::one_order_of_each_kind();
      orders.stamp = 1 << 20;
      orders_->send(orders);
    }
  }

  /// Of these, none is refused, and there are too many.
  void send_too_much(std::size_t meshes, std::size_t rays) {
    CommandClientEndpoint client(participant_);
    std::this_thread::sleep_for(500ms);
    for (std::size_t m = 0; m < meshes; ++m) {
      core::TriangleMesh mesh;
      for (std::size_t i = 0; i < 60'000; ++i) {
        mesh.points.emplace_back(static_cast<double>(i), static_cast<double>(m), 0.0);
        mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(i)});
      }
      client.bring(core::content_hash(mesh), mesh);
    }
    for (std::size_t i = 0; i < rays; ++i) {
      client.send({draw_id(), 0, core::Ray{core::Vec3(0, 0, 50), core::Vec3(0, 0, -5), {}}}, 0);
    }
  }

 private:
  static constexpr std::uint32_t kRegions = 4;

  static RegionId next(RegionId region) { return RegionId{(value_of(region) + 1) % kRegions}; }
  const messages::Status& newest() {
    const auto& statuses = control_.statuses();
    return std::ranges::max_element(statuses, {}, [](const auto& entry) { return entry.second.status.step; })
        ->second.status;
  }
  template <class Wire>
  std::unique_ptr<TypedWriter<Wire>> writer(TopicId topic, const topics::Route& route,
                                            std::optional<RegionId> region = {}) {
    return std::make_unique<TypedWriter<Wire>>(domain_, on(topic, route, region), wakeup_);
  }

  Participant participant_;
  Domain& domain_;
  ControlBus control_;
  Wakeup wakeup_;
  std::uint64_t sender_ = draw_id();
  std::vector<messages::Status> nodes_;
  std::vector<DeafReader> deaf_;
  std::vector<std::unique_ptr<TypedWriter<wire::AuraBatch>>> auras_;
  std::vector<std::unique_ptr<TypedWriter<wire::Migration>>> hand_offs_;
  std::vector<std::unique_ptr<TypedWriter<wire::NodeStatus>>> statuses_;
  std::unique_ptr<TypedWriter<wire::NodeStatus>> nobody_;
  std::unique_ptr<TypedWriter<wire::RunControl>> runs_;
  std::unique_ptr<TypedWriter<wire::RegionMap>> maps_;
  std::unique_ptr<TypedWriter<wire::Checkpoint>> parts_;
  std::unique_ptr<TypedWriter<wire::AuraBatch>> orders_;
};

void listen(std::uint32_t domain, core::Step after) {
  Stranger stranger(domain);
  stranger.wait_for(after);
  stranger.listen_and_never_read();
  std::cout << "done" << std::endl;
  std::this_thread::sleep_for(1h);
}

/// Each attack by a process of its own in all but name: whoever is not listened to any more after one would not be
/// heard with the next.
void attack(std::uint32_t domain, core::Step after) {
  std::vector<std::unique_ptr<Stranger>> strangers;
  const auto begin = [&]() -> Stranger& {
    strangers.push_back(std::make_unique<Stranger>(domain));
    strangers.back()->wait_for(after);
    return *strangers.back();
  };
  constexpr std::array kLies = {&Stranger::forge_batches, &Stranger::forge_hand_offs, &Stranger::forge_statuses,
                                &Stranger::forge_run_commands, &Stranger::forge_the_rest};
  for (const auto lie : kLies) {
    Stranger& stranger = begin();
    stranger.write_where_regions_do();
    (stranger.*lie)();
  }
  begin().send_too_much(60, 5000);
  std::cout << "done" << std::endl;
  std::this_thread::sleep_for(1h);
}

}  // namespace
}  // namespace aurasim::dds::testing

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: dds_stranger_process DOMAIN AFTER [deaf]\n";
    return 2;
  }
  try {
    const auto domain = static_cast<std::uint32_t>(std::stoul(argv[1]));
    const auto what = argc > 3 ? aurasim::dds::testing::listen : aurasim::dds::testing::attack;
    what(domain, std::stoll(argv[2]));
  } catch (const std::exception& error) {
    std::cerr << "dds_stranger_process: " << error.what() << '\n';
    return 1;
  }
}
