#include "core/protocol.h"

#include <algorithm>
#include <utility>

#include "core/aura_record.h"
#include "core/horizon.h"
#include "core/make_aura.h"
#include "core/progress.h"

namespace aurasim::core {
namespace {

Nearness nearness_of(const ProtocolSettings& settings) { return {settings.neighbour_distance_m, settings.owners}; }

/// States in which an order, or what leads to one, reaches all nodes, at one hop a state. Where regions are coupled
/// only orders matter, which all come from region 0.
int hops_of_orders(const ProtocolSettings& settings, std::span<const std::vector<RegionId>> near) {
  return settings.owners != nullptr ? hops_from(RegionId{0}, near) : hops_across(near);
}

Vicinity vicinity_of(const ProtocolSettings& settings, const RegionMap& map) {
  Vicinity vicinity(map, settings.self, nearness_of(settings));
  for (const Listened& related : settings.related) vicinity.listen_to(related.region);
  return vicinity;
}

}  // namespace

Protocol::Protocol(const ProtocolSettings& settings, const RegionMap& map, const ClearanceQuery& clearance)
    : Protocol(settings, map, clearance, all_near(map, nearness_of(settings))) {}

Protocol::Protocol(const ProtocolSettings& settings, const RegionMap& map, const ClearanceQuery& clearance,
                   std::span<const std::vector<RegionId>> near)
    : settings_(settings),
      vicinity_(vicinity_of(settings, map)),
      map_version_(map.version()),
      aura_(make_aura(settings.aura, clearance)),
      intake_({settings.generation, settings.redo, settings.sync, settings.aura.lookahead, settings.start,
               settings.redo > 0},
              vicinity_, departures_),
      matching_(*aura_, vicinity_, settings_.together),
      projection_(*aura_, vicinity_),
      orders_(settings.last_order),
      hops_of_orders_(hops_of_orders(settings, near)),
      listening_(vicinity_, intake_, settings.aura.lookahead, settings.start, settings.related,
                 settings.listening_ends && settings.sync != SyncMode::kFreeRunning),
      introducer_(*aura_, vicinity_),
      gathers_(settings.redo > 0),
      check_(*aura_, vicinity_, settings.start),
      standing_(hops_across(near), settings.aura.lookahead) {
  if (settings.aura.redo) intake_.on_arrival([this](const Neighbour& neighbour) { check_.take(neighbour); });
}

Protocol::Protocol(const ProtocolSettings& settings, const RegionMap& map, const ClearanceQuery& clearance,
                   Continuation continuation)
    : Protocol(settings, map, clearance) {
  alarms_given_up_ = !continuation.dead.empty();
  orders_ = std::move(continuation.orders);
  alarms_ = std::move(continuation.alarms);
  violations_ = std::move(continuation.violations);
  counters_ = continuation.counters;
  Inbox news;
  for (const RegionId dead : continuation.dead) news.peers.push_back({dead, PeerChange::kLost});
  intake_.accept(news);
}

Continuation Protocol::continuation(const Order& redo) const {
  const Step now = outbox_.aura.stamp;
  Continuation next{orders_,
                    alarms_,
                    violations_,
                    counters_,
                    intake_.dead_regions(),
                    listening_.agreed(redo.at_step, std::get<Redo>(redo.action).cut)};
  next.orders.put_back(now, round());
  next.alarms.put_back(std::get<Redo>(redo.action).cut);
  return next;
}

void Protocol::accept(Inbox& inbox) {
  intake_.accept(inbox);
  orders_.receive(intake_.take_orders(inbox), outbox_.aura.stamp);
  alarms_.receive(intake_.take_alarms());
}

const Changes& Protocol::receive(Step n, Joining joining) {
  violations_.start_step();
  changes_.adoptions.clear();
  changes_.let_go.clear();
  changes_.introductions = outbox_.aura.introductions;
  std::vector<Adoption> arrived = intake_.receive(n, violations_, joining);
  let_go_of_what_others_own();
  for (Adoption& adoption : arrived) take_if_newer(adoption);
  receive_violations();
  if (settings_.sync != SyncMode::kFreeRunning) {  // in free-running mode regions agree on no state
    std::vector<Neighbour::Introduced> introduced = intake_.take_introductions();
    for (const Introduction& own : outbox_.aura.introductions) introduced.push_back({n - 1, own, vicinity_.self});
    if (settings_.owners == nullptr) listening_.receive(introduced);
    for (const Neighbour::Introduced& one : introduced) {
      if (one.stamp == n - 1 && one.by != vicinity_.self) changes_.introductions.push_back(one.pair);
    }
  }
  changes_.orders = orders_.take_news();
  for (Order& order : changes_.orders) apply_late(order, n);
  return changes_;
}

/// The copy with the highest epoch is the valid one. An arriving copy of a body that is here is refused unless its
/// epoch is higher; then the one here is let go.
void Protocol::take_if_newer(Adoption& adoption) {
  remove_bodies(adoption.cluster, [this](const BodyRecord& body) {
    const Track* here = find(body.id);
    const bool gone = !here || here->phase == Phase::kSent;
    if (!gone && here->epoch >= body.epoch) {
      ++counters_.stale_arrivals;
      return true;
    }
    if (!gone) let_go(body.id);
    return false;
  });
  if (!adoption.cluster.bodies.empty()) changes_.adoptions.push_back(std::move(adoption));
}

void Protocol::let_go_of_what_others_own() {
  for (const Neighbour& neighbour : intake_.neighbours()) {
    for (const AuraRecord& aura : neighbour.auras()) {
      if (aura.host == vicinity_.self) continue;
      const Track* here = find(aura.id);
      if (here && here->phase != Phase::kSent && here->epoch < aura.epoch) let_go(aura.id);
    }
  }
}

void Protocol::let_go(BodyId id) {
  if (std::find(changes_.let_go.begin(), changes_.let_go.end(), id) != changes_.let_go.end()) return;
  ++counters_.let_go;
  changes_.let_go.push_back(id);
}

void Protocol::receive_violations() {
  std::uint64_t received = 0;
  for (const Neighbour& neighbour : intake_.neighbours()) received += neighbour.violations();
  if (received != violations_received_) {
    Step newest = violations_.last_step();
    for (const Neighbour& neighbour : intake_.neighbours()) newest = std::max(newest, neighbour.applied());
    last_violation_step_ = std::max(last_violation_step_, newest);
  }
  violations_received_ = received;
  last_violation_step_ = std::max(last_violation_step_, violations_.last_step());
}

const Track* Protocol::find(BodyId id) const {
  const std::optional<std::uint32_t> here = matching_.own().find(id);
  return here ? &projection_.track(*here) : nullptr;
}

void Protocol::look(const Snapshot& snapshot) {
  outbox_.clear();
  departing_.clear();
  Progress::mark();
  matching_.look(snapshot, intake_.neighbours(), projection_.ghosts());
  Progress::mark();
  projection_.classify(snapshot, matching_);
}

const std::vector<Departure>& Protocol::observe(const Snapshot& snapshot) {
  const bool has_gathered = settings_.redo > 0 && snapshot.step == settings_.start + 1;
  full_ = listening_.begin(snapshot.step) || snapshot.step == settings_.start || has_gathered;
  look(snapshot);
  outbox_.aura.stamp = snapshot.step;
  check(snapshot);
  decide(snapshot);
  projection_.publish(snapshot, outbox_.aura, violations_, full_);
  last_violation_step_ = std::max(last_violation_step_, violations_.last_step());
  fill_header();
  return departing_;
}

/// The next batch is full, so it tells who has left.
const std::vector<Departure>& Protocol::gather(const Snapshot& snapshot) {
  gathers_ = false;
  intake_.take_start();
  look(snapshot);
  decide(snapshot);
  outbox_.aura = {};
  sign(outbox_.aura);
  outbox_.aura.stamp = snapshot.step;
  outbox_.aura.word = kGathered;
  outbox_.listeners = vicinity_.neighbours;
  return departing_;
}

void Protocol::sign(AuraBatch& batch) const {
  batch.word = 0;
  batch.source = vicinity_.self;
  batch.generation = settings_.generation;
  batch.redo = settings_.redo;
  batch.map_version = map_version_;
}

void Protocol::fill_header() {
  AuraBatch& batch = outbox_.aura;
  sign(batch);
  batch.full = full_;
  batch.top_speed_m_s = matching_.top_speed();
  batch.top_radius_m = matching_.top_radius();
  batch.violations = violations_.warnings();
  std::sort(batch.updates.begin(), batch.updates.end(),
            [](const AuraRecord& a, const AuraRecord& b) { return a.id < b.id; });
  departures_.due_again(batch.stamp, settings_.resend_after_steps, outbox_.hand_offs);
  batch.adopted = intake_.adopted();
  batch.orders = orders_.take_to_publish();
  batch.alarms = alarms_.take_to_publish();
  batch.past = std::exchange(past_, {});
  batch.introductions = introducer_.look(matching_.all_foreign(), matching_.others_top_speed());
  outbox_.listeners = vicinity_.neighbours;
  outbox_.expected = listening_.expected();
  outbox_.left = intake_.take_left();
}

void Protocol::check(const Snapshot& snapshot) {
  if (!aura_->rules().redo) return;
  check_.take_own(snapshot, matching_);
  check_.look(snapshot.step, intake_.neighbours());
  for (const Alarm& alarm : check_.found()) alarms_.raise(alarm.step, alarm.a, alarm.b);
}

void Protocol::note_made_up(Step step, std::uint32_t world, std::span<const BodyRecord> bodies) {
  if (aura_->rules().redo && step > settings_.start) note_lonely(step, world, bodies, past_);
}

/// Gives the check a state that bodies made up alone, and adds it to the `past` of a batch, for others' checks.
void Protocol::note_lonely(Step step, std::uint32_t world, std::span<const BodyRecord> bodies,
                           std::vector<AuraRecord>& past) {
  for (const BodyRecord& record : bodies) {
    const BodyState body = state_of(record);
    check_.take_made_up(body, step, world);
    past.push_back(aura_record(body, vicinity_.self, step));
  }
}

void Protocol::begin_to_stand() {
  standing_.begin(outbox_.aura.stamp);
  word_.aura = {};
  sign(word_.aura);
  word_.aura.stamp = standing_.state();
  word_.listeners = vicinity_.neighbours;
}

void Protocol::note_to_come(Step step, std::uint32_t world, std::span<const BodyRecord> bodies) {
  note_lonely(step, world, bodies, word_.aura.past);
}

const Outbox* Protocol::next_word() {
  if (standing_.is_checked_by_all(intake_)) checked_by_all_ = standing_.state();
  if (!standing_.may_say_more(intake_)) return nullptr;
  if (standing_.said() == 1) check_as_it_stands();
  if (!alarms_.standing().empty()) return nullptr;
  if (standing_.said() == 1) word_.aura.past.clear();
  word_.aura.word = standing_.say();
  return &word_;
}

void Protocol::check_as_it_stands() {
  for (const Neighbour& neighbour : intake_.neighbours()) {
    if (!neighbour.alive()) continue;
    const AuraBatch* const word = neighbour.word(standing_.state(), 1);
    if (word != nullptr) check_.take_to_come(neighbour, word->past);
  }
  check_.look_at_all(standing_.state());
  for (const Alarm& alarm : check_.found()) alarms_.raise(alarm.step, alarm.a, alarm.b);
}

/// The newest state whose check was over `patience` states ago. After a redo, alarms that still stand are published
/// anew.
Step Protocol::heard_of_all(Step patience) const {
  const Step now = outbox_.aura.stamp;
  const Step confirmed = now - horizon::check(aura_->rules().lookahead) - patience;
  const bool is_first_round = settings_.redo > 0 && now < settings_.start + patience;
  return is_first_round ? std::min(confirmed, settings_.start - patience) : confirmed;
}

Step Protocol::before_alarms(Step confirmed) const {
  for (const Alarm& alarm : alarms_.standing()) confirmed = std::min(confirmed, alarm.step - 1);
  return confirmed;
}

/// An alarm takes at most a round to this node.
Step Protocol::confirmed_here() const { return before_alarms(heard_of_all(round() + 1)); }

/// An alarm takes at most a round to the lead, and the order of a redo at most a round from there.
Step Protocol::confirmed_but_for_alarms() const { return heard_of_all(2 * round() + 2); }

Step Protocol::confirmed() const { return before_alarms(confirmed_but_for_alarms()); }

Step Protocol::earliest_agreement() const { return outbox_.aura.stamp + 1 + round(); }

/// Counts an order that arrived after its state as a violation, and executes it now. A move of a static may have been
/// expected, and keeps its state: who executes it knows whether that changes a state of the past. A redo always names
/// such a state.
void Protocol::apply_late(Order& order, Step n) {
  if (order.at_step >= n) return;
  if (std::holds_alternative<Redo>(order.action) || std::holds_alternative<MoveStatic>(order.action)) return;
  violations_.add({ViolationKind::kLatency, n, vicinity_.self, {}, double(n - order.at_step), 0});
  order.at_step = n;
}

Step Protocol::earliest_effect() const {
  return earliest_agreement() + horizon::birth_notice(aura_->rules().lookahead) + 1;
}

void Protocol::report_frame(Step step, double frame_s) {
  if (frame_s <= aura_->rules().frame_s) return;
  violations_.add({ViolationKind::kFrame, step, vicinity_.self, {}, frame_s, aura_->rules().frame_s});
}

std::vector<RegionId> assign_hosts(const RegionMap& map, const AuraRules& rules, const ClearanceQuery& clearance,
                                   const Snapshot& scene) {
  std::vector<RegionId> hosts(scene.bodies.size());
  for (std::size_t i = 0; i < hosts.size(); ++i) hosts[i] = map.owner(scene.bodies[i].pose.p_WB);
  AuraRules early = rules;
  early.lookahead = horizon::lookahead_at_start(rules.lookahead);
  const std::unique_ptr<const Aura> aura = make_aura(early, clearance);
  if (!aura->warns() || map.size() == 1) return hosts;
  std::vector<Path> paths;
  for (const BodyState& body : scene.bodies) {
    paths.push_back(path_of(body, scene.step, clearance));
    paths.back().speed_m_s = aura->speed_of(body);
  }
  const std::vector<std::uint8_t> one_hop(scene.bodies.size(), 1);
  Clusters clusters(*aura);
  clusters.begin(paths, one_hop, scene.contacts, scene.joints);
  for (std::uint32_t i = 0; i < hosts.size(); ++i) clusters.complete(i);
  for (std::uint32_t i = 0; i < hosts.size(); ++i) {
    RegionId lowest = hosts[i];
    clusters.for_each_member(i,
                             [&](std::uint32_t j) { lowest = std::min(lowest, map.owner(scene.bodies[j].pose.p_WB)); });
    hosts[i] = lowest;
  }
  return hosts;
}

}  // namespace aurasim::core
