// box3d with its defaults, 4 substeps. It knows no planes: the ground is the top of a large box.
#include <map>

#include <box3d/box3d.h>

#include "driver.h"

namespace {

using peers::ShapeKind;

constexpr int kSubsteps = 4;

b3Vec3 vector(const peers::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
b3Quat quaternion(const peers::Quat& q) { return {vector({q.x, q.y, q.z}), static_cast<float>(q.w)}; }
peers::Vec3 vector(const b3Vec3& v) { return {v.x, v.y, v.z}; }

float product(float a, std::uint64_t, float b, std::uint64_t) { return a * b; }

class World {
 public:
  World(const peers::Scene& scene, int threads) : scene_(scene) {
    b3WorldDef definition = b3DefaultWorldDef();
    definition.gravity = vector(scene.gravity);
    definition.enableSleep = scene.sleeping;
    definition.workerCount = static_cast<std::uint32_t>(threads);
    definition.frictionCallback = product;
    definition.restitutionCallback = product;
    definition.restitutionThreshold = 0;
    world_ = b3CreateWorld(&definition);
    for (const peers::Static& s : scene.statics) add_static(s);
  }

  ~World() {
    b3DestroyWorld(world_);
    for (const auto& [shape, hull] : hulls_) b3DestroyHull(hull);
  }

  void add(const peers::Body& b) {
    const peers::Kind& kind = scene_.kinds[b.kind];
    b3BodyDef definition = b3DefaultBodyDef();
    definition.type = b3_dynamicBody;
    definition.position = vector(b.p);
    definition.rotation = quaternion(b.q);
    definition.linearVelocity = vector(b.v);
    definition.angularVelocity = vector(b.w);
    const b3BodyId body = b3CreateBody(world_, &definition);
    b3ShapeDef shape = shape_of(kind.material);
    shape.density = 1;
    const b3ShapeId made = put_on(body, shape, kind.shape);
    b3Shape_SetDensity(made, static_cast<float>(kind.mass) / b3Body_GetMass(body), true);
    bodies_.push_back(body);
  }

  void join() {
    for (const peers::Joint& joint : scene_.joints) {
      if (joint.is_hinge) {
        b3RevoluteJointDef hinge = b3DefaultRevoluteJointDef();
        bind(hinge.base, joint);
        hinge.enableLimit = true;
        hinge.lowerAngle = static_cast<float>(joint.low);
        hinge.upperAngle = static_cast<float>(joint.high);
        b3CreateRevoluteJoint(world_, &hinge);
      } else {
        b3SphericalJointDef ball = b3DefaultSphericalJointDef();
        bind(ball.base, joint);
        b3CreateSphericalJoint(world_, &ball);
      }
    }
  }

  void step() { b3World_Step(world_, static_cast<float>(scene_.step_s), kSubsteps); }

  peers::State state(std::size_t index) const {
    const b3BodyId body = bodies_[index];
    const b3Quat q = b3Body_GetRotation(body);
    return {vector(b3Body_GetPosition(body)),
            {q.s, q.v.x, q.v.y, q.v.z},
            vector(b3Body_GetLinearVelocity(body)),
            vector(b3Body_GetAngularVelocity(body))};
  }

 private:
  b3ShapeDef shape_of(std::size_t material) const {
    b3ShapeDef shape = b3DefaultShapeDef();
    shape.baseMaterial.friction = static_cast<float>(scene_.materials[material].friction);
    shape.baseMaterial.restitution = static_cast<float>(scene_.materials[material].restitution);
    return shape;
  }

  void add_static(const peers::Static& s) {
    constexpr double kWide = 2000, kDeep = 10;
    const peers::Shape& geometry = scene_.shapes[s.shape];
    b3BodyDef definition = b3DefaultBodyDef();
    definition.position = vector(s.p);
    definition.rotation = quaternion(s.q);
    const bool is_plane = geometry.kind == ShapeKind::kPlane;
    if (is_plane) {
      if (geometry.normal.z != 1) throw std::runtime_error("a plane that is not level");
      definition.position.z += static_cast<float>(geometry.offset - kDeep);
    }
    const b3BodyId body = b3CreateBody(world_, &definition);
    const b3ShapeDef shape = shape_of(s.material);
    if (is_plane) {
      const b3BoxHull ground = b3MakeBoxHull(kWide, kWide, kDeep);
      b3CreateHullShape(body, &shape, &ground.base);
    } else {
      put_on(body, shape, s.shape);
    }
  }

  b3ShapeId put_on(b3BodyId body, const b3ShapeDef& shape, std::size_t index) {
    const peers::Shape& s = scene_.shapes[index];
    const auto radius = static_cast<float>(s.radius), half = static_cast<float>(s.height / 2);
    if (s.kind == ShapeKind::kSphere) {
      const b3Sphere sphere = {{0, 0, 0}, radius};
      return b3CreateSphereShape(body, &shape, &sphere);
    }
    if (s.kind == ShapeKind::kCapsule) {
      const b3Capsule capsule = {{0, 0, -half}, {0, 0, half}, radius};
      return b3CreateCapsuleShape(body, &shape, &capsule);
    }
    if (s.kind == ShapeKind::kBox) {
      const b3Vec3 h = vector(s.half_extents);
      const b3BoxHull box = b3MakeBoxHull(h.x, h.y, h.z);
      return b3CreateHullShape(body, &shape, &box.base);
    }
    return b3CreateHullShape(body, &shape, hull_of(index));
  }

  const b3HullData* hull_of(std::size_t index) {
    b3HullData*& hull = hulls_[index];
    if (!hull) {
      std::vector<b3Vec3> points;
      for (const peers::Vec3& point : scene_.shapes[index].points) points.push_back(vector(point));
      const int count = static_cast<int>(points.size());
      hull = b3CreateHull(points.data(), count, count);
      if (!hull) throw std::runtime_error("box3d makes no hull of these points");
    }
    return hull;
  }

  /// Its angles are those of its second body relative to its first.
  void bind(b3JointDef& base, const peers::Joint& joint) const {
    base.bodyIdA = bodies_[joint.b];
    base.bodyIdB = bodies_[joint.a];
    base.localFrameA = frame_in(joint.b, joint);
    base.localFrameB = frame_in(joint.a, joint);
  }

  b3Transform frame_in(std::size_t index, const peers::Joint& joint) const {
    const b3Transform X_WB = {vector(scene_.bodies[index].p), quaternion(scene_.bodies[index].q)};
    return b3InvMulTransforms(X_WB, {vector(joint.p), quaternion(joint.q)});
  }

  const peers::Scene& scene_;
  b3WorldId world_{};
  std::vector<b3BodyId> bodies_;
  std::map<std::size_t, b3HullData*> hulls_;
};

}  // namespace

int main(int argc, char** argv) { return peers::drive<World>(argc, argv, "box3d", "single"); }
