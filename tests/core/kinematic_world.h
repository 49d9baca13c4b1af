// Nodes without physics: bodies follow tracks that were fixed beforehand and pass through each other, but every node
// runs the real protocol, in lock step, and receives from its neighbours exactly K steps late. What is checked is who
// hosts what: two bodies that overlap at a substep instant must be computed by one node in that step.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/protocol.h"
#include "core/round_shapes.h"

namespace aurasim::core::testing {

/// A body and where it will be.
struct Traveller {
  BodyId id{};
  PrototypeId prototype{};
  bool awake = true;
  Step birth = 0;
  std::vector<Vec3> p_WB;  ///< at substep instant i: step i / S
  std::vector<Vec3> v_WB;  ///< in state n
  Vec3 w_WB = Vec3::Zero();
};

/// Through `p` at `when` (in steps), with constant velocity.
Traveller on_straight_line(BodyId id, PrototypeId prototype, const AuraRules& rules, const Vec3& p, double when,
                           const Vec3& v, Step steps);

class KinematicWorld {
 public:
  KinematicWorld(const RegionMap& map, const AuraRules& rules, const RoundShapes& shapes,
                 double neighbour_distance_m = 1e9);

  void place(Traveller traveller);
  /// Their overlaps count, and make contacts.
  void watch(BodyId a, BodyId b);
  void watch_all();

  /// State 0: hosts as by assign_hosts(), unless a body has been given one.
  void start();
  void start_on(BodyId id, RegionId host) { wished_hosts_[id] = host; }
  /// Computes one more state.
  void step();
  void run_steps(Step count);
  /// From now on a body goes to sleep where it is, or wakes.
  void set_awake(BodyId id, bool awake);

  Step now() const { return now_; }
  /// Nothing while it is in flight.
  std::optional<RegionId> host(BodyId id) const;
  Epoch epoch(BodyId id) const { return bodies_.at(id).epoch; }
  const Protocol& protocol(RegionId region) const { return *nodes_[value_of(region)].protocol; }
  std::size_t regions() const { return nodes_.size(); }
  /// What a region published about the newest state.
  const Outbox& published(RegionId region) const { return protocol(region).outbox(); }

  /// Watched pairs that overlapped, and those of them that did so at an instant for which no node computed both.
  std::size_t met() const { return met_.size(); }
  std::size_t late() const { return late_.size(); }
  /// Watched pairs that started on different hosts.
  std::size_t apart() const { return apart_; }
  std::string first_late() const { return first_late_; }
  std::uint64_t hand_offs() const { return hand_offs_; }
  /// Broken invariants: a body with two hosts, an epoch that did not rise by one, an unknown transition of a phase.
  std::uint64_t broken() const;

 private:
  struct Body {
    Traveller traveller;
    std::int64_t place = 0;  ///< of whom it is computed with: a region, or a hand-off from 1,000,000 on
    Epoch epoch = 0;
  };
  struct Node {
    std::unique_ptr<Protocol> protocol;
    std::set<BodyId> hosted;
    std::vector<RegionId> listeners;
  };
  using Pair = std::pair<BodyId, BodyId>;

  void deliver(Step stamp);
  void take_in(Node& node, RegionId region);
  void judge_contacts();
  void observe(Node& node);
  Pose pose_of(const Body& body, std::size_t instant) const;
  bool overlap(const Pair& pair, std::size_t instant) const;
  BodyState state_of_body(const Body& body) const;
  BodyRecord record_of(const Body& body) const;
  Snapshot snapshot_of(const Node& node) const;

  AuraRules rules_;
  const RegionMap map_;
  const RoundShapes& shapes_;
  std::vector<Node> nodes_;
  std::map<BodyId, Body> bodies_;
  std::map<BodyId, RegionId> wished_hosts_;
  std::vector<Pair> watched_;
  std::vector<std::vector<Outbox>> published_;  ///< by stamp modulo K + 1, region
  Step now_ = 0;
  std::int64_t flights_ = 1'000'000;
  std::set<Pair> met_, late_;
  std::size_t apart_ = 0;
  std::uint64_t hand_offs_ = 0;
  std::uint64_t broken_ = 0;
  std::string first_late_;
};

}  // namespace aurasim::core::testing
