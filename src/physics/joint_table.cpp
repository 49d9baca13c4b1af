#include "physics/joint_table.h"

#include <algorithm>
#include <tuple>

namespace aurasim::physics {
namespace {

// Columns of a joint's values: whether it is broken, and the impulse of its last solve (N s or N m s), which Bullet
// reports but does not start from.
constexpr std::size_t kBroken = 0;
constexpr std::size_t kImpulse = 1;
constexpr std::uint32_t kValues = 2;

bool is_here(const BodyTable& bodies, core::BodyId id) { return bodies.find(id) != nullptr; }

btRigidBody* born_body(BodyTable& bodies, core::BodyId id) {
  HostedBody* const body = bodies.find(id);
  return body != nullptr && body->born ? body->rigid.get() : nullptr;
}

bool has(const core::ClusterState& cluster, core::BodyId id) {
  return std::binary_search(cluster.bodies.begin(), cluster.bodies.end(), core::BodyRecord{.id = id},
                            [](const auto& a, const auto& b) { return a.id < b.id; });
}

}  // namespace

JointTable::JointTable(const core::Scene& scene, const Settings& settings)
    : scene_(&scene),
      substep_s_(settings.step_s / settings.substeps),
      ground_(std::make_unique<btRigidBody>(0, nullptr, nullptr)) {
  entries_.resize(scene.joints.size());
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    const core::JointSpec& joint = scene.joints[i];
    entries_[i].axes = axes_of(joint, frames_of(joint, scene, settings.p_WO), substep_s_);
    joints_of_[joint.a].push_back(core::JointId{i});
    if (joint.b) joints_of_[*joint.b].push_back(core::JointId{i});
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
    if (place >= entries_.size() || record.value_count != kValues || end > cluster.joint_values.size()) continue;
    const core::JointSpec& joint = scene_->joints[place];
    if (!is_here(bodies, joint.a) && !(joint.b && is_here(bodies, *joint.b))) continue;
    if (cluster.joint_values[record.first_value + kBroken] != 0) entries_[place].broken = true;
  }
}

void JointTable::connect(core::BodyId body, BodyTable& bodies, DynamicsWorld& world) {
  for (const core::JointId id : joints_of(body)) {
    const core::JointSpec& joint = scene_->joints[core::value_of(id)];
    Entry& entry = entries_[core::value_of(id)];
    if (entry.constraint || entry.broken) continue;
    btRigidBody* const a = born_body(bodies, joint.a);
    btRigidBody* const b = joint.b ? born_body(bodies, *joint.b) : ground_.get();
    if (a == nullptr || b == nullptr) continue;
    entry.constraint = make_constraint(joint, entry.axes.frames, *a, *b, substep_s_);
    entry.constraint->setUserConstraintPtr(&entry.axes);
    world.connect(*entry.constraint, static_cast<int>(core::value_of(id)), joint.collide || !joint.b);
    connected_.insert(std::lower_bound(connected_.begin(), connected_.end(), id), id);
  }
}

void JointTable::disconnect(Entry& entry, DynamicsWorld& world) {
  world.disconnect(*entry.constraint);
  entry.constraint.reset();
}

void JointTable::disconnect(const core::ClusterState& leaving, BodyTable& bodies, DynamicsWorld& world) {
  const auto stays = [&](core::BodyId id) { return is_here(bodies, id) && !has(leaving, id); };
  for (const core::BodyRecord& body : leaving.bodies) {
    for (const core::JointId id : joints_of(body.id)) {
      const core::JointSpec& joint = scene_->joints[core::value_of(id)];
      Entry& entry = entries_[core::value_of(id)];
      if (entry.constraint) disconnect(entry, world);
      if (!stays(joint.a) && !(joint.b && stays(*joint.b))) entry.broken = false;  // for others to know
    }
  }
  std::erase_if(connected_, [this](core::JointId id) { return !entries_[core::value_of(id)].constraint; });
}

void JointTable::remove_broken(DynamicsWorld& world) {
  std::erase_if(connected_, [&](core::JointId id) {
    Entry& entry = entries_[core::value_of(id)];
    if (entry.constraint->isEnabled()) return false;
    entry.broken = true;
    disconnect(entry, world);
    return true;
  });
}

void JointTable::forget_broken() {
  for (Entry& entry : entries_) entry.broken = false;
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
    cluster.joints.push_back({id, static_cast<std::uint32_t>(cluster.joint_values.size()), kValues});
    cluster.joint_values.resize(cluster.joint_values.size() + kValues);
    double* const values = &cluster.joint_values[cluster.joints.back().first_value];
    values[kBroken] = entry.broken ? 1 : 0;
    values[kImpulse] = entry.constraint ? static_cast<double>(entry.constraint->internalGetAppliedImpulse()) : 0;
    if (entry.constraint && joint.b && !(has(cluster, joint.a) && has(cluster, *joint.b))) ++across;
  }
  return across;
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
