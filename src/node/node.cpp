#include "node/node.h"

#include <algorithm>
#include <utility>

#include "core/horizon.h"
#include "core/progress.h"
#include "node/scene_additions.h"
#include "node/timed.h"
#include "physics/clearance.h"
#include "physics/state_hash.h"

namespace aurasim::node {
namespace {

std::uint64_t hash_sum(std::span<const core::BodyRecord> bodies) {
  std::uint64_t sum = 0;
  for (const core::BodyRecord& body : bodies) sum += physics::state_hash(body);
  return sum;
}

/// True if the scene has all objects that a hand-off names. Every object is in the scene by the time that the hand-off
/// takes effect. If one is missing, the sender computes another world.
bool is_of_the_scene(const core::ClusterState& cluster, const core::Scene& scene) {
  const auto is_known = [&](core::ObjectRef object) {
    return object >= 0 || -(object + 1) < static_cast<core::ObjectRef>(scene.statics.size());
  };
  return std::ranges::all_of(
             cluster.bodies,
             [&](const auto& body) { return core::value_of(body.prototype) < scene.prototypes.size(); }) &&
         std::ranges::all_of(cluster.joints,
                             [&](const auto& joint) { return core::value_of(joint.id) < scene.joints.size(); }) &&
         std::ranges::all_of(cluster.manifolds,
                             [&](const auto& m) { return is_known(m.object0) && is_known(m.object1); });
}

MadeUp made_up(core::Step step, std::span<const core::BodyRecord> bodies, const core::ClusterState& cluster) {
  MadeUp state{step, {bodies.begin(), bodies.end()}, {}, {}};
  for (const core::BodyRecord& body : cluster.bodies) {
    if (!std::ranges::binary_search(bodies, body.id, {}, &core::BodyRecord::id)) state.gone.push_back(body.id);
  }
  return state;
}

}  // namespace

Node::Node(const NodeSetup& setup, const core::Scene& scene, const core::RegionMap& map,
           transport::Transport& transport)
    : setup_(setup),
      scene_(scene),
      map_(&map),
      transport_(&transport),
      clearance_(physics::make_clearance_query(scene_)),
      world_(scene_, setup.physics),
      watch_(setup.physics.step_s, scene.gravity.norm(), setup.protocol.aura.lookahead, *clearance_),
      first_own_shape_(scene.shapes.size()) {
  world_.controls().use(setup.control);
  for (const core::Setpoints& recorded : setup_.recorded) {
    world_.controls().recall(recorded);
    for (const core::StaticSetpoint& goal : recorded.statics) recorded_moves_.push_back({recorded.at_step, goal});
  }
  expect_recorded_moves();
  protocol_.emplace(setup.protocol, map, *clearance_);
}

/// Announces the bodies that appear `birth_notice` steps after `state`. The owner of their place publishes them from
/// now on.
void Node::announce_births(core::Step state) {
  const core::Step birth = state + core::horizon::birth_notice(setup_.protocol.aura.lookahead);
  announce_spawns(birth);
  for (std::size_t k = 0; k < scene_.injectors.size(); ++k) {
    const core::Injector& injector = scene_.injectors[k];
    const std::uint64_t count = core::injected_count(injector, birth, setup_.physics.step_s);
    for (; next_injection_[k] < count; ++next_injection_[k]) {
      auto record = core::injected_body(injector, next_injection_[k], setup_.physics.step_s);
      if (!record || map_->owner(record->p_WB) != region()) continue;
      record->epoch = first_epoch_;
      world_.add({&*record, 1});
      watch_.newborn(record->id, record->birth);
      report_.births.push_back({record->id, record->birth});
    }
  }
}

void Node::note_removals() {
  report_.removals = world_.take_removed();
  for (const std::uint64_t request : world_.take_applied()) report_.applied.push_back({request, current_step(), {}});
  report_.declined = world_.take_declined();
  report_.unbearable = world_.take_unbearable();
}

void Node::take_mail() {
  const Timed timed(mail_s_, setup_.clock);
  transport_->take(inbox_);
  protocol_->accept(inbox_);
}

bool Node::ready() {
  take_mail();
  return redo_is_due() || protocol_->ready(current_step() + 1);
}

bool Node::ready_to_settle() {
  take_mail();
  return protocol_->ready(current_step() + setup_.protocol.aura.lookahead);
}

const StepReport& Node::take_map(const core::ProtocolSettings& settings, const core::RegionMap& map,
                                 transport::Transport& transport) {
  clear_report();
  confirmed_.clear();
  setup_.protocol = settings;
  settled_ = false;
  setup_.protocol.start = current_step();
  setup_.protocol.last_order = protocol_->last_order();
  is_changing_ = false;
  confirm_all();
  map_ = &map;
  transport_ = &transport;
  inbox_.clear();
  protocol_.emplace(setup_.protocol, map, *clearance_);
  const bool hashes = std::exchange(setup_.hash_states, false);  // the hash of this state has been reported
  finish_state();
  setup_.hash_states = hashes;
  take_cut();
  hold(report_);
  return report_;
}

const StepReport& Node::settle() {
  clear_report();
  apply(protocol_->receive(current_step() + setup_.protocol.aura.lookahead, core::Joining::kAll));
  note_effects_anew();
  return report_;
}

void Node::clear_report() {
  report_.put_back_from.reset();
  report_.put_back_for.clear();
  report_.durations = {};
  report_.departures.clear();
  report_.departed.clear();
  report_.let_go.clear();
  report_.arrivals.clear();
  report_.made_up.clear();
  report_.collisions.clear();
  report_.hash.clear();
  report_.births.clear();
  report_.removals.clear();
  report_.orders.clear();
  report_.applied.clear();
  report_.declined.clear();
  report_.effects = {};
  report_.unbearable = 0;
}

const StepReport& Node::step() {
  confirmed_.clear();
  if (redo_is_due()) {
    put_back();
    hold(report_);
    return report_;
  }
  note_arrived();
  compute_step();
  save_if_due();
  if (current_step() % core::horizon::kBetweenCuts == 0) take_cut();
  forget_cuts();
  forget_setpoints();
  order_redo();
  order_recorded_moves();
  hold(report_);
  return report_;
}

void Node::compute_step() {
  const core::Step n = current_step() + 1;
  clear_report();
  report_.durations.transport_s = std::exchange(mail_s_, 0);
  const core::Changes* changes = nullptr;
  {
    const Timed timed(report_.durations.protocol_s, setup_.clock);
    changes = &protocol_->receive(n);
  }
  {
    const Timed timed(report_.durations.physics_s, setup_.clock);
    for (const core::Order& order : changes->orders) heed(order);
    give_up_expected();
    apply(*changes);
    announce_births(n);
    core::Progress::mark();
    world_.step();
    core::Progress::mark();
    note_removals();
    note_effects();
    note_moves();
  }
  finish_state();
}

void Node::apply(const core::Changes& changes) {
  if (!changes.let_go.empty()) world_.release(changes.let_go);
  report_.let_go.insert(report_.let_go.end(), changes.let_go.begin(), changes.let_go.end());
  std::uint32_t nth = 0;
  for (const core::Adoption& adoption : changes.adoptions) {
    if (!is_of_the_scene(adoption.cluster, scene_)) {
      core::Inbox news;
      news.refusals.push_back({adoption.source, setup_.protocol.generation, adoption.stamp, core::MessageKind::kHandOff,
                               "unknown prototype, static or joint", setup_.protocol.redo});
      protocol_->accept(news);
      continue;
    }
    for (Cut& cut : cuts_) {
      if (adoption.stamp <= cut.step) cut.joining.push_back(adoption);
    }
    for (Saving& saving : saving_) {
      if (saving.cut && adoption.stamp <= saving.step) saving.cut->joining.push_back(adoption);
    }
    adopt(adoption, nth++);
  }
}

/// Takes in a cluster, the `nth` of those that join for the next state. After the last state its stamp may be a later
/// one; then it joins unchanged.
void Node::adopt(const core::Adoption& adoption, std::uint32_t nth) {
  world_.adopt(adoption.cluster, std::min(adoption.stamp, current_step()),
               [&](core::Step step, std::span<const core::BodyRecord> bodies) {
                 if (setup_.hash_states) report_.hash.push_back({step, hash_sum(bodies)});
                 if (is_observed_) report_.made_up.push_back(made_up(step, bodies, adoption.cluster));
                 protocol_->note_made_up(step, nth, bodies);
               });
  note_made_up_contacts();
  note_arrivals(adoption);
}

void Node::observe(bool states, bool contacts) {
  is_observed_ = states;
  world_.watch_contacts(contacts);
}

/// Adds the contacts of the made-up states that have just been reported, in the order of these states.
void Node::note_made_up_contacts() {
  std::vector<physics::MadeUpContacts> contacts = world_.take_made_up_contacts();
  const std::size_t first = report_.made_up.size() - std::min(report_.made_up.size(), contacts.size());
  for (std::size_t i = 0; first + i < report_.made_up.size(); ++i) {
    report_.made_up[first + i].contacts = std::move(contacts[i].contacts);
  }
}

std::vector<MadeUp> Node::foresee() {
  std::vector<MadeUp> states;
  for (const core::HandOff& hand_off : protocol_->intake().to_come()) {
    if (hand_off.stamp >= current_step() || !is_of_the_scene(hand_off.cluster, scene_)) continue;
    const std::size_t first = states.size();
    std::vector<physics::MadeUpContacts> contacts = world_.foresee(
        hand_off.cluster, hand_off.stamp, [&](core::Step step, std::span<const core::BodyRecord> bodies) {
          states.push_back(made_up(step, bodies, hand_off.cluster));
        });
    for (std::size_t i = 0; i < contacts.size(); ++i) states[first + i].contacts = std::move(contacts[i].contacts);
  }
  return states;
}

/// In deterministic mode state n needs the messages sent in states up to n - K.
bool Node::has_all_until(core::Step last) const {
  return protocol_->missing(last + setup_.protocol.aura.lookahead).empty();
}

void Node::note_arrivals(const core::Adoption& adoption) {
  for (const core::BodyRecord& body : adoption.cluster.bodies) {
    HandOffRow& row = report_.arrivals.emplace_back();
    row.stamp = adoption.stamp;
    row.joined = current_step() + 1;
    row.body = body.id;
    row.epoch = body.epoch;
    row.source = adoption.source;
    row.destination = region();
    row.reason = adoption.reason;
  }
  watch_.join(adoption);
}

/// The second half of a step: matches interest in the new state, publishes, and takes out the bodies that leave.
void Node::finish_state() {
  const core::Snapshot* snapshot = nullptr;
  {
    const Timed timed(report_.durations.physics_s, setup_.clock);
    snapshot = &world_.snapshot();
    core::Progress::mark();
  }
  if (setup_.hash_states) {
    const Timed timed(report_.durations.hash_s, setup_.clock);
    report_.hash.push_back({snapshot->step, hash_sum(world_.records())});
  }
  count(*snapshot);
  const std::vector<core::Departure>* departures = nullptr;
  {
    const Timed timed(report_.durations.protocol_s, setup_.clock);
    departures = &protocol_->observe(*snapshot);
  }
  {
    const Timed timed(report_.durations.watch_s, setup_.clock);
    watch_collisions(*snapshot);
    note_contacts(*snapshot);
  }
  report_.foreign_auras = protocol_->matching().foreign_auras();
  report_.projecting = protocol_->projection().projecting();
  report_.largest_cluster = protocol_->largest_cluster();
  core::Progress::mark();
  release(*departures);
  report_.violations.assign(protocol_->violations().recent().begin(), protocol_->violations().recent().end());
  report_.violations_total = protocol_->violations().total();
  const Timed timed(report_.durations.transport_s, setup_.clock);
  transport_->send(protocol_->outbox());
}

/// Counts late and missed collisions. There are none in a run with redo, which checks every state and computes it again
/// if needed.
void Node::watch_collisions(const core::Snapshot& snapshot) {
  if (protocol_->computes_again()) {
    for (const physics::Collision& collision : world_.collisions()) report_.collisions.push_back({collision});
    return;
  }
  const core::Step last_violation = protocol_->last_violation_step();
  watch_.judge(world_.collisions(), last_violation, report_.collisions);
  watch_.judge_arrivals(snapshot, protocol_->matching(), last_violation, report_.collisions);
  watch_.compare(snapshot, protocol_->matching(), last_violation, report_.collisions);
}

/// Updates which bodies have had a contact since they came. Both lists are in ascending order and share most bodies.
void Node::note_contacts(const core::Snapshot& snapshot) {
  std::swap(touched_, touched_before_);
  touched_.clear();
  auto before = touched_before_.begin();
  for (const core::BodyState& body : snapshot.bodies) {
    while (before != touched_before_.end() && before->id < body.id) ++before;
    touched_.push_back({body.id, before != touched_before_.end() && before->id == body.id && before->touched});
  }
  for (const core::Contact& contact : snapshot.contacts)
    touched_[contact.a].touched = touched_[contact.b].touched = true;
}

bool Node::take_touched(core::BodyId id) {
  const auto found = std::ranges::lower_bound(touched_, id, {}, &Touch::id);
  return found != touched_.end() && found->id == id && std::exchange(found->touched, false);
}

void Node::release(std::span<const core::Departure> departures) {
  if (departures.empty()) return;
  std::vector<core::ClusterState> clusters;
  {
    const Timed timed(report_.durations.physics_s, setup_.clock);
    std::vector<std::span<const core::BodyId>> leaving;
    for (const core::Departure& departure : departures) leaving.emplace_back(departure.bodies);
    clusters = world_.release(leaving);
  }
  for (std::size_t i = 0; i < departures.size(); ++i) hand_over(departures[i], std::move(clusters[i]));
}

void Node::hand_over(const core::Departure& departure, core::ClusterState cluster) {
  note_left_behind(cluster);
  for (const core::BodyRecord& body : cluster.bodies) {
    HandOffRow& row = report_.departures.emplace_back();
    row.stamp = current_step();
    row.body = body.id;
    row.epoch = body.epoch + 1;
    row.source = region();
    row.destination = departure.destination;
    row.reason = departure.reason;
    row.touched = take_touched(body.id);
    report_.departed.push_back(body);
  }
  const Timed timed(report_.durations.protocol_s, setup_.clock);
  protocol_->hand_over(departure, std::move(cluster));
}

void Node::count(const core::Snapshot& snapshot) {
  report_.step = snapshot.step;
  report_.bodies = report_.awake = 0;
  for (const core::BodyState& body : snapshot.bodies) {
    if (body.birth > snapshot.step) continue;
    ++report_.bodies;
    report_.awake += body.awake;
  }
}

}  // namespace aurasim::node
