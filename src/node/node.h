// One region's node: protocol, physics and mail, one step at a time (docs/design.md, "One step"). Knows no wall clock
// but for measuring its own phases; the caller says when to step. The same class runs in a process over DDS and, many
// at a time, inside a test in virtual time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/protocol.h"
#include "core/region_map.h"
#include "core/scene.h"
#include "node/collision_watch.h"
#include "physics/region_world.h"
#include "transport/transport.h"

namespace aurasim::node {

/// What the durations of a step count.
enum class PhaseClock : std::uint8_t {
  kWall,       ///< what a frame takes
  kThreadCpu,  ///< what the node's thread does, however busy the machine is
};

struct NodeSetup {
  core::ProtocolSettings protocol;
  physics::Settings physics;
  bool hash_states = true;
  PhaseClock clock = PhaseClock::kWall;
};

/// One body's change of host, as the receiver or (on reclaim) the sender saw it.
struct HandOffRow {
  core::Step stamp = 0;   ///< state in which it left
  core::Step joined = 0;  ///< state in whose computation it takes part first; 0 in the sender's rows
  core::BodyId body{};
  core::Epoch epoch = 0;  ///< the new one
  core::RegionId source{};
  core::RegionId destination{};
  core::HandOffReason reason{};
  bool reclaimed = false;
  bool touched = false;  ///< it had a contact since its last change of host (sender's rows)

  bool is_pull() const { return reason == core::HandOffReason::kAuraCollision; }
};

/// A body's first host, and the state in which it exists first.
struct Birth {
  core::BodyId body{};
  core::Step birth = 0;
};

struct HashPart {
  core::Step step = 0;
  std::uint64_t sum = 0;
};

/// A client's request that has taken effect here.
struct Applied {
  std::uint64_t request = 0;
  core::Step step = 0;                    ///< the first state that shows the effect
  std::optional<core::ObjectRef> object;  ///< the body that it has made
};

/// Seconds spent in the phases of one step, by NodeSetup::clock.
struct Durations {
  double physics_s = 0;    ///< apply, step, snapshot, release
  double protocol_s = 0;   ///< receive, observe
  double transport_s = 0;  ///< take, decode, encode, send
  double watch_s = 0;      ///< late and missed collisions, counts: for the report alone
};

/// The mesh of this content, for this use, if the process has it.
using MeshSource = std::function<std::optional<core::Shape>(const core::MeshRef&)>;

/// What one step did. Valid until the next.
struct StepReport {
  core::Step step = 0;
  Durations durations;
  std::size_t bodies = 0;
  std::size_t awake = 0;
  std::size_t foreign_auras = 0;
  std::size_t projecting = 0;
  std::size_t largest_cluster = 0;
  std::vector<Birth> births;                ///< bodies that this node has announced or taken over at the start
  std::vector<physics::Removal> removals;   ///< bodies taken out, by orders or because they broke down
  std::vector<core::Order> orders;          ///< received
  std::vector<Applied> applied;             ///< requests that were applied here
  std::vector<physics::Declined> declined;  ///< and those that bodies here could not bear
  std::vector<HandOffRow> departures;
  std::vector<core::BodyRecord> departed;  ///< as `departures`: the states in which they left, old epochs
  std::vector<core::BodyId> let_go;        ///< gave way to copies with higher epochs
  std::vector<HandOffRow> arrivals;
  std::vector<SeenCollision> collisions;
  std::vector<HashPart> hash;  ///< this state, and states made up for bodies that joined
};

class Node {
 public:
  /// Map and transport outlive the node. The scene is copied: orders add to it.
  Node(const NodeSetup& setup, const core::Scene& scene, const core::RegionMap& map, transport::Transport& transport);

  /// Takes the bodies of state 0 that are this region's and publishes them. Once, before anything else.
  const StepReport& start();

  /// Takes in the mail. True when the next state may be computed.
  bool ready();

  /// Computes the next state. Only when ready().
  const StepReport& step();

  /// Orders the world to do something, as soon as all nodes can have received it, or in state `at_step` if that is
  /// later. Only on the one node that takes orders.
  const core::Order& order(const core::Action& action, std::uint64_t request, core::Step at_step = 0);
  void use_meshes(MeshSource source) { meshes_ = std::move(source); }
  /// As it has grown.
  const core::Scene& scene() const { return scene_; }

  /// After the last step: may what is still under way be taken in?
  bool ready_to_settle();
  /// Takes in the bodies that are still under way to this region, so that every state's hash is whole.
  const StepReport& settle();

  /// Another map, in the state that has been computed. All bodies are where the new map wants them, and every node of
  /// the run does the same. Map and transport outlive the node.
  const StepReport& take_map(const core::ProtocolSettings& settings, const core::RegionMap& map,
                             transport::Transport& transport);

  core::RegionId region() const { return setup_.protocol.self; }
  /// Of the last step.
  const StepReport& report() const { return report_; }
  core::Step current_step() const { return world_.step_number(); }
  const core::Protocol& protocol() const { return *protocol_; }
  const physics::RegionWorld& world() const { return world_; }
  core::Protocol& protocol() { return *protocol_; }
  physics::RegionWorld& world() { return world_; }
  const CollisionWatch& collision_watch() const { return watch_; }
  /// Messages of a later generation, for the node that takes over after a reset.
  core::Inbox& mail() { return inbox_; }
  void accept_early_mail(core::Inbox mail) { inbox_ = std::move(mail); }

 private:
  void take_mail();
  void note_removals();
  void clear_report();
  void host_initial_bodies();
  void announce_births(core::Step state);
  void heed(const core::Order& order);
  void announce_spawns(core::Step birth);
  void apply(const core::Changes& changes);
  void finish_state();
  void note_contacts(const core::Snapshot& snapshot);
  void note_arrivals(const core::Adoption& adoption);
  void release(std::span<const core::Departure> departures);
  void hand_over(const core::Departure& departure, core::ClusterState cluster);
  bool take_touched(core::BodyId id);
  void count(const core::Snapshot& snapshot);

  NodeSetup setup_;
  core::Scene scene_;
  MeshSource meshes_;
  const core::RegionMap* map_;
  transport::Transport* transport_;
  std::unique_ptr<core::ClearanceQuery> clearance_;
  std::optional<core::Protocol> protocol_;  ///< always there; another one with another map
  physics::RegionWorld world_;
  CollisionWatch watch_;
  core::Inbox inbox_;
  std::vector<core::Order> to_spawn_;
  std::vector<std::uint64_t> next_injection_;  ///< by injector: first index not yet announced
  struct Touch {
    core::BodyId id{};
    bool touched = false;  ///< had a contact since it came here
  };
  std::vector<Touch> touched_, touched_before_;  ///< ascending id: of the last state, and of the one before it
  double mail_s_ = 0;                            ///< time spent with the mail since the last step
  StepReport report_;
};

}  // namespace aurasim::node
