#include "core/kinematic_world.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace aurasim::core::testing {

Traveller on_straight_line(BodyId id, PrototypeId prototype, const AuraRules& rules, const Vec3& p, double when,
                           const Vec3& v, Step steps) {
  Traveller traveller;
  traveller.id = id;
  traveller.prototype = prototype;
  const auto instants = static_cast<std::size_t>(steps * rules.substeps + 1);
  traveller.p_WB.reserve(instants);
  for (std::size_t i = 0; i < instants; ++i) {
    const double step = static_cast<double>(i) / rules.substeps;
    traveller.p_WB.push_back(p + v * ((step - when) * rules.step_s));
  }
  traveller.v_WB.assign(static_cast<std::size_t>(steps + 1), v);
  return traveller;
}

KinematicWorld::KinematicWorld(const RegionMap& map, const AuraRules& rules, const RoundShapes& shapes,
                               double neighbour_distance_m)
    : rules_(rules), map_(map), shapes_(shapes) {
  for (std::uint32_t r = 0; r < map.size(); ++r) {
    ProtocolSettings settings;
    settings.self = RegionId{r};
    settings.sync = SyncMode::kDeterministic;
    settings.aura = rules;
    settings.neighbour_distance_m = neighbour_distance_m;
    Node& node = nodes_.emplace_back();
    node.protocol = std::make_unique<Protocol>(settings, map_, shapes_);
    node.listeners = map_.neighbours(settings.self, neighbour_distance_m);
  }
  published_.assign(static_cast<std::size_t>(rules.lookahead) + 1, std::vector<Outbox>(map.size()));
}

void KinematicWorld::place(Traveller traveller) {
  Body body;
  body.traveller = std::move(traveller);
  bodies_.insert_or_assign(body.traveller.id, std::move(body));
}

void KinematicWorld::watch(BodyId a, BodyId b) { watched_.emplace_back(a, b); }

void KinematicWorld::watch_all() {
  for (auto a = bodies_.begin(); a != bodies_.end(); ++a) {
    for (auto b = std::next(a); b != bodies_.end(); ++b) watch(a->first, b->first);
  }
}

void KinematicWorld::start() {
  Snapshot scene;
  for (const auto& [id, body] : bodies_) scene.bodies.push_back(state_of_body(body));
  const std::vector<RegionId> hosts = assign_hosts(map_, rules_, shapes_, scene);
  std::size_t i = 0;
  for (auto& [id, body] : bodies_) {
    const auto wish = wished_hosts_.find(id);
    const RegionId host = wish == wished_hosts_.end() ? hosts[i] : wish->second;
    body.place = value_of(host);
    nodes_[value_of(host)].hosted.insert(id);
    ++i;
  }
  for (const Pair& pair : watched_) apart_ += bodies_.at(pair.first).place != bodies_.at(pair.second).place;
  for (Node& node : nodes_) observe(node);
}

void KinematicWorld::step() {
  ++now_;
  if (now_ >= rules_.lookahead) deliver(now_ - rules_.lookahead);
  for (std::uint32_t r = 0; r < nodes_.size(); ++r) take_in(nodes_[r], RegionId{r});
  judge_contacts();
  for (Node& node : nodes_) observe(node);
}

void KinematicWorld::run_steps(Step count) {
  for (Step i = 0; i < count; ++i) step();
}

void KinematicWorld::set_awake(BodyId id, bool awake) {
  Traveller& traveller = bodies_.at(id).traveller;
  traveller.awake = awake;
  if (awake) return;
  const auto here = static_cast<std::size_t>(now_ * rules_.substeps);
  std::fill(traveller.p_WB.begin() + static_cast<std::ptrdiff_t>(here), traveller.p_WB.end(), traveller.p_WB[here]);
  std::fill(traveller.v_WB.begin() + static_cast<std::ptrdiff_t>(now_), traveller.v_WB.end(), Vec3::Zero());
}

std::optional<RegionId> KinematicWorld::host(BodyId id) const {
  const std::int64_t place = bodies_.at(id).place;
  if (place >= static_cast<std::int64_t>(nodes_.size())) return std::nullopt;
  return RegionId{static_cast<std::uint32_t>(place)};
}

std::uint64_t KinematicWorld::broken() const {
  std::uint64_t sum = broken_;
  for (const Node& node : nodes_) {
    sum += node.protocol->projection().counters().bad_phase_changes + node.protocol->counters().stale_arrivals +
           node.protocol->counters().let_go;
  }
  return sum;
}

void KinematicWorld::deliver(Step stamp) {
  const std::vector<Outbox>& published = published_[static_cast<std::size_t>(stamp) % published_.size()];
  std::vector<Inbox> inboxes(nodes_.size());
  for (std::size_t from = 0; from < nodes_.size(); ++from) {
    for (const RegionId to : nodes_[from].listeners) inboxes[value_of(to)].auras.push_back(published[from].aura);
    for (const HandOff& h : published[from].hand_offs) inboxes[value_of(h.destination)].hand_offs.push_back(h);
  }
  for (std::size_t r = 0; r < nodes_.size(); ++r) nodes_[r].protocol->accept(inboxes[r]);
}

void KinematicWorld::take_in(Node& node, RegionId region) {
  if (!node.protocol->ready(now_)) throw std::logic_error("a node waits although everything has come");
  const Changes& changes = node.protocol->receive(now_);
  for (const BodyId id : changes.let_go) node.hosted.erase(id);
  for (const Adoption& adoption : changes.adoptions) {
    for (const BodyRecord& record : adoption.cluster.bodies) {
      Body& body = bodies_.at(record.id);
      broken_ += host(record.id).has_value();
      broken_ += record.epoch != body.epoch + 1;
      body.epoch = record.epoch;
      body.place = value_of(region);
      node.hosted.insert(record.id);
    }
  }
}

/// Contacts are sought at the S instants with which the S substeps of computing state `now_` begin.
void KinematicWorld::judge_contacts() {
  const auto substeps = static_cast<std::size_t>(rules_.substeps);
  const std::size_t first = static_cast<std::size_t>(now_ - 1) * substeps;
  for (const Pair& pair : watched_) {
    for (std::size_t i = first; i < first + substeps; ++i) {
      if (!overlap(pair, i)) continue;
      met_.insert(pair);
      const Body& a = bodies_.at(pair.first);
      const Body& b = bodies_.at(pair.second);
      if (a.place == b.place || !late_.insert(pair).second || !first_late_.empty()) continue;
      std::ostringstream text;
      text << "bodies " << value_of(pair.first) << " and " << value_of(pair.second) << " overlap at instant " << i
           << " / " << substeps << ", hosts " << a.place << " and " << b.place;
      first_late_ = text.str();
    }
  }
}

void KinematicWorld::observe(Node& node) {
  const std::vector<Departure>& departures = node.protocol->observe(snapshot_of(node));
  for (const Departure& departure : departures) {
    ClusterState cluster;
    for (const BodyId id : departure.bodies) {
      broken_ += node.hosted.erase(id) != 1;
      cluster.bodies.push_back(record_of(bodies_.at(id)));
      bodies_.at(id).place = flights_;
      ++hand_offs_;
    }
    ++flights_;
    node.protocol->hand_over(departure, std::move(cluster));
  }
  const Outbox& outbox = node.protocol->outbox();
  published_[static_cast<std::size_t>(now_) % published_.size()][value_of(outbox.aura.source)] = outbox;
}

Pose KinematicWorld::pose_of(const Body& body, std::size_t instant) const {
  Pose pose;
  const Traveller& t = body.traveller;
  pose.p_WB = t.p_WB.at(instant);
  const double spin = t.w_WB.norm();
  if (spin > 0) {
    const double time_s = static_cast<double>(instant) / rules_.substeps * rules_.step_s;
    pose.q_WB = Quat(Eigen::AngleAxisd(spin * time_s, t.w_WB / spin));
  }
  return pose;
}

bool KinematicWorld::overlap(const Pair& pair, std::size_t instant) const {
  const Body& a = bodies_.at(pair.first);
  const Body& b = bodies_.at(pair.second);
  const auto born = static_cast<std::size_t>(std::max(a.traveller.birth, b.traveller.birth) * rules_.substeps);
  if (instant < born) return false;
  return shapes_.clearance(a.traveller.prototype, pose_of(a, instant), b.traveller.prototype, pose_of(b, instant), 0) <=
         0;
}

BodyState KinematicWorld::state_of_body(const Body& body) const {
  BodyState state;
  state.id = body.traveller.id;
  state.epoch = body.epoch;
  state.prototype = body.traveller.prototype;
  state.awake = body.traveller.awake;
  state.birth = body.traveller.birth;
  state.pose = pose_of(body, static_cast<std::size_t>(now_ * rules_.substeps));
  state.v_WB = body.traveller.v_WB.at(static_cast<std::size_t>(now_));
  state.w_WB = body.traveller.w_WB;
  return state;
}

BodyRecord KinematicWorld::record_of(const Body& body) const {
  const BodyState state = state_of_body(body);
  BodyRecord record;
  record.id = state.id;
  record.epoch = state.epoch;
  record.prototype = state.prototype;
  record.birth = state.birth;
  record.activation_state = state.awake ? 1 : 2;
  record.p_WB = state.pose.p_WB;
  record.R_WB = state.pose.q_WB.toRotationMatrix();
  record.v_WB = state.v_WB;
  record.w_WB = state.w_WB;
  return record;
}

Snapshot KinematicWorld::snapshot_of(const Node& node) const {
  Snapshot snapshot;
  snapshot.step = now_;
  std::map<BodyId, std::uint32_t> index;
  for (const BodyId id : node.hosted) {
    index.emplace(id, static_cast<std::uint32_t>(snapshot.bodies.size()));
    snapshot.bodies.push_back(state_of_body(bodies_.at(id)));
  }
  if (now_ == 0) return snapshot;
  const auto last_look = static_cast<std::size_t>(now_ * rules_.substeps - 1);
  for (const Pair& pair : watched_) {
    const auto a = index.find(pair.first);
    const auto b = index.find(pair.second);
    if (a == index.end() || b == index.end() || !overlap(pair, last_look)) continue;
    snapshot.contacts.push_back({std::min(a->second, b->second), std::max(a->second, b->second)});
  }
  return snapshot;
}

}  // namespace aurasim::core::testing
