#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "config/launch.h"
#include "config/shipped_files.h"
#include "lab/case.h"
#include "lab/pair.h"
#include "lab/speed/speed_scene.h"
#include "lab/stability/scene_builder.h"

namespace aurasim::lab {
namespace {

using core::Quat;
using core::Vec3;

constexpr std::uint64_t kSeed = 17;

core::Scene shipped_scene(const char* name) {
  return config::read_scene(config::shipped_folder() / "launch_configs" / "scenes" / name);
}

Vec3 in_cube(Chance& chance, double half_m) {
  const double x = chance.between(-half_m, half_m), y = chance.between(-half_m, half_m);
  return {x, y, chance.between(-half_m, half_m)};
}

/// Shoemake, Uniform Random Rotations (1992).
Quat shoemake_rotation(Chance& chance) {
  const double u = chance.between(0, 1), a = chance.between(0, 2 * M_PI), b = chance.between(0, 2 * M_PI);
  return {std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a),
          std::sqrt(u) * std::sin(b)};
}

SpeedScene speed_scene_of(const std::string& name, core::Step steps, const core::Scene& scene) {
  SpeedScene all;
  all.name = name;
  all.steps = steps;
  all.states_every = steps / 4;
  all.scene = scene;
  return all;
}

/// All bodies are there from state 0 on.
SpeedScene born_at_once(SpeedScene all) {
  all.births.assign(all.scene.bodies.size(), 0);
  return all;
}

std::vector<core::BodyRecord> injected_before(const core::Scene& scene, core::Step step, double step_s) {
  std::vector<core::BodyRecord> bodies;
  for (const core::Injector& injector : scene.injectors) {
    for (std::uint64_t i = 0;; ++i) {
      const auto body = core::injected_body(injector, i, step_s);
      if (!body || body->birth >= step) break;
      bodies.push_back(*body);
    }
  }
  std::stable_sort(bodies.begin(), bodies.end(), [](const auto& a, const auto& b) { return a.birth < b.birth; });
  return bodies;
}

/// The thesis rain, 60 s of it; the last 12 of its 9,600 bodies would come after them. They may sleep.
SpeedScene rain(bool quick) {
  SpeedScene all = speed_scene_of("rain", quick ? 240 : 3600, shipped_scene("columns_rain.yaml"));
  for (const core::BodyRecord& body : injected_before(all.scene, all.steps, 1.0 / all.step_hz)) {
    all.births.push_back(body.birth);
    all.scene.bodies.push_back(
        {core::BodyId{all.scene.bodies.size()}, body.prototype, {body.p_WB, Quat(body.R_WB)}, body.v_WB, body.w_WB});
  }
  all.scene.injectors.clear();
  return all;
}

/// Cubes of 1 m side by side, each row on the one below.
SpeedScene boxes_in_rows(bool quick) {
  const int rows = quick ? 10 : 100;
  SceneBuilder stage("pyramid");
  stage.material(0.6).ground();
  const core::PrototypeId cube = stage.kind(core::Box{}, 1);
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < rows - row; ++i) stage.body(cube, {{i - 0.5 * (rows - row - 1), 0, row + 0.5}});
  }
  return born_at_once(speed_scene_of("pyramid", quick ? 120 : 300, stage.scene()));
}

/// Piles of four cubes that come to rest: of the last 5 s every engine should spend next to nothing.
SpeedScene sleepers(bool quick) {
  const int across = quick ? 5 : 50, high = 4;
  SceneBuilder stage("sleepers");
  stage.material(0.6).ground();
  const core::PrototypeId cube = stage.kind(core::Box{}, 1);
  for (int i = 0; i < across * across * high; ++i) {
    stage.body(cube, {{1.5 * (i % across), 1.5 * (i / across % across), i / (across * across) + 0.5}});
  }
  SpeedScene all = speed_scene_of("sleepers", quick ? 240 : 720, stage.scene());
  all.scene.prototypes.front().can_sleep = true;
  return born_at_once(std::move(all));
}

/// Three points of one octant in all eight: the centre of mass is the origin, and the principal axes are those of the
/// body, for every engine.
core::ConvexHull symmetric_hull(Chance& dice) {
  core::ConvexHull hull;
  const double longest[] = {0.2, 0.3, 0.4};
  for (int corner = 0; corner < 3; ++corner) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = axis == corner ? longest[axis] : longest[axis] * dice.between(0.3, 0.8);
    }
    for (int octant = 0; octant < 8; ++octant) {
      hull.points.emplace_back((octant & 1 ? -1 : 1) * p.x(), (octant & 2 ? -1 : 1) * p.y(),
                               (octant & 4 ? -1 : 1) * p.z());
    }
  }
  return hull;
}

/// A column of hulls that falls into a heap.
SpeedScene heap_of_hulls(bool quick) {
  constexpr int kKinds = 8;
  const int count = quick ? 50 : 2000, across = quick ? 5 : 10;
  SceneBuilder stage("hulls");
  stage.material(0.5).ground();
  Chance dice(kSeed);
  std::vector<core::PrototypeId> kinds;
  for (int i = 0; i < kKinds; ++i) kinds.push_back(stage.kind(symmetric_hull(dice), 1));
  for (int i = 0; i < count; ++i) {
    const Vec3 p_W(i % across - 0.5 * (across - 1), i / across % across - 0.5 * (across - 1),
                   0.6 + i / (across * across));
    const Quat q_WB = shoemake_rotation(dice);
    stage.body(kinds[static_cast<std::size_t>(i % kKinds)], {p_W + in_cube(dice, 0.05), q_WB});
  }
  return born_at_once(speed_scene_of("hulls", quick ? 160 : 600, stage.scene()));
}

/// The stairs of the shipped scene, wide enough for `lanes` m and with a longer landing.
void widen_stairs(core::Scene& scene, int lanes, int in_a_lane) {
  constexpr double kEdge_m = -4.5, kApart_m = 1.6;
  for (std::size_t i = 0; i < scene.statics.size(); ++i) {
    core::StaticBody part = scene.statics[i];
    auto* box = std::get_if<core::Box>(&scene.shapes[part.shape].shape);
    if (!box) continue;
    box->half_extents.y() = 0.5 * lanes + 2;
    if (part.name != "landing") continue;
    box->half_extents.x() = 0.5 * (kApart_m * in_a_lane + 1);
    part.pose.p_WB.x() = kEdge_m - box->half_extents.x();
    scene.statics.set(i, part);
  }
}

/// Removes damping and the springs of the hips, because engines define them differently.
void leave_out_what_differs(core::Scene& scene) {
  for (core::Material& material : scene.materials) material.linear_damping = material.angular_damping = 0;
  for (core::Prototype& prototype : scene.prototypes) prototype.can_sleep = false;
  for (core::JointSpec& joint : scene.joints) {
    if (!std::holds_alternative<core::SpringJoint>(joint.kind)) continue;
    joint.kind = core::BallJoint{};
  }
}

/// The first ragdoll of the shipped scene, `lanes` beside each other and several in a row.
SpeedScene ragdolls_on_stairs(bool quick) {
  constexpr std::size_t kBodies = 11, kJoints = 10;
  const int lanes = quick ? 4 : 40, in_a_lane = quick ? 2 : 10;
  SpeedScene all = speed_scene_of("ragdolls", quick ? 120 : 600, shipped_scene("ragdoll_stairs.yaml"));
  leave_out_what_differs(all.scene);
  widen_stairs(all.scene, lanes, in_a_lane);
  const std::vector<core::InitialBody> bodies(all.scene.bodies.begin(), all.scene.bodies.begin() + kBodies);
  const std::vector<core::JointSpec> joints(all.scene.joints.begin(), all.scene.joints.begin() + kJoints);
  all.scene.bodies.clear();
  all.scene.joints.clear();
  for (int i = 0; i < lanes * in_a_lane; ++i) {
    const Vec3 shift(-1.6 * (i / lanes), i % lanes - 0.5 * (lanes - 1), 0);
    const core::BodyId first{all.scene.bodies.size()};
    const auto renumbered = [&](core::BodyId id) {
      return core::BodyId{core::value_of(first) + core::value_of(id) - core::value_of(bodies.front().id)};
    };
    for (core::InitialBody body : bodies) {
      body.id = renumbered(body.id);
      body.pose.p_WB += shift;
      body.v_WB.x() = 3.5 + 0.1 * (7 * i % 20);
      all.scene.bodies.push_back(body);
    }
    for (core::JointSpec joint : joints) {
      joint.a = renumbered(joint.a);
      joint.b = renumbered(*joint.b);
      joint.X_WJ.p_WB += shift;
      all.scene.joints.push_back(joint);
    }
  }
  return born_at_once(std::move(all));
}

/// Card houses as in the stability experiment.
SpeedScene many_card_houses(bool quick) {
  const int count = quick ? 2 : 40, in_a_row = 8;
  SpeedScene all = speed_scene_of("card_houses", quick ? 120 : 600, stability_case("card_house").scene);
  all.fallen_m = 0.2;
  const std::vector<core::InitialBody> cards = std::exchange(all.scene.bodies, {});
  for (int i = 0; i < count; ++i) {
    for (core::InitialBody card : cards) {
      card.id = core::BodyId{all.scene.bodies.size()};
      card.pose.p_WB += Vec3(4.0 * (i / in_a_row), 1.5 * (i % in_a_row), 0);
      all.scene.bodies.push_back(card);
    }
  }
  return born_at_once(std::move(all));
}

/// Elastic balls without friction or weight in a closed box.
SpeedScene gas_in_a_box(bool quick) {
  const int across = quick ? 6 : 40;
  constexpr double kRadius = 0.25, kApart = 1, kSpeed = 5, kWall = 5;
  SceneBuilder stage("gas", Vec3::Zero());
  stage.material(0, 1);
  const double half = 0.5 * kApart * across;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 half_extents = Vec3::Constant(half + 2 * kWall), p_W = Vec3::Zero();
    half_extents[axis] = kWall;
    p_W[axis] = half + kWall;
    stage.fixed(core::Box{half_extents}, {p_W, Quat::Identity()});
    stage.fixed(core::Box{half_extents}, {-p_W, Quat::Identity()});
  }
  const core::PrototypeId ball = stage.kind(core::Sphere{kRadius}, 1);
  Chance dice(kSeed);
  for (int i = 0; i < across * across * across; ++i) {
    const Vec3 cell(i % across, i / across % across, i / (across * across));
    const Vec3 p_W = kApart * (cell + Vec3::Constant(0.5)) - Vec3::Constant(half);
    const Vec3 v_W = in_cube(dice, kSpeed);
    stage.body(ball, {p_W + in_cube(dice, 0.2)}, v_W);
  }
  return born_at_once(speed_scene_of("gas", quick ? 120 : 300, stage.scene()));
}

using SceneMaker = SpeedScene (*)(bool quick);
constexpr std::pair<const char*, SceneMaker> kMakers[] = {
    {"rain", rain},
    {"pyramid", boxes_in_rows},
    {"hulls", heap_of_hulls},
    {"ragdolls", ragdolls_on_stairs},
    {"card_houses", many_card_houses},
    {"gas", gas_in_a_box},
    {"sleepers", sleepers},
};

}  // namespace

const std::vector<std::string>& speed_scene_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, make] : kMakers) all.emplace_back(name);
    return all;
  }();
  return names;
}

SpeedScene speed_scene(const std::string& name, SceneSize size) {
  for (const auto& [known, make] : kMakers) {
    if (name == known) return make(size == SceneSize::kQuick);
  }
  throw std::invalid_argument("there is no scene \"" + name + "\"");
}

}  // namespace aurasim::lab
