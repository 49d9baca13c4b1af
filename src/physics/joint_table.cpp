#include "physics/joint_table.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "core/joint_ways.h"
#include "physics/awaken.h"
#include "physics/bullet_convert.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {
namespace {

// Columns of a joint's values. Always: whether it is broken, and the impulse of its last solve (N s or N m s), which
// Bullet reports but does not start from. Next, if not 0 or if later columns follow: the turns of a hinge, and the last
// impulse of its drive. Last, if the drive is not that of the scene: the drive; an infinite max_effort is written as
// -1.
constexpr std::size_t kBroken = 0;
constexpr std::size_t kImpulse = 1;
constexpr std::size_t kTurns = 2;
constexpr std::size_t kDriveImpulse = 3;
constexpr std::size_t kDrive = 4;
constexpr std::size_t kFewValues = 2, kMoreValues = 4, kAllValues = 10;
constexpr double kLargest = 1e12;  ///< largest number of a drive

constexpr double kTurn_rad = 2 * std::numbers::pi;

bool is_here(const BodyTable& bodies, core::BodyId id) { return bodies.find(id) != nullptr; }

btRigidBody* born_body(BodyTable& bodies, core::BodyId id) {
  HostedBody* const body = bodies.find(id);
  return body != nullptr && body->born ? body->rigid.get() : nullptr;
}

bool has(const core::ClusterState& cluster, core::BodyId id) {
  return std::binary_search(cluster.bodies.begin(), cluster.bodies.end(), core::BodyRecord{.id = id},
                            [](const auto& a, const auto& b) { return a.id < b.id; });
}

double bounded(double x) { return std::isnan(x) ? 0 : std::clamp(x, -kLargest, kLargest); }

core::JointDrive bounded(const core::JointDrive& d) {
  const double most = d.max_effort >= 0 && d.max_effort <= kLargest ? d.max_effort : core::JointDrive{}.max_effort;
  return {.position = bounded(d.position),
          .speed = bounded(d.speed),
          .stiffness = std::max(bounded(d.stiffness), 0.0),
          .damping = std::max(bounded(d.damping), 0.0),
          .effort = bounded(d.effort),
          .max_effort = most};
}

void wake_both(btTypedConstraint* constraint) {
  if (constraint == nullptr) return;
  for (btRigidBody* body : {&constraint->getRigidBodyA(), &constraint->getRigidBodyB()}) {
    if (!body->isStaticObject()) awaken(*body);
  }
}

}  // namespace

JointTable::JointTable(const core::Scene& scene, const Settings& settings)
    : scene_(&scene),
      substep_s_(settings.step_s / settings.substeps),
      look_s_(settings.step_s / settings.looks()),
      is_soft_(settings.looks_once()),
      ground_(std::make_unique<btRigidBody>(0, nullptr, nullptr)) {
  entries_.resize(scene.joints.size());
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    const core::JointSpec& joint = scene.joints[i];
    entries_[i].axes = axes_of(joint, frames_of(joint, scene), substep_s_);
    joints_of_[joint.a].push_back(core::JointId{i});
    if (joint.b) joints_of_[*joint.b].push_back(core::JointId{i});
  }
  std::optional<core::JointWays> ways;
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    const std::optional<core::JointCoupling> coupling = core::coupling_of(scene.joints[i].kind);
    if (!coupling) continue;
    if (!ways) ways.emplace(core::ends_of(scene.joints));
    followers_.push_back({core::JointId{i}, *coupling, ways->way(core::JointId{i}, coupling->leader)});
  }
}

const std::vector<core::JointId>& JointTable::joints_of(core::BodyId body) const {
  static const std::vector<core::JointId> kNone;
  const auto found = joints_of_.find(body);
  return found != joints_of_.end() ? found->second : kNone;
}

void JointTable::restore(const core::ClusterState& cluster, const BodyTable& bodies) {
  for (const core::JointRecord& record : cluster.joints) {
    const std::size_t place = core::value_of(record.id);
    const std::size_t end = std::size_t{record.first_value} + record.value_count;
    const bool is_whole = record.value_count == kFewValues || record.value_count == kMoreValues ||
                          (record.value_count == kAllValues && place < entries_.size() && entries_[place].axes.own);
    if (place >= entries_.size() || !is_whole || end > cluster.joint_values.size()) continue;
    const core::JointSpec& joint = scene_->joints[place];
    if (!is_here(bodies, joint.a) && !(joint.b && is_here(bodies, *joint.b))) continue;
    read_values(std::span(cluster.joint_values).subspan(record.first_value, record.value_count), entries_[place]);
  }
}

void JointTable::read_values(std::span<const double> values, Entry& entry) const {
  if (values[kBroken] != 0) entry.broken = true;
  if (values.size() < kMoreValues) return;
  entry.axes.turns_rad = kTurn_rad * values[kTurns];
  entry.axes.drive_impulse = values[kDriveImpulse];
  if (values.size() < kAllValues) return;
  entry.axes.drive = bounded(core::JointDrive::of(values.subspan<kDrive, core::JointDrive::kNumbers>()));
  entry.driven_anew = true;
}

std::size_t JointTable::value_count(const Entry& entry) const {
  if (entry.driven_anew) return kAllValues;
  return entry.axes.turns_rad != 0 || entry.axes.drive_impulse != 0 ? kMoreValues : kFewValues;
}

void JointTable::write_values(const Entry& entry, std::span<double> values) const {
  values[kBroken] = entry.broken ? 1 : 0;
  values[kImpulse] = entry.constraint ? static_cast<double>(entry.constraint->internalGetAppliedImpulse()) : 0;
  if (values.size() < kMoreValues) return;
  values[kTurns] = std::round(entry.axes.turns_rad / kTurn_rad);
  values[kDriveImpulse] = entry.axes.drive_impulse;
  if (values.size() < kAllValues) return;
  core::JointDrive drive = *entry.axes.drive;
  if (std::isinf(drive.max_effort)) drive.max_effort = -1;
  std::ranges::copy(drive.numbers(), values.subspan(kDrive).begin());
}

void JointTable::connect(core::BodyId body, BodyTable& bodies, DynamicsWorld& world) {
  for (const core::JointId id : joints_of(body)) connect(id, bodies, world);
}

void JointTable::connect(core::JointId id, BodyTable& bodies, DynamicsWorld& world) {
  const core::JointSpec& joint = scene_->joints[core::value_of(id)];
  Entry& entry = entries_[core::value_of(id)];
  if (entry.constraint || entry.broken) return;
  btRigidBody* const a = born_body(bodies, joint.a);
  btRigidBody* const b = joint.b ? born_body(bodies, *joint.b) : ground_.get();
  if (a == nullptr || b == nullptr) return;
  entry.constraint = make_constraint(joint, entry.axes.frames, *a, *b, substep_s_);
  entry.constraint->setUserConstraintPtr(&entry.axes);
  begin(entry);
  world.connect(*entry.constraint, static_cast<int>(core::value_of(id)), joint.collide || !joint.b);
  connected_.insert(std::lower_bound(connected_.begin(), connected_.end(), id), id);
  mechanisms_are_old_ = true;
}

/// Gives a joint's constraint the state that its entry has.
void JointTable::begin(Entry& entry) {
  entry.constraint->internalSetAppliedImpulse(is_soft_ ? 0 : scalar(entry.axes.drive_impulse));
  if (entry.axes.own) measure_again(entry, 0);
}

void JointTable::put_back(const core::ClusterState& then, BodyTable& bodies, DynamicsWorld& world) {
  forget();
  restore(then, bodies);
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].constraint && entries_[i].broken) disconnect(entries_[i], world);
    if (entries_[i].constraint) {
      begin(entries_[i]);
    } else {
      connect(core::JointId{i}, bodies, world);
    }
  }
  forget_broken_off();
  mechanisms_are_old_ = true;  // bodies may have got blocks of their own
}

void JointTable::disconnect(Entry& entry, DynamicsWorld& world) {
  world.disconnect(*entry.constraint);
  entry.constraint.reset();
  mechanisms_are_old_ = true;
}

void JointTable::disconnect(const core::ClusterState& leaving, BodyTable& bodies, DynamicsWorld& world) {
  const auto stays = [&](core::BodyId id) { return is_here(bodies, id) && !has(leaving, id); };
  for (const core::BodyRecord& body : leaving.bodies) {
    for (const core::JointId id : joints_of(body.id)) {
      const core::JointSpec& joint = scene_->joints[core::value_of(id)];
      Entry& entry = entries_[core::value_of(id)];
      if (entry.constraint) disconnect(entry, world);
      // its bodies are gone; the hand-off carries its state
      if (!stays(joint.a) && !(joint.b && stays(*joint.b))) forget(id);
    }
  }
  forget_broken_off();
}

void JointTable::forget_broken_off() {
  std::erase_if(connected_, [this](core::JointId id) { return !entries_[core::value_of(id)].constraint; });
}

/// Measures a joint. The angle of a hinge is known up to whole turns: the turn nearest to where its speed takes it is
/// assumed.
void JointTable::measure_again(Entry& entry, double since_s) {
  JointAxes& axes = entry.axes;
  const JointMotion now = measure(axes, entry.constraint->getRigidBodyA(), entry.constraint->getRigidBodyB());
  if (!std::isfinite(now.position) || !std::isfinite(now.speed)) return;  // a body of it is breaking down
  if (axes.own == 5u && since_s > 0) {
    axes.turns_rad = kTurn_rad * std::round((axes.position + since_s * now.speed - now.position) / kTurn_rad);
  }
  axes.position = now.position + axes.turns_rad;
  entry.speed = now.speed;
  if (is_soft_) return;  // the soft step has set the impulse
  const bool is_pushed = axes.drive ? axes.is_driven() : axes.has_motor;
  axes.drive_impulse = is_pushed ? static_cast<double>(entry.constraint->internalGetAppliedImpulse()) : 0;
}

/// Updates the targets of coupled joints. They depend only on bodies and joints of one cluster, so hand-offs change no
/// bit.
void JointTable::follow() {
  for (const Follower& follower : followers_) {
    Entry& entry = entries_[core::value_of(follower.joint)];
    if (!entry.constraint) continue;
    JointAxes& axes = entry.axes;
    axes.lead = axes.lead_speed = 0;
    axes.lost_its_leader = false;
    if (entry.driven_anew) continue;
    axes.lost_its_leader = follower.way.empty() || !std::ranges::all_of(follower.way, [this](core::JointId id) {
                             return entries_[core::value_of(id)].constraint != nullptr;
                           });
    if (axes.lost_its_leader) continue;
    const Entry& leader = entries_[core::value_of(follower.coupling.leader)];
    const btTypedConstraint& joint = *leader.constraint;
    const JointMotion now = measure(leader.axes, joint.getRigidBodyA(), joint.getRigidBodyB());
    if (!std::isfinite(now.position) || !std::isfinite(now.speed)) continue;  // a body of it is breaking down
    axes.lead = follower.coupling.ratio * (now.position + leader.axes.turns_rad);
    axes.lead_speed = follower.coupling.ratio * now.speed;
  }
}

void JointTable::finish_look(DynamicsWorld& world) {
  std::atomic<bool> some_broke = false;
  world.team().for_each(connected_.size(), [&](std::size_t i) {
    Entry& entry = entries_[core::value_of(connected_[i])];
    if (!entry.constraint->isEnabled()) {
      some_broke = true;
    } else if (entry.axes.own) {
      measure_again(entry, look_s_);
    }
  });
  if (!some_broke) return;
  std::erase_if(connected_, [&](core::JointId id) {
    Entry& entry = entries_[core::value_of(id)];
    if (entry.constraint->isEnabled()) return false;
    entry.broken = true;
    disconnect(entry, world);
    return true;
  });
}

void JointTable::forget(core::JointId id) {
  Entry& entry = entries_[core::value_of(id)];
  if (entry.driven_anew) entry.axes.drive = core::drive_of(scene_->joints[core::value_of(id)].kind);
  entry.broken = entry.driven_anew = false;
  entry.axes.position = entry.axes.turns_rad = entry.axes.drive_impulse = entry.speed = 0;
  entry.axes.lead = entry.axes.lead_speed = 0;
  entry.axes.lost_its_leader = false;
}

void JointTable::forget() {
  for (std::uint32_t i = 0; i < entries_.size(); ++i) forget(core::JointId{i});
}

void JointTable::drive(core::JointId id, const core::JointDrive& drive) {
  Entry& entry = entries_.at(core::value_of(id));
  const core::JointDrive wanted = bounded(drive);
  if (!entry.axes.own || entry.broken || (entry.driven_anew && entry.axes.drive == wanted)) return;
  entry.axes.drive = wanted;
  entry.driven_anew = true;
  wake_both(entry.constraint.get());
}

void JointTable::let_go(core::JointId id) {
  Entry& entry = entries_.at(core::value_of(id));
  if (!entry.driven_anew) return;
  entry.axes.drive = core::drive_of(scene_->joints[core::value_of(id)].kind);
  entry.driven_anew = false;
  wake_both(entry.constraint.get());
}

std::optional<JointMotion> JointTable::motion(core::JointId id) const {
  const Entry& entry = entries_.at(core::value_of(id));
  if (!entry.axes.own || !entry.constraint) return std::nullopt;
  return JointMotion{entry.axes.position, entry.speed, entry.axes.drive_impulse / substep_s_};
}

void JointTable::append(core::JointId id, core::ClusterState& cluster) const {
  const Entry& entry = entries_[core::value_of(id)];
  const auto first = static_cast<std::uint32_t>(cluster.joint_values.size());
  cluster.joints.push_back({id, first, static_cast<std::uint32_t>(value_count(entry))});
  cluster.joint_values.resize(first + value_count(entry));
  write_values(entry, std::span(cluster.joint_values).subspan(first));
}

void JointTable::copy_all(const BodyTable& bodies, core::ClusterState& all) const {
  all.joints.clear();
  all.joint_values.clear();
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    const core::JointSpec& joint = scene_->joints[i];
    if (bodies.find(joint.a) != nullptr || (joint.b && bodies.find(*joint.b) != nullptr)) append(core::JointId{i}, all);
  }
}

std::uint64_t JointTable::append_to(core::ClusterState& cluster) const {
  std::vector<core::JointId> joints;
  for (const core::BodyRecord& body : cluster.bodies) {
    joints.insert(joints.end(), joints_of(body.id).begin(), joints_of(body.id).end());
  }
  std::sort(joints.begin(), joints.end());
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  std::uint64_t across = 0;
  for (const core::JointId id : joints) {
    const core::JointSpec& joint = scene_->joints[core::value_of(id)];
    const Entry& entry = entries_[core::value_of(id)];
    append(id, cluster);
    if (entry.constraint && joint.b && !(has(cluster, joint.a) && has(cluster, *joint.b))) ++across;
  }
  return across;
}

bool JointTable::mechanisms_changed() {
  if (!std::exchange(mechanisms_are_old_, false)) return false;
  mechanisms_ = core::mechanisms_of(scene_->joints, connected_);
  return true;
}

void JointTable::list_pairs(const BodyTable& bodies, std::vector<core::Contact>& pairs) const {
  pairs.clear();
  for (const core::JointId id : connected_) {
    const core::JointSpec& joint = scene_->joints[core::value_of(id)];
    if (!joint.b) continue;
    const auto [a, b] =
        std::minmax({bodies.find(joint.a)->rigid->getUserIndex(), bodies.find(*joint.b)->rigid->getUserIndex()});
    pairs.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const auto& x, const auto& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
}

}  // namespace aurasim::physics
