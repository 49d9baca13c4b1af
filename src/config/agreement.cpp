// Launch::agreement(): a 64-bit hash over everything that decides what is computed. Paths, places in files, the
// DDS domain and how the run is watched are left out.
#include <bit>
#include <string_view>

#include "config/launch.h"
#include "core/fnv1a.h"

namespace aurasim::config {
namespace {

/// A hash of a canonical byte string: every value with its length or kind, so that no two lists run together.
class Digest {
 public:
  void bytes(std::uint64_t value) { hash_.add_word(value); }
  void add(double value) { bytes(std::bit_cast<std::uint64_t>(value + 0.0)); }
  void add(std::string_view text) {
    bytes(text.size());
    hash_.add_text(text);
  }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& values) {
    for (int i = 0; i < values.size(); ++i) add(values(i));
  }
  void add(const core::Pose& pose) {
    add(pose.p_WB);
    add(pose.q_WB.coeffs());
  }
  void add(const std::vector<core::Vec3>& points) {
    bytes(points.size());
    for (const core::Vec3& p : points) add(p);
  }

  std::uint64_t result() const { return hash_.value(); }

 private:
  core::Fnv1a hash_;
};

class ShapeDigest {
 public:
  explicit ShapeDigest(Digest& digest) : d_(digest) {}

  void operator()(const core::Sphere& s) const { d_.add(s.radius); }
  void operator()(const core::Box& s) const { d_.add(s.half_extents); }
  void operator()(const core::Capsule& s) const {
    d_.add(s.radius);
    d_.add(s.height);
  }
  void operator()(const core::Cylinder& s) const {
    d_.add(s.radius);
    d_.add(s.height);
  }
  void operator()(const core::ConvexHull& s) const { d_.add(s.points); }
  void operator()(const core::TriangleMesh& s) const {
    d_.add(s.points);
    d_.bytes(s.triangles.size());
    for (const auto& t : s.triangles) {
      for (const std::uint32_t index : t) d_.bytes(index);
    }
  }
  void operator()(const core::Plane& s) const {
    d_.add(s.normal);
    d_.add(s.offset);
  }
  void operator()(const core::Compound& s) const {
    d_.bytes(s.parts.size());
    for (const core::CompoundPart& part : s.parts) {
      d_.bytes(part.shape.index());
      std::visit(*this, part.shape);
      d_.add(part.pose);
      d_.bytes(part.material ? *part.material + std::uint64_t{1} : 0);
    }
  }

 private:
  Digest& d_;
};

void add_things(const core::Scene& scene, Digest& d) {
  d.bytes(scene.shapes.size());
  for (const core::NamedShape& shape : scene.shapes) {
    d.add(shape.name);
    d.bytes(shape.shape.index());
    std::visit(ShapeDigest(d), shape.shape);
  }
  d.bytes(scene.materials.size());
  for (const core::Material& m : scene.materials) {
    d.add(m.name);
    for (const double value :
         {m.friction, m.rolling_friction, m.spinning_friction, m.restitution, m.linear_damping, m.angular_damping}) {
      d.add(value);
    }
  }
  d.bytes(scene.prototypes.size());
  for (const core::Prototype& p : scene.prototypes) {
    d.add(p.name);
    d.bytes(p.shape);
    d.bytes(p.material);
    d.add(p.mass_kg);
    d.bytes(p.can_sleep);
    d.bytes(p.inertia.has_value());
    if (p.inertia) d.add(*p.inertia);
    d.bytes(p.collides);
  }
}

void add_bodies(const core::Scene& scene, Digest& d) {
  d.bytes(scene.statics.size());
  for (const core::StaticBody& s : scene.statics) {
    d.add(s.name);
    d.bytes(s.shape);
    d.bytes(s.material);
    d.add(s.pose);
    d.add(s.belt_S);
    d.bytes(s.path ? s.path->stops.size() : 0);
    if (!s.path) continue;
    d.bytes(s.path->repeats);
    d.bytes(s.path->smooth);
    for (const core::PathStop& stop : s.path->stops) d.add(stop.at_s), d.add(stop.X_SP);
  }
  d.bytes(scene.bodies.size());
  for (const core::InitialBody& b : scene.bodies) {
    d.bytes(value_of(b.id));
    d.bytes(value_of(b.prototype));
    d.add(b.pose);
    d.add(b.v_WB);
    d.add(b.w_WB);
  }
  d.bytes(scene.injectors.size());
  for (const core::Injector& i : scene.injectors) {
    d.add(i.name);
    for (const std::uint64_t value : {i.seed, value_of(i.first_id), i.max_bodies}) d.bytes(value);
    d.add(i.rate_per_s);
    d.add(i.start_s);
    for (const core::Vec3& v : {i.volume_min, i.volume_max, i.velocity_min, i.velocity_max}) d.add(v);
    d.bytes(i.random_orientation);
    d.bytes(i.prototypes.size());
    for (const core::PrototypeId id : i.prototypes) d.bytes(value_of(id));
  }
}

class JointDigest {
 public:
  explicit JointDigest(Digest& digest) : d_(digest) {}

  void operator()(const core::BallJoint& joint) const { d_.add(joint.damping); }
  void operator()(const core::FixedJoint&) const {}
  void operator()(const core::HingeJoint& joint) const {
    add_own(joint);
    d_.bytes(joint.motor.has_value());
    if (!joint.motor) return;
    d_.add(joint.motor->speed);
    d_.add(joint.motor->max_impulse);
  }
  void operator()(const core::SliderJoint& joint) const { add_own(joint); }
  void operator()(const core::SpringJoint& joint) const {
    for (const core::SpringAxis& axis : joint.axes) {
      add(axis.limits);
      d_.add(axis.stiffness);
      d_.add(axis.damping);
      d_.add(axis.rest);
    }
  }

 private:
  template <class Joint>
  void add_own(const Joint& joint) const {
    add(joint.limits);
    const core::JointResistance& own = joint.resistance;
    for (const double value : {own.stiffness, own.rest, own.damping, own.friction}) d_.add(value);
    d_.bytes(joint.drive.has_value());
    for (const double value : joint.drive.value_or(core::JointDrive{}).numbers()) d_.add(value);
    d_.bytes(joint.follows.has_value());
    if (!joint.follows) return;
    d_.bytes(value_of(joint.follows->leader));
    d_.add(joint.follows->ratio);
  }
  void add(const std::optional<core::JointLimits>& limits) const {
    d_.bytes(limits.has_value());
    if (!limits) return;
    d_.add(limits->low);
    d_.add(limits->high);
  }

  Digest& d_;
};

void add_joints(const core::Scene& scene, Digest& d) {
  d.bytes(scene.joints.size());
  for (const core::JointSpec& joint : scene.joints) {
    d.add(joint.name);
    d.bytes(joint.kind.index());
    std::visit(JointDigest(d), joint.kind);
    d.bytes(value_of(joint.a));
    d.bytes(joint.b.has_value());
    if (joint.b) d.bytes(value_of(*joint.b));
    d.add(joint.X_WJ);
    d.bytes(joint.collide);
    d.add(joint.break_impulse);
  }
}

/// Adds everything that decides about the bits of states, on any region map.
void add_physics(const Launch& launch, Digest& d) {
  d.add(launch.time.step_hz);
  d.bytes(static_cast<std::uint64_t>(launch.time.substeps));
  d.add(launch.tolerances.speed_m_s);
  d.add(std::string_view(launch.physics.solver));
  d.bytes(static_cast<std::uint64_t>(launch.physics.iterations));
  d.bytes(static_cast<std::uint64_t>(launch.physics.friction_directions));
  d.add(launch.physics.contact_erp);
  d.bytes(launch.physics.is_continuous());
  d.add(launch.block_m());
}

/// Adds the other settings that all nodes must agree on.
void add_settings(const Launch& launch, Digest& d) {
  d.bytes(launch.regions.version());
  d.add(launch.neighbour_distance_m);
  d.bytes(static_cast<std::uint64_t>(launch.time.sync));
  d.bytes(static_cast<std::uint64_t>(launch.time.pace));
  d.bytes(launch.redoes());
  d.bytes(static_cast<std::uint64_t>(launch.exchange));
  if (launch.exchange == Exchange::kAuto) d.add(launch.exchange_limit_s());
  d.bytes(static_cast<std::uint64_t>(launch.lookahead()));
  d.add(launch.tolerances.latency_s);
  d.add(launch.tolerances.frame_s);
  d.bytes(static_cast<std::uint64_t>(launch.aura.radius));
  d.add(launch.uncertainty());
  d.bytes(static_cast<std::uint64_t>(launch.survival.on_death));
  d.bytes(static_cast<std::uint64_t>(launch.checkpoint_steps()));
  const core::ControlRules control = launch.control_rules();
  d.bytes(static_cast<std::uint64_t>(control.late));
  d.bytes(static_cast<std::uint64_t>(control.on_silence));
  d.bytes(static_cast<std::uint64_t>(control.silence));
  d.bytes(launch.control.replay_content);
  for (const std::string& name : launch.ros2.cmd_vel) d.add(std::string_view(name));
}

void add_world(const Launch& launch, Digest& d) {
  d.add(std::string_view(launch.scene.name));
  d.add(launch.scene.gravity);
  add_things(launch.scene, d);
  add_bodies(launch.scene, d);
  add_joints(launch.scene, d);
  add_physics(launch, d);
}

}  // namespace

std::uint64_t Launch::agreement() const {
  Digest d;
  add_world(*this, d);
  add_settings(*this, d);
  return d.result();
}

std::uint64_t Launch::world_identity() const {
  Digest d;
  add_world(*this, d);
  return d.result();
}

}  // namespace aurasim::config
