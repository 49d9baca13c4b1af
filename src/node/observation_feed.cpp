#include "node/observation_feed.h"

#include <algorithm>
#include <unordered_set>

namespace aurasim::node {
namespace {

using core::BodyId;
using core::BodyState;
using core::Interest;
using core::Observation;
using core::ObservedBody;

bool wants(const Interest& interest, const BodyState& body) {
  return interest.wants(body.id, body.prototype, body.pose.p_WB);
}

/// Adds the contacts of which at least one body is wanted. `bodies`: contains both bodies of each contact, ascending.
void add_contacts(const Interest& interest, const std::vector<BodyState>& bodies,
                  const std::vector<core::ContactImpulse>& contacts, Observation& to) {
  if (!interest.contacts) return;
  if (interest.all) {
    to.contacts = contacts;
    return;
  }
  const auto is_wanted = [&](core::ObjectRef ref) {
    const BodyState* const body =
        ref < 0 ? nullptr : core::find_body(bodies, static_cast<BodyId>(static_cast<std::uint64_t>(ref)));
    return body != nullptr && wants(interest, *body);
  };
  for (const core::ContactImpulse& contact : contacts) {
    if (is_wanted(contact.a) || is_wanted(contact.b)) to.contacts.push_back(contact);
  }
}

}  // namespace

ObservationFeed::ObservationFeed(const FeedSettings& settings, const core::Scene& scene) : settings_(settings) {
  for (std::uint32_t i = 0; i < scene.joints.size(); ++i) {
    const core::JointSpec& joint = scene.joints[i];
    const std::optional<int> coordinate = core::coordinate_of(joint);
    const core::InitialBody* const a = core::find_body(scene, joint.a);
    const core::InitialBody* const b = joint.b ? core::find_body(scene, *joint.b) : nullptr;
    if (!coordinate || a == nullptr || (joint.b && b == nullptr)) continue;
    const core::Pose X_WB = b != nullptr ? b->pose : core::Pose{};
    joints_.push_back({core::JointId{i}, joint.a, joint.b, core::frame_of(joint, a->pose, X_WB), *coordinate});
  }
}

void ObservationFeed::remember(const core::HandOff& hand_off, core::Step stamp) {
  for (const core::BodyRecord& record : hand_off.cluster.bodies) {
    left_.insert_or_assign(record.id, Left{core::state_of(record), hand_off.destination, stamp});
  }
}

void ObservationFeed::begin(core::Step step, const std::deque<core::HandOff>& under_way) {
  left_.clear();
  arrived_.clear();
  for (const core::HandOff& hand_off : under_way) remember(hand_off, std::min(step, hand_off.stamp));
}

void ObservationFeed::note(const StepReport& report, const std::deque<core::HandOff>& under_way) {
  // A body that joins for a step may leave in the same step, so arrivals come first.
  for (const HandOffRow& row : report.arrivals) {
    left_.erase(row.body);
    arrived_.insert_or_assign(row.body, report.step);
  }
  for (const physics::Removal& removal : report.removals) {
    left_.erase(removal.body);
    arrived_.insert_or_assign(removal.body, report.step);
  }
  for (std::size_t i = 0; i < report.departed.size(); ++i) {
    BodyState body = core::state_of(report.departed[i]);
    body.epoch = report.departures[i].epoch;
    left_.insert_or_assign(body.id, Left{body, report.departures[i].destination, report.departures[i].stamp});
    arrived_.erase(body.id);
  }
  // Entries are kept for longer than a message is under way, because nodes that are behind still refer to them.
  const core::Step old = report.step - 4 * settings_.lookahead - 8;
  std::erase_if(arrived_, [old](const auto& entry) { return entry.second < old; });
  std::unordered_set<BodyId> open;
  if (std::ranges::any_of(left_, [old](const auto& entry) { return entry.second.stamp < old; })) {
    for (const core::HandOff& hand_off : under_way) {
      for (const core::BodyRecord& body : hand_off.cluster.bodies) open.insert(body.id);
    }
    std::erase_if(left_, [&](const auto& entry) { return entry.second.stamp < old && !open.contains(entry.first); });
  }
}

Observation ObservationFeed::begin(const Interest& interest, core::Step stamp, std::uint32_t redo) const {
  Observation observation;
  observation.source = settings_.self;
  observation.generation = settings_.generation;
  observation.redo = redo;
  observation.stamp = stamp;
  observation.map_version = settings_.map_version;
  observation.sequence = interest.sequence;
  return observation;
}

/// Adds bodies on their way from here. A body that leaves in this state is known exactly. Of one that left earlier,
/// this node cannot know the present place, so it is marked stale.
void ObservationFeed::add_left(const Interest& interest, const core::Snapshot& snapshot, Observation& to) const {
  for (const auto& [id, left] : left_) {
    if (left.body.birth > snapshot.step || core::find_body(snapshot.bodies, id) != nullptr) continue;
    const bool stale = left.stamp < snapshot.step;
    const bool may_be_in_a_box = stale && !interest.boxes.empty();
    if (may_be_in_a_box || wants(interest, left.body)) {
      to.bodies.push_back({core::replica_body(left.body, left.destination), stale});
    } else if (!stale) {
      to.outside.push_back(id);
    }
  }
}

void ObservationFeed::add_outside(const Interest& interest, const core::Snapshot& snapshot, Observation& to) const {
  for (const auto& [id, since] : arrived_) {
    const BodyState* const body = core::find_body(snapshot.bodies, id);
    const bool is_shown = body != nullptr && body->birth <= snapshot.step && wants(interest, *body);
    if (!is_shown && !left_.contains(id)) to.outside.push_back(id);
  }
}

void ObservationFeed::add_joints(const Interest& interest, const std::vector<BodyState>& bodies,
                                 Observation& to) const {
  if (!interest.joints) return;
  for (const Joint& joint : joints_) {
    const BodyState* const a = core::find_body(bodies, joint.a);
    const BodyState* const b = joint.b ? core::find_body(bodies, *joint.b) : nullptr;
    if (a == nullptr || (joint.b && b == nullptr)) continue;
    if (!wants(interest, *a) && !(b != nullptr && wants(interest, *b))) continue;
    const core::JointMotion motion =
        core::joint_motion(joint.frame, joint.coordinate, *a, b != nullptr ? *b : BodyState{});
    to.joints.push_back({joint.id, motion.position, motion.speed});
  }
}

Observation ObservationFeed::compose(const Interest& interest, const core::Snapshot& snapshot,
                                     const std::vector<core::ContactImpulse>& contacts, std::uint32_t redo) const {
  Observation observation = begin(interest, snapshot.step, redo);
  for (const BodyState& body : snapshot.bodies) {
    if (body.birth <= snapshot.step && wants(interest, body)) {
      observation.bodies.push_back({core::replica_body(body, settings_.self), false});
    }
  }
  add_left(interest, snapshot, observation);
  add_outside(interest, snapshot, observation);
  std::ranges::sort(observation.bodies, {}, [](const ObservedBody& body) { return body.row.id; });
  std::ranges::sort(observation.outside);
  if (!interest.joints && !interest.contacts) return observation;
  std::vector<BodyState> known;  // bodies hosted here, and those that have left in this very state
  std::ranges::copy_if(snapshot.bodies, std::back_inserter(known),
                       [&](const BodyState& body) { return body.birth <= snapshot.step; });
  for (const auto& [id, left] : left_) {
    if (left.stamp == snapshot.step && core::find_body(snapshot.bodies, id) == nullptr) known.push_back(left.body);
  }
  std::ranges::sort(known, {}, &BodyState::id);
  add_joints(interest, known, observation);
  add_contacts(interest, known, contacts, observation);
  return observation;
}

Observation ObservationFeed::compose(const Interest& interest, const MadeUp& state, std::uint32_t redo) const {
  Observation observation = begin(interest, state.step, redo);
  observation.kind = Observation::Kind::kMadeUp;
  std::vector<BodyState> bodies;
  for (const core::BodyRecord& record : state.bodies) bodies.push_back(core::state_of(record));
  for (const BodyState& body : bodies) {
    if (wants(interest, body)) {
      observation.bodies.push_back({core::replica_body(body, settings_.self), false});
    } else {
      observation.outside.push_back(body.id);
    }
  }
  observation.outside.insert(observation.outside.end(), state.gone.begin(), state.gone.end());
  std::ranges::sort(observation.outside);
  add_joints(interest, bodies, observation);
  add_contacts(interest, bodies, state.contacts, observation);
  return observation;
}

}  // namespace aurasim::node
