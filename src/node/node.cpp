#include "node/node.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/horizon.h"
#include "core/progress.h"
#include "core/seam_tree.h"
#include "core/united.h"
#include "node/seam_gathering.h"
#include "node/timed.h"
#include "physics/clearance.h"
#include "physics/state_hash.h"

namespace aurasim::node {
namespace {

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

/// Where regions are coupled, another one may be lost while `work` waits for its parcels. Then the node is broken: it
/// has no state until the run goes back.
template <class Work>
void compute_with_others(bool& is_broken, Work&& work) {
  try {
    work();
  } catch (const core::SeamsBroken&) {
    is_broken = true;
    throw;
  }
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
      clearance_(physics::make_clearance_query(scene_.scene())),
      world_(scene_.scene(), setup.physics),
      watch_(setup.physics.step_s, scene.gravity.norm(), setup.protocol.aura.lookahead, *clearance_),
      cuts_(setup.protocol.aura.lookahead),
      held_(setup.protocol.aura.redo, setup.protocol.aura.lookahead),
      statics_(setup.recorded) {
  world_.controls().use(setup.control);
  for (const core::Setpoints& recorded : setup_.recorded) world_.controls().recall(recorded);
  expect_recorded_moves();
  if (setup_.seams != nullptr) couple();
  protocol_.emplace(setup_.protocol, map, *clearance_);
}

/// Announces the bodies that appear `birth_notice` steps after `state`; those of orders appear in the state that the
/// order names. The owner of their place publishes them from now on.
void Node::announce_births(core::Step state) {
  const core::Step birth = state + core::horizon::birth_notice(setup_.protocol.aura.lookahead);
  for (NewBody& body : to_be_born_.take_due(scene(), injections_, birth, setup_.physics.step_s)) {
    core::BodyRecord& record = body.record;
    if (map_->owner(record.p_WB) != region() || (body.order && world_.contains(record.id))) continue;
    record.epoch = first_epoch_;
    if (body.order) world_.schedule(*body.order);  // the body's shape may be new
    world_.add({&record, 1});
    if (!protocol_->computes_again()) watch_.newborn(record.id, record.birth);
    report_.births.push_back({record.id, record.birth});
    if (body.order) report_.applied.push_back({body.order->request, record.birth, core::ref_of(record.id)});
  }
}

void Node::take_mail() {
  const Timed timed(mail_s_, setup_.clock);
  transport_->take(inbox_);
  protocol_->accept(inbox_);
  learn_of_redos();
}

bool Node::ready() {
  take_mail();
  if (is_broken_) return false;
  order_redo();
  if (redo_is_due()) return true;
  if (protocol_->may_gather()) gather();
  // Coupled nodes cannot go on without all others. One that is far from a dead one would not notice.
  if (owners_ && !protocol_->intake().dead_regions().empty()) return false;
  return protocol_->ready(current_step() + 1);
}

bool Node::ready_to_settle() {
  take_mail();
  return protocol_->ready(current_step() + setup_.protocol.aura.lookahead);
}

const StepReport& Node::settle() {
  clear_report();
  apply(protocol_->receive(current_step() + setup_.protocol.aura.lookahead, core::Joining::kAll));
  note_effects_anew();
  return report_;
}

const StepReport& Node::step() {
  held_.begin_step();
  const bool goes_back = redo_is_due();
  double took_s = mail_s_;
  {
    const Timed timed(took_s, setup_.clock);
    if (goes_back) {
      put_back();
    } else {
      compute_and_keep();
    }
  }
  time_spent_.add(current_step(), took_s, goes_back);
  hold();
  return report_;
}

/// Computes the next state, and keeps what a redo or somebody else may want of it.
void Node::compute_and_keep() {
  // Before the clusters for the next state are taken in, because some of them left before a saved state.
  saved_.note_whole(whole_by(current_step() + 1));
  compute_step();
  save_if_due();
  if (current_step() % core::horizon::kBetweenCuts == 0) take_cut();
  forget_cuts();
  forget_setpoints();
  order_recorded_moves();
}

void Node::compute_step() {
  const core::Step n = current_step() + 1;
  clear_report();
  report_.departures = std::exchange(gathered_.departures, {});
  report_.departed = std::exchange(gathered_.departed, {});
  report_.effects = std::exchange(gathered_.effects, {});
  report_.durations.transport_s = std::exchange(mail_s_, 0);
  const core::Changes* changes = nullptr;
  {
    const Timed timed(report_.durations.protocol_s, setup_.clock);
    changes = &protocol_->receive(n);
  }
  if (partners_) meet_partners(n, changes->introductions);
  {
    const Timed timed(report_.durations.physics_s, setup_.clock);
    for (const core::Order& order : changes->orders) execute(order);
    give_up_expected();
    apply(*changes);
    announce_births(n);
    core::Progress::mark();
    compute_state();
    core::Progress::mark();
    if (owners_) note_moved();
    note_removals();
    note_effects();
    note_moves();
  }
  finish_state();
}

/// Where regions are coupled, finds out with which ones this node exchanges parcels in the step. `introductions`: what
/// the regions that this one listens to have said, and what it has said.
void Node::meet_partners(core::Step n, std::span<const core::Introduction> introductions) {
  setup_.seams->begin(setup_.protocol.generation, n);
  if (!core::SeamTree(owners_->size()).is_needed()) return partners_->begin(introductions);
  const Timed timed(report_.durations.gathering_s, setup_.clock);
  compute_with_others(is_broken_,
                      [&] { partners_->begin(gather_pairs(*setup_.seams, region(), owners_->size(), introductions)); });
  setup_.seams->begin_exchanges();
}

void Node::compute_state() {
  compute_with_others(is_broken_, [this] { world_.step(); });
}

void Node::apply(const core::Changes& changes) {
  if (!changes.let_go.empty()) world_.release(changes.let_go);
  report_.let_go.insert(report_.let_go.end(), changes.let_go.begin(), changes.let_go.end());
  std::vector<const core::Adoption*> joining;
  for (const core::Adoption& adoption : changes.adoptions) {
    if (!is_of_the_scene(adoption.cluster, scene())) {
      core::Inbox news;
      news.refusals.push_back({adoption.source, setup_.protocol.generation, adoption.stamp, core::MessageKind::kHandOff,
                               "unknown prototype, static or joint", setup_.protocol.redo});
      protocol_->accept(news);
      continue;
    }
    // The cut of the state in which a redo begins was taken before the nodes gathered.
    if (setup_.protocol.redo == 0 || adoption.stamp > setup_.protocol.start) {
      cuts_.note_arrival(adoption);
      saved_.note_arrival(adoption);
    }
    joining.push_back(&adoption);
  }
  adopt(joining);
}

/// Takes in clusters. Those of one stamp make up the states that they have missed together, in one world. After the
/// last state a stamp may be a later one; then the cluster joins unchanged.
void Node::adopt(std::span<const core::Adoption* const> adoptions) {
  std::map<core::Step, core::ClusterState> by_stamp;
  for (const core::Adoption* const adoption : adoptions) core::append(by_stamp[adoption->stamp], adoption->cluster);
  for (auto& [stamp, clusters] : by_stamp) {
    core::put_in_order(clusters);
    world_.adopt(clusters, std::min(stamp, current_step()),
                 [&](core::Step step, std::span<const core::BodyRecord> bodies) {
                   if (setup_.hash_states) report_.hash.push_back({step, physics::state_hash_sum(bodies)});
                   if (is_observed_) report_.made_up.push_back(made_up(step, bodies, clusters));
                   protocol_->note_made_up(step, lonely_worlds_, bodies);
                 });
    ++lonely_worlds_;
    note_made_up_contacts();
  }
  for (const core::Adoption* const adoption : adoptions) note_arrivals(*adoption);
}

void Node::observe(bool states, bool contacts) {
  is_observed_ = states;
  world_.watch_contacts(contacts);
}

std::vector<MadeUp> Node::foresee() {
  std::vector<MadeUp> states;
  for (const core::HandOff& hand_off : protocol_->intake().to_come()) {
    if (hand_off.stamp >= current_step() || !is_of_the_scene(hand_off.cluster, scene())) continue;
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
    report_.hash.push_back({snapshot->step, world_.hash_sum()});
  }
  count(*snapshot);
  const std::vector<core::Departure>* departures = nullptr;
  {
    const Timed timed(report_.durations.protocol_s, setup_.clock);
    core::Snapshot nothing;  // where regions are coupled, no body is the protocol's concern
    nothing.step = snapshot->step;
    departures = &protocol_->observe(owners_ ? nothing : *snapshot);
    if (owners_) protocol_->introduce(world_.introductions_ahead());
  }
  {
    const Timed timed(report_.durations.watch_s, setup_.clock);
    watch_collisions(*snapshot);
    touches_.note(*snapshot);
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
/// if needed, and none where regions are coupled.
void Node::watch_collisions(const core::Snapshot& snapshot) {
  if (protocol_->computes_again() || owners_) {
    for (const physics::Collision& collision : world_.collisions()) report_.collisions.push_back({collision});
    return;
  }
  const core::Step last_violation = protocol_->last_violation_step();
  watch_.judge(world_.collisions(), last_violation, report_.collisions);
  watch_.judge_arrivals(snapshot, protocol_->matching(), last_violation, report_.collisions);
  watch_.compare(snapshot, protocol_->matching(), last_violation, report_.collisions);
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
  note_left_behind(cluster.bodies, current_step());
  for (const core::BodyRecord& body : cluster.bodies) {
    HandOffRow& row = report_.departures.emplace_back();
    row.stamp = current_step();
    row.body = body.id;
    row.epoch = body.epoch + 1;
    row.source = region();
    row.destination = departure.destination;
    row.reason = departure.reason;
    row.touched = touches_.take(body.id);
    report_.departed.push_back(body);
  }
  const Timed timed(report_.durations.protocol_s, setup_.clock);
  protocol_->hand_over(departure, std::move(cluster));
}

}  // namespace aurasim::node
