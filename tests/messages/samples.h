// Messages with something in every field, and the comparison of any two, bit by bit.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/aura_precision.h"
#include "core/messages.h"

namespace aurasim::messages::testing {

inline core::Quat turn(double angle) {
  return core::Quat(Eigen::AngleAxisd(angle, core::Vec3(1, 2, -0.5).normalized()));
}

inline core::AuraRecord aura_of(std::uint64_t id) {
  core::AuraRecord aura;
  aura.id = static_cast<core::BodyId>(id);
  aura.epoch = static_cast<core::Epoch>(id + 1);
  aura.host = static_cast<core::RegionId>(id % 4);
  aura.prototype = static_cast<core::PrototypeId>(id % 7);
  aura.flags = static_cast<std::uint8_t>(id % 4);
  aura.stamp = static_cast<core::Step>(id) + 3;
  aura.birth = static_cast<core::Step>(2 * (id % 11));
  const auto x = static_cast<double>(id);
  aura.pose = {.p_WB = core::Vec3(0.1 * x, -x / 3, 1e-300), .q_WB = turn(x)};
  aura.v_WB = core::Vec3(1 / 3.0, -0.0, x);
  aura.w_WB = core::Vec3(-x, 5e-324, 2.5);
  aura.speed_m_s = 0.1 + x;
  aura.audience = id % 3 == 0 ? core::kAllListeners : std::uint64_t{1} << (id % 64);
  return aura;
}

/// Hashes of meshes use all 64 bits.
inline std::vector<core::Order> one_order_of_each_kind() {
  const core::Pose pose{core::Vec3(1.5, -2, 1e-9), turn(0.7)};
  const core::Vec3 v(0.1, -0.0, 3);
  const std::vector<core::Action> actions = {
      core::DefineShape{core::Sphere{0.3}},
      core::DefineShape{core::Box{{0.1, 0.2, 0.3}}},
      core::DefineShape{core::Capsule{0.2, 0.7}},
      core::DefineShape{core::Cylinder{0.4, 0.9}},
      core::DefineShape{core::MeshRef{0xffff'0000'1234'5678U, core::MeshUse::kTriangles}},
      core::DefinePrototype{5, 2.5},
      core::Spawn{core::BodyId{1'000'000'007}, core::PrototypeId{6}, pose, v, -v},
      core::AddStatic{core::StaticId{3}, 4, pose},
      core::RemoveBody{core::BodyId{12}},
      core::RemoveStatic{core::StaticId{2}},
      core::Impulse{core::BodyId{9}, v, {}},
      core::Impulse{core::BodyId{9}, v, pose.p_WB},
      core::SetVelocity{core::BodyId{8}, v, {}},
      core::SetVelocity{core::BodyId{8}, v, -v},
      core::Repartition{{{-1, -2, 0, 3}, {0, -2, 4, 3}}},
      core::ChangeScene{"tower"},
      core::Save{"world.cut"},
      core::Load{"world.cut"},
      core::MoveStatic{core::StaticId{7}, pose, {-pose.p_WB, turn(1.1)}, 90},
      core::Redo{30, 35, true, {{core::BodyId{3}, core::BodyId{1'000'000'007}, 47}}}};
  std::vector<core::Order> orders;
  for (const core::Action& action : actions) {
    orders.push_back({orders.size() + 1, 0xabcd'0000'0000'0000U + orders.size(), 1000, action});
  }
  return orders;
}

inline core::AuraBatch batch_of(std::size_t auras, core::RegionId source = core::RegionId{1}) {
  core::AuraBatch batch;
  batch.source = source;
  batch.generation = 7;
  batch.stamp = 1'234'567'890'123;
  batch.map_version = 0xfedc'ba98'7654'3210U;
  batch.full = true;
  batch.top_speed_m_s = 31.4;
  batch.top_radius_m = 0.87;
  batch.violations = 5;
  for (std::size_t i = 0; i < auras; ++i) {
    batch.updates.push_back(aura_of(i));
  }
  batch.deletes = {core::BodyId{90}, core::BodyId{91}};
  batch.hand_offs = {{core::RegionId{0}, 17}, {core::RegionId{2}, 0}};
  batch.adopted = {{core::RegionId{1}, 5}, {core::RegionId{3}, std::uint64_t{1} << 40U}};
  batch.orders = one_order_of_each_kind();
  batch.redo = 3;
  batch.alarms = {{2, 400, core::BodyId{5}, core::BodyId{1'000'000'001}}};
  batch.introductions = {{core::RegionId{0}, core::RegionId{3}}};
  return batch;
}

inline core::BodyRecord body_of(std::uint64_t id) {
  core::BodyRecord body;
  body.id = static_cast<core::BodyId>(id);
  body.epoch = 3;
  body.prototype = static_cast<core::PrototypeId>(id % 7);
  body.birth = 2;
  body.activation_state = static_cast<std::int32_t>(1 + id % 5);
  body.deactivation_time = 0.1 * static_cast<double>(id);
  body.p_WB = core::Vec3(1.1, 2.2, static_cast<double>(id));
  body.R_WB = turn(static_cast<double>(id)).toRotationMatrix();
  body.v_WB = core::Vec3(-1, 0.5, 1e-20);
  body.w_WB = core::Vec3(3, -2, 0.1);
  body.block = {-1, static_cast<std::int32_t>(id % 2)};
  return body;
}

/// `bodies` in a row, each with two contact points to the next and one to a static; one joint.
inline core::HandOff hand_off_of(std::size_t bodies, core::RegionId source = core::RegionId{1},
                                 core::RegionId destination = core::RegionId{0}) {
  core::HandOff hand_off;
  hand_off.source = source;
  hand_off.destination = destination;
  hand_off.generation = 7;
  hand_off.stamp = 99;
  hand_off.map_version = 0xfedc'ba98'7654'3210U;
  hand_off.sequence = 12;
  hand_off.reason = core::HandOffReason::kBoundaryTraversal;
  core::ClusterState& cluster = hand_off.cluster;
  const auto add_manifold = [&](core::ObjectRef a, core::ObjectRef b, std::uint32_t points) {
    const auto first = static_cast<std::uint32_t>(cluster.points.size() / core::kContactPointDoubles);
    cluster.manifolds.push_back({.object0 = a, .object1 = b, .first_point = first, .point_count = points});
    for (std::size_t i = 0; i < points * core::kContactPointDoubles; ++i) {
      cluster.points.push_back(1.0 / static_cast<double>(i + 1));
    }
  };
  for (std::size_t i = 0; i < bodies; ++i) {
    cluster.bodies.push_back(body_of(10 * i));
    add_manifold(core::ref_of(core::BodyId{10 * i}), core::ref_of(core::StaticId{2}), 1);
    if (i > 0) {
      add_manifold(core::ref_of(core::BodyId{10 * (i - 1)}), core::ref_of(core::BodyId{10 * i}), 2);
    }
  }
  cluster.joints.push_back({.id = core::JointId{5}, .first_value = 0, .value_count = 3});
  cluster.joint_values = {0.1, 0.2, 0.3};
  return hand_off;
}

// ---- equality to the bit: -0.0 is not 0.0

inline bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

template <class Matrix>
bool same_bits(const Matrix& a, const Matrix& b) {
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (!same(a.data()[i], b.data()[i])) {
      return false;
    }
  }
  return true;
}

inline bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return same(x, y); });
}

template <class Row, class Same>
bool same_rows(const std::vector<Row>& a, const std::vector<Row>& b, Same same_row) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), same_row);
}

/// As near as single precision is.
inline bool same_as_float(const core::Vec3& a, const core::Vec3& b) {
  return ((a - b).cwiseAbs().array() <= 1e-7 * b.cwiseAbs().array() + 1e-30).all();
}

/// But for what the wire takes from places, rotations and speeds (core/aura_precision.h).
inline bool same(const core::AuraRecord& a, const core::AuraRecord& b) {
  const auto birth_of = [](const core::AuraRecord& r) { return r.birth > r.stamp ? r.birth : 0; };
  const core::Vec3 off = a.pose.p_WB - b.pose.p_WB;
  const double speed_off = std::abs(a.speed_m_s - b.speed_m_s);
  return a.id == b.id && a.epoch == b.epoch && a.host == b.host && a.prototype == b.prototype && a.flags == b.flags &&
         a.stamp == b.stamp && birth_of(a) == birth_of(b) && off.cwiseAbs().maxCoeff() <= core::kPositionGrain_m / 2 &&
         a.pose.q_WB.angularDistance(b.pose.q_WB) <= core::kRotationError_rad && same_as_float(a.v_WB, b.v_WB) &&
         same_as_float(a.w_WB, b.w_WB) && speed_off <= 2e-7 * a.speed_m_s && a.audience == b.audience;
}

inline bool same_mark(const core::HandOffMark& a, const core::HandOffMark& b) {
  return a.region == b.region && a.last_sequence == b.last_sequence;
}

inline bool same(const core::AuraBatch& a, const core::AuraBatch& b) {
  return a.source == b.source && a.generation == b.generation && a.stamp == b.stamp && a.map_version == b.map_version &&
         a.full == b.full && same(a.top_speed_m_s, b.top_speed_m_s) && same(a.top_radius_m, b.top_radius_m) &&
         a.violations == b.violations &&
         same_rows(a.updates, b.updates, [](const auto& x, const auto& y) { return same(x, y); }) &&
         a.deletes == b.deletes && same_rows(a.hand_offs, b.hand_offs, same_mark) &&
         same_rows(a.adopted, b.adopted, same_mark);
}

inline bool same(const core::BodyRecord& a, const core::BodyRecord& b) {
  return a.id == b.id && a.epoch == b.epoch && a.prototype == b.prototype && a.birth == b.birth &&
         a.activation_state == b.activation_state && same(a.deactivation_time, b.deactivation_time) &&
         same_bits(a.p_WB, b.p_WB) && same_bits(a.R_WB, b.R_WB) && same_bits(a.v_WB, b.v_WB) &&
         same_bits(a.w_WB, b.w_WB) && a.block == b.block;
}

inline bool same(const core::HandOff& a, const core::HandOff& b) {
  return a.source == b.source && a.destination == b.destination && a.generation == b.generation && a.stamp == b.stamp &&
         a.map_version == b.map_version && a.sequence == b.sequence && a.reason == b.reason &&
         same_rows(a.cluster.bodies, b.cluster.bodies, [](const auto& x, const auto& y) { return same(x, y); }) &&
         same_rows(a.cluster.manifolds, b.cluster.manifolds,
                   [](const auto& x, const auto& y) {
                     return x.object0 == y.object0 && x.object1 == y.object1 && x.first_point == y.first_point &&
                            x.point_count == y.point_count;
                   }) &&
         same(a.cluster.points, b.cluster.points) &&
         same_rows(a.cluster.joints, b.cluster.joints,
                   [](const auto& x, const auto& y) {
                     return x.id == y.id && x.first_value == y.first_value && x.value_count == y.value_count;
                   }) &&
         same(a.cluster.joint_values, b.cluster.joint_values);
}

}  // namespace aurasim::messages::testing
