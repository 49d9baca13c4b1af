// Orders: clients' commands with a number and a state. Every node receives the same orders in the same sequence and
// executes each one in the state that it names, so a run with orders is as repeatable as one without.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"
#include "core/redo.h"
#include "core/region_map.h"
#include "core/scene.h"

namespace aurasim::core {

/// Bodies that clients add get ids from here on; ids of scenes are lower.
inline constexpr std::uint64_t kFirstClientBody = 1'000'000'000;

/// kDecomposition: each connected piece of the mesh is one convex part.
enum class MeshUse : std::uint8_t { kHull, kDecomposition, kTriangles };

/// A mesh, named by the hash of its content (core/mesh_hash.h). Every node has it.
struct MeshRef {
  std::uint64_t hash = 0;
  MeshUse use = MeshUse::kHull;

  bool operator==(const MeshRef&) const = default;
};

/// Appends a shape to the scene's. It can be used as soon as the order is received.
struct DefineShape {
  std::variant<Sphere, Box, Capsule, Cylinder, MeshRef> shape;
};
/// Appends a prototype to the scene's. It can be used as soon as the order is received.
struct DefinePrototype {
  std::uint32_t shape = 0;
  double mass_kg = 1;
};
/// Adds a body, which exists from the order's state on.
struct Spawn {
  BodyId id{};
  PrototypeId prototype{};
  Pose pose;
  Vec3 v_WB = Vec3::Zero();
  Vec3 w_WB = Vec3::Zero();
};
struct AddStatic {
  StaticId id{};
  std::uint32_t shape = 0;
  Pose pose;
};
struct RemoveBody {
  BodyId id{};
};
struct RemoveStatic {
  StaticId id{};
};
/// Moves a static evenly from its pose in the state before the order's to `to`, where it stays. It leaves a path of its
/// scene.
struct MoveStatic {
  StaticId id{};
  Pose from, to;
  Step states = 1;  ///< number of states until it is at `to`
};
/// Impulse on a body just before the order's state is computed. Wakes the body.
struct Impulse {
  BodyId id{};
  Vec3 J_W = Vec3::Zero();    ///< N s
  std::optional<Vec3> p_W{};  ///< point of attack; nothing: the centre of mass
};
struct SetVelocity {
  BodyId id{};
  Vec3 v_WB = Vec3::Zero();
  std::optional<Vec3> w_WB{};  ///< nothing: the spin stays
};

/// Once the order's state has been computed, all nodes take a new map and hand over every body to its new host before
/// they go on. `boxes` has one rectangle for each region.
struct Repartition {
  std::vector<Rectangle> boxes;
};
/// Once the order's state has been computed, the run starts anew with another scene.
struct ChangeScene {
  std::string name;
};

/// All nodes go back to their cuts of state `cut` and compute on from there. Each does so when it knows of the order,
/// has computed the order's state, and has checked its states up to the cut.
struct Redo {
  Step cut = 0;
  Step confirmed = 0;          ///< every node gives out what it has of states up to this one, and nothing of later ones
  bool is_for_static = false;  ///< also because a static was not where it was ordered to be
  std::vector<TogetherPair> pairs;  ///< all pairs that share a host from then on
};

/// In the order's state every node writes its part of the world into a file named `file`, with the number of its region
/// (src/cut/cut_file.h).
struct Save {
  std::string file;
};
/// Once the order's state has been computed, the run goes on from the saved world `file`, which every node finds in its
/// folder.
struct Load {
  std::string file;
};

using Action = std::variant<DefineShape, DefinePrototype, Spawn, AddStatic, RemoveBody, RemoveStatic, Impulse,
                            SetVelocity, Repartition, ChangeScene, Redo, Save, Load, MoveStatic>;

struct Order {
  std::uint64_t sequence = 0;  ///< 1, 2, ...: numbered by the lead
  std::uint64_t request = 0;   ///< request number of the client's command
  Step at_step = 0;            ///< the first state that shows the effect
  Action action;
};

/// The existing body that an action or a command is about; nothing if it is about none.
template <class... Kinds>
std::optional<BodyId> body_of(const std::variant<Kinds...>& what) {
  if (const auto* removal = std::get_if<RemoveBody>(&what)) return removal->id;
  if (const auto* impulse = std::get_if<Impulse>(&what)) return impulse->id;
  if (const auto* velocity = std::get_if<SetVelocity>(&what)) return velocity->id;
  return {};
}

/// Do all nodes stop for it and begin anew with another map, another scene or a saved world?
template <class... Kinds>
bool changes_the_run(const std::variant<Kinds...>& what) {
  return std::holds_alternative<Repartition>(what) || std::holds_alternative<ChangeScene>(what) ||
         std::holds_alternative<Load>(what);
}

}  // namespace aurasim::core
