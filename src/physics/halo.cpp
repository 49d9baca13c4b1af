#include "physics/halo.h"

#include <utility>

namespace aurasim::physics {
namespace {

constexpr std::size_t kLeastRecord = 8 + 4 + 4 + 8 + 4 + 19 * 8 + 8;  // bytes

void write_vector(const core::Vec3& v, ParcelWriter& parcel) { parcel.put_some(v.data(), 3); }
core::Vec3 read_vector(ParcelReader& parcel) {
  core::Vec3 v;
  parcel.take_some(v.data(), 3);
  return v;
}

void write_body(const core::BodyRecord& body, ParcelWriter& parcel) {
  parcel.put(core::value_of(body.id));
  parcel.put(body.epoch);
  parcel.put(core::value_of(body.prototype));
  parcel.put(body.birth);
  parcel.put(body.activation_state);
  parcel.put(body.deactivation_time);
  write_vector(body.p_WB, parcel);
  parcel.put_some(body.R_WB.data(), 9);
  write_vector(body.v_WB, parcel);
  write_vector(body.w_WB, parcel);
  parcel.put(body.block.x);
  parcel.put(body.block.y);
}

core::BodyRecord read_body(ParcelReader& parcel) {
  core::BodyRecord body;
  body.id = core::BodyId{parcel.take<std::uint64_t>()};
  body.epoch = parcel.take<core::Epoch>();
  body.prototype = core::PrototypeId{parcel.take<std::uint32_t>()};
  body.birth = parcel.take<core::Step>();
  body.activation_state = parcel.take<std::int32_t>();
  body.deactivation_time = parcel.take<double>();
  body.p_WB = read_vector(parcel);
  parcel.take_some(body.R_WB.data(), 9);
  body.v_WB = read_vector(parcel);
  body.w_WB = read_vector(parcel);
  body.block.x = parcel.take<std::int32_t>();
  body.block.y = parcel.take<std::int32_t>();
  return body;
}

void write_push(const Visit& visit, ParcelWriter& parcel) {
  const bool pushed = !visit.force.isZero(0) || !visit.torque.isZero(0);
  parcel.put(static_cast<std::uint8_t>(pushed));
  if (!pushed) return;
  write_vector(visit.force, parcel);
  write_vector(visit.torque, parcel);
}

void read_push(Visit& visit, ParcelReader& parcel) {
  if (parcel.take<std::uint8_t>() == 0) return;
  visit.force = read_vector(parcel);
  visit.torque = read_vector(parcel);
}

void write_cluster(const core::ClusterState& cluster, ParcelWriter& parcel) {
  parcel.put(static_cast<std::uint32_t>(cluster.bodies.size()));
  for (const core::BodyRecord& body : cluster.bodies) write_body(body, parcel);
  parcel.put(static_cast<std::uint32_t>(cluster.manifolds.size()));
  for (const core::ManifoldRecord& manifold : cluster.manifolds) {
    parcel.put(manifold.object0), parcel.put(manifold.object1);
    parcel.put(manifold.first_point), parcel.put(manifold.point_count);
  }
  parcel.put_all(std::span<const double>(cluster.points));
  parcel.put(static_cast<std::uint32_t>(cluster.joints.size()));
  for (const core::JointRecord& joint : cluster.joints) {
    parcel.put(core::value_of(joint.id)), parcel.put(joint.first_value), parcel.put(joint.value_count);
  }
  parcel.put_all(std::span<const double>(cluster.joint_values));
}

core::ClusterState read_cluster(ParcelReader& parcel) {
  core::ClusterState cluster;
  cluster.bodies.resize(parcel.take_count(kLeastRecord));
  for (core::BodyRecord& body : cluster.bodies) body = read_body(parcel);
  cluster.manifolds.resize(parcel.take_count(24));
  for (core::ManifoldRecord& manifold : cluster.manifolds) {
    manifold.object0 = parcel.take<core::ObjectRef>(), manifold.object1 = parcel.take<core::ObjectRef>();
    manifold.first_point = parcel.take<std::uint32_t>(), manifold.point_count = parcel.take<std::uint32_t>();
  }
  cluster.points = parcel.take_all<double>();
  for (const core::ManifoldRecord& manifold : cluster.manifolds) {
    const std::size_t last = std::size_t{manifold.first_point} + manifold.point_count;
    if (last * core::kContactPointDoubles > cluster.points.size()) throw BadParcel("a contact has no points");
  }
  cluster.joints.resize(parcel.take_count(12));
  for (core::JointRecord& joint : cluster.joints) {
    joint.id = core::JointId{parcel.take<std::uint32_t>()};
    joint.first_value = parcel.take<std::uint32_t>(), joint.value_count = parcel.take<std::uint32_t>();
  }
  cluster.joint_values = parcel.take_all<double>();
  for (const core::JointRecord& joint : cluster.joints) {
    if (std::size_t{joint.first_value} + joint.value_count > cluster.joint_values.size()) {
      throw BadParcel("a joint has no values");
    }
  }
  return cluster;
}

}  // namespace

void write(const Halo& halo, ParcelWriter& parcel) {
  parcel.put(static_cast<std::uint32_t>(halo.broken.size()));
  for (const core::BodyId id : halo.broken) parcel.put(core::value_of(id));
  parcel.put(static_cast<std::uint32_t>(halo.guests.size()));
  for (const Visit& visit : halo.guests) {
    write_body(visit.body, parcel);
    parcel.put(core::value_of(visit.host));
    write_push(visit, parcel);
  }
  write_cluster(halo.for_you, parcel);
  for (const Visit& visit : halo.arrivals) write_push(visit, parcel);
}

Halo read_halo(ParcelReader& parcel) {
  Halo halo;
  halo.broken.resize(parcel.take_count(8));
  for (core::BodyId& id : halo.broken) id = core::BodyId{parcel.take<std::uint64_t>()};
  halo.guests.resize(parcel.take_count(kLeastRecord));
  for (Visit& visit : halo.guests) {
    visit.body = read_body(parcel);
    visit.host = core::RegionId{parcel.take<std::uint32_t>()};
    read_push(visit, parcel);
  }
  halo.for_you = read_cluster(parcel);
  halo.arrivals.resize(halo.for_you.bodies.size());
  for (Visit& visit : halo.arrivals) read_push(visit, parcel);
  if (!parcel.at_end()) throw BadParcel("a parcel between regions is too long");
  return halo;
}

}  // namespace aurasim::physics
