#include "node/repartition.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/protocol.h"
#include "physics/clearance.h"

namespace aurasim::node {

using core::RegionId;

Census::Census(const RepartitionSettings& settings, core::Step step)
    : generation_(settings.census), regions_(static_cast<std::uint32_t>(settings.map->size())), step_(step) {}

void Census::accept(const core::Replica& replica) {
  const bool counts = replica.key_frame && replica.generation == generation_ && replica.stamp == step_;
  if (!counts || !received_.insert({replica.source, true}).second) return;
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

std::vector<std::uint32_t> Census::silent() const {
  std::vector<std::uint32_t> silent;
  for (std::uint32_t r = 0; r < regions_; ++r) {
    if (!received_.contains(RegionId{r})) silent.push_back(r);
  }
  return silent;
}

std::vector<Resident> Census::take() {
  std::ranges::sort(residents_, {}, [](const Resident& r) { return r.state.id; });
  return std::move(residents_);
}

std::vector<core::Departure> find_new_hosts(const RepartitionSettings& settings, const std::vector<Resident>& residents,
                                            const Node& node) {
  core::Snapshot all;
  all.step = node.current_step();
  for (const Resident& resident : residents) all.bodies.push_back(resident.state);
  all.joints = core::joint_pairs(node.scene(), all.bodies);
  const auto clearance = physics::make_clearance_query(node.scene());
  const std::vector<RegionId> hosts = core::assign_hosts(*settings.map, settings.aura, *clearance, all);
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

Exchange::Exchange(const RepartitionSettings& settings, const std::vector<core::Departure>& departures,
                   transport::Transport& transport, Node& node)
    : settings_(settings), transport_(transport), node_(node) {
  transport_.send(pack(departures));
}

core::Outbox Exchange::pack(const std::vector<core::Departure>& departures) {
  core::Outbox outbox;
  outbox.aura.source = settings_.region;
  outbox.aura.generation = settings_.census;
  outbox.aura.stamp = node_.current_step();
  outbox.aura.map_version = settings_.map->version();
  for (const core::Departure& departure : departures) {
    core::HandOff hand_off;
    hand_off.source = settings_.region;
    hand_off.destination = departure.destination;
    hand_off.generation = settings_.census;
    hand_off.stamp = node_.current_step();
    hand_off.map_version = settings_.map->version();
    hand_off.sequence = 1;
    hand_off.reason = departure.reason;
    hand_off.cluster = node_.world().release(departure.bodies);
    for (core::BodyRecord& body : hand_off.cluster.bodies) {
      ++body.epoch;
      HandOffRow& row = rows_.emplace_back();
      row.stamp = hand_off.stamp;
      row.body = body.id;
      row.epoch = body.epoch;
      row.source = settings_.region;
      row.destination = departure.destination;
      row.reason = departure.reason;
      row.touched = true;
    }
    outbox.aura.hand_offs.push_back({departure.destination, hand_off.sequence});
    outbox.hand_offs.push_back(std::move(hand_off));
  }
  return outbox;
}

bool Exchange::ready() {
  transport_.take(inbox_);
  for (const core::AuraBatch& batch : inbox_.auras) {
    if (batch.generation != settings_.census) continue;
    expects_[batch.source] = std::ranges::any_of(
        batch.hand_offs, [&](const core::HandOffMark& mark) { return mark.region == settings_.region; });
  }
  for (core::HandOff& hand_off : inbox_.hand_offs) {
    if (hand_off.generation == settings_.census) came_.insert_or_assign(hand_off.source, std::move(hand_off));
  }
  inbox_.clear();
  return silent().empty();
}

std::vector<std::uint32_t> Exchange::silent() const {
  std::vector<std::uint32_t> silent;
  for (std::uint32_t r = 0; r < settings_.map->size(); ++r) {
    const auto spoken = expects_.find(RegionId{r});
    const bool has_sent = spoken != expects_.end() && (!spoken->second || came_.contains(RegionId{r}));
    if (RegionId{r} != settings_.region && !has_sent) silent.push_back(r);
  }
  return silent;
}

std::vector<HandOffRow> Exchange::finish() {
  for (const auto& [source, hand_off] : came_) {
    node_.world().adopt(hand_off.cluster, hand_off.stamp);
    for (const core::BodyRecord& body : hand_off.cluster.bodies) {
      HandOffRow& row = rows_.emplace_back();
      row.stamp = hand_off.stamp;
      row.joined = hand_off.stamp + 1;
      row.body = body.id;
      row.epoch = body.epoch;
      row.source = source;
      row.destination = settings_.region;
      row.reason = hand_off.reason;
    }
  }
  return std::move(rows_);
}

}  // namespace aurasim::node
