#include "cli/repartition.h"

#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/launch_setup.h"
#include "core/protocol.h"
#include "dds/replica_bus.h"
#include "physics/clearance.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using core::RegionId;

constexpr auto kRound = 5ms;

struct Resident {
  core::BodyState state;
  RegionId host{};
};

/// Who hosts what, ascending by body.
class Census {
 public:
  Census(const RepartitionSettings& settings, std::size_t regions, core::Step step)
      : settings_(settings), regions_(regions), step_(step) {}

  void accept(const core::Replica& replica) {
    const bool counts = replica.key_frame && replica.generation == settings_.census && replica.stamp == step_;
    if (!counts || received_.contains(replica.source)) return;
    received_.insert({replica.source, true});
    for (const core::ReplicaBody& body : replica.bodies) {
      core::BodyState state;
      state.id = body.id;
      state.epoch = body.epoch;
      state.prototype = body.prototype;
      state.awake = !body.asleep;
      state.pose = {body.p_WB, body.q_WB.cast<double>().normalized()};
      state.v_WB = body.v_WB.cast<double>();
      state.w_WB = body.w_WB.cast<double>();
      residents_.push_back({state, replica.source});
    }
  }

  bool complete() const { return received_.size() == regions_; }

  std::vector<std::uint32_t> silent() const {
    std::vector<std::uint32_t> silent;
    for (std::uint32_t r = 0; r < regions_; ++r) {
      if (!received_.contains(RegionId{r})) silent.push_back(r);
    }
    return silent;
  }

  std::vector<Resident> take() {
    std::ranges::sort(residents_, {}, [](const Resident& r) { return r.state.id; });
    return std::move(residents_);
  }

 private:
  const RepartitionSettings& settings_;
  std::size_t regions_;
  core::Step step_;
  std::map<RegionId, bool> received_;
  std::vector<Resident> residents_;
};

std::vector<Resident> take_census(const RepartitionSettings& settings, const core::RegionMap& map,
                                  dds::Participant& participant, const node::Node& node) {
  dds::ObserverSettings watched;
  watched.map_version = map.version();
  watched.region_count = static_cast<std::uint32_t>(map.size());
  watched.prototype_count = static_cast<std::uint32_t>(node.scene().prototypes.size());
  dds::ReplicaReader reader(participant, watched);
  Census census(settings, map.size(), node.current_step());
  while (!census.complete()) {
    if (Clock::now() > settings.deadline) {
      throw RepartitionFailed(
          fmt::format("new regions: regions {} have not published what they host", census.silent()));
    }
    reader.wait(kRound);
    for (const core::Replica& replica : reader.take()) census.accept(replica);
  }
  return census.take();
}

}  // namespace

std::vector<core::Departure> find_new_hosts(const RepartitionSettings& settings, const config::Launch& launch,
                                            dds::Participant& participant, node::Node& node) {
  const std::vector<Resident> residents = take_census(settings, launch.regions, participant, node);
  core::Snapshot all;
  all.step = node.current_step();
  for (const Resident& resident : residents) all.bodies.push_back(resident.state);
  all.joints = core::joint_pairs(node.scene(), all.bodies);
  const auto clearance = physics::make_clearance_query(node.scene());
  const std::vector<RegionId> hosts = core::assign_hosts(launch.regions, aura_rules(launch), *clearance, all);
  std::map<RegionId, core::Departure> leaving;
  for (std::size_t i = 0; i < residents.size(); ++i) {
    if (residents[i].host != settings.region || hosts[i] == settings.region) continue;
    core::Departure& departure = leaving[hosts[i]];
    departure.destination = hosts[i];
    departure.reason = core::HandOffReason::kBoundaryTraversal;
    departure.bodies.push_back(residents[i].state.id);
  }
  std::vector<core::Departure> departures;
  for (auto& [destination, departure] : leaving) departures.push_back(std::move(departure));
  return departures;
}

namespace {

core::Outbox pack(const RepartitionSettings& settings, const config::Launch& launch,
                  const std::vector<core::Departure>& departures, node::Node& node,
                  std::vector<node::HandOffRow>& rows) {
  core::Outbox outbox;
  outbox.aura.source = settings.region;
  outbox.aura.generation = settings.census;
  outbox.aura.stamp = node.current_step();
  outbox.aura.map_version = launch.regions.version();
  for (const core::Departure& departure : departures) {
    core::HandOff hand_off;
    hand_off.source = settings.region;
    hand_off.destination = departure.destination;
    hand_off.generation = settings.census;
    hand_off.stamp = node.current_step();
    hand_off.map_version = launch.regions.version();
    hand_off.sequence = 1;
    hand_off.reason = departure.reason;
    hand_off.cluster = node.world().release(departure.bodies);
    for (core::BodyRecord& body : hand_off.cluster.bodies) {
      ++body.epoch;
      node::HandOffRow& row = rows.emplace_back();
      row.stamp = hand_off.stamp;
      row.body = body.id;
      row.epoch = body.epoch;
      row.source = settings.region;
      row.destination = departure.destination;
      row.reason = departure.reason;
      row.touched = true;
    }
    outbox.aura.hand_offs.push_back({departure.destination, hand_off.sequence});
    outbox.hand_offs.push_back(std::move(hand_off));
  }
  return outbox;
}

}  // namespace

std::vector<node::HandOffRow> exchange(const RepartitionSettings& settings, const config::Launch& launch,
                                       const std::vector<core::Departure>& departures, dds::DdsTransport& transport,
                                       node::Node& node) {
  std::vector<node::HandOffRow> rows;
  transport.send(pack(settings, launch, departures, node, rows));
  std::map<RegionId, bool> expects;  // by region that has published: does it send us bodies?
  std::map<RegionId, core::HandOff> came;
  const auto is_done = [&] {
    return expects.size() + 1 == launch.regions.size() &&
           std::ranges::all_of(expects, [&](const auto& e) { return !e.second || came.contains(e.first); });
  };
  core::Inbox inbox;
  while (!is_done()) {
    if (Clock::now() > settings.deadline) throw RepartitionFailed("new regions: not every region has sent its bodies");
    transport.wait_for_arrival(kRound);
    transport.take(inbox);
    for (const core::AuraBatch& batch : inbox.auras) {
      if (batch.generation != settings.census) continue;
      expects[batch.source] = std::ranges::any_of(
          batch.hand_offs, [&](const core::HandOffMark& mark) { return mark.destination == settings.region; });
    }
    for (core::HandOff& hand_off : inbox.hand_offs) {
      if (hand_off.generation == settings.census) came.insert_or_assign(hand_off.source, std::move(hand_off));
    }
    inbox.clear();
  }
  for (const auto& [source, hand_off] : came) {
    node.world().adopt(hand_off.cluster, hand_off.stamp);
    for (const core::BodyRecord& body : hand_off.cluster.bodies) {
      node::HandOffRow& row = rows.emplace_back();
      row.stamp = hand_off.stamp;
      row.joined = hand_off.stamp + 1;
      row.body = body.id;
      row.epoch = body.epoch;
      row.source = source;
      row.destination = settings.region;
      row.reason = hand_off.reason;
    }
  }
  return rows;
}

}  // namespace aurasim::cli
