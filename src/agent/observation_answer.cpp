#include "agent/observation_answer.h"

#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>

#include "agent/answers.h"

namespace aurasim::agent {
namespace {

using nlohmann::json;

/// Marks a ray that has hit nothing: no object reference is that low.
constexpr std::int64_t kNothing = std::numeric_limits<std::int64_t>::min();

template <class T>
void put(std::string& bytes, const T& value) {
  static_assert(std::is_arithmetic_v<T>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put(std::string& bytes, const core::Vec3& v) {
  for (int axis = 0; axis < 3; ++axis) put(bytes, v[axis]);
}

template <class Rows, class Of>
void put_column(std::string& bytes, const Rows& rows, const Of& of) {
  for (const auto& row : rows) put(bytes, of(row));
}

void put_ids(std::string& bytes, const std::vector<core::BodyId>& ids) {
  put_column(bytes, ids, [](core::BodyId id) { return core::value_of(id); });
}

void put_contacts(std::string& bytes, const std::vector<core::ContactImpulse>& contacts) {
  put_column(bytes, contacts, [](const core::ContactImpulse& c) { return c.a; });
  put_column(bytes, contacts, [](const core::ContactImpulse& c) { return c.b; });
  put_column(bytes, contacts, [](const core::ContactImpulse& c) { return c.p_W; });
  put_column(bytes, contacts, [](const core::ContactImpulse& c) { return c.normal_W; });
  put_column(bytes, contacts, [](const core::ContactImpulse& c) { return c.impulse_Ns; });
}

void put_joints(std::string& bytes, const std::vector<core::JointState>& joints) {
  put_column(bytes, joints, [](const core::JointState& j) { return core::value_of(j.id); });
  put_column(bytes, joints, [](const core::JointState& j) { return j.position; });
  put_column(bytes, joints, [](const core::JointState& j) { return j.speed; });
}

void put_hits(std::string& bytes, const std::vector<physics::RayHit>& hits) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  put_column(bytes, hits, [](const physics::RayHit& hit) { return hit.object.value_or(kNothing); });
  put_column(bytes, hits, [](const physics::RayHit& hit) { return hit.object ? hit.distance_m : kNone; });
  put_column(bytes, hits, [](const physics::RayHit& hit) { return hit.p_W; });
  put_column(bytes, hits, [](const physics::RayHit& hit) { return hit.normal_W; });
}

}  // namespace

client::Message observation_message(const Observed& observed, double step_s) {
  const MergedState& state = observed.state;
  client::Message message = state_message({state.generation, state.step, state.is_complete(), state.bodies}, step_s);
  std::string& bytes = message.body;
  put_ids(bytes, state.missing);
  put_contacts(bytes, state.contacts);
  put_joints(bytes, state.joints);
  json silent = json::array(), fans = json::array(), triggers = json::array();
  for (const core::RegionId region : state.silent) silent.push_back(core::value_of(region));
  for (const FanResult& fan : observed.fans) {
    fans.push_back({{"cast", fan.was_cast}, {"complete", fan.complete}, {"rays", fan.hits.size()}});
    put_hits(bytes, fan.hits);
  }
  for (const TriggerResult& trigger : observed.triggers) {
    triggers.push_back({{"complete", trigger.complete},
                        {"inside", trigger.inside.size()},
                        {"entered", trigger.entered.size()},
                        {"left", trigger.left.size()}});
    for (const auto* ids : {&trigger.inside, &trigger.entered, &trigger.left}) put_ids(bytes, *ids);
  }
  message.head["redo"] = state.redo;
  message.head["skipped"] = observed.skipped;
  message.head["missing"] = state.missing.size();
  message.head["contacts"] = state.contacts.size();
  message.head["joints"] = state.joints.size();
  message.head["silent"] = std::move(silent);
  message.head["fans"] = std::move(fans);
  message.head["triggers"] = std::move(triggers);
  return message;
}

}  // namespace aurasim::agent
