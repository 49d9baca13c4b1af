// Commands: what clients ask for, before it is an order with a number and a state (core/order.h), and the replies.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/order.h"

namespace aurasim::core {

/// How many prototypes and statics clients may add. Messages may name one before its definition has been received, so
/// ids up to this many beyond the scene's are valid.
inline constexpr std::size_t kRoomForClients = 20'000;

using ClientShape = std::variant<Sphere, Box, Capsule, Cylinder, MeshRef>;

struct NewBody {
  std::string prototype;  ///< name of a prototype of the scene; empty: `shape` and `mass_kg` say what the body is
  std::optional<ClientShape> shape;  ///< for a new prototype
  double mass_kg = 1;                ///< of the new prototype
  Pose pose;
  Vec3 v_WB = Vec3::Zero();
  Vec3 w_WB = Vec3::Zero();
};
struct NewStatic {
  ClientShape shape;
  Pose pose;
};
/// Moves a static evenly from its present pose to `to`, where it stays.
struct SendStatic {
  StaticId id{};
  Pose to;
  double duration_s = 0;  ///< rounded up to at least one state
};
/// Sets how many simulated seconds pass per second. It takes effect at once and changes only clocks, so it is not an
/// order.
struct SetRate {
  double rate = 1;
};
/// Asks what the segment from one point to another hits first. Each region in `regions` replies for its own part of the
/// world; if none is named, all reply.
struct Ray {
  Vec3 from_W = Vec3::Zero();
  Vec3 to_W = Vec3::Zero();
  std::vector<RegionId> regions;
};

using Ask = std::variant<NewBody, NewStatic, RemoveBody, RemoveStatic, Impulse, SetVelocity, SetRate, Repartition,
                         ChangeScene, Ray, Save, Load, SendStatic>;

/// The mesh that a new body or static has for its shape; null: it has none.
template <class AnyAsk>
auto mesh_in(AnyAsk& ask) -> decltype(std::get_if<MeshRef>(&std::get_if<NewStatic>(&ask)->shape)) {
  if (auto* const body = std::get_if<NewBody>(&ask)) {
    return body->shape ? std::get_if<MeshRef>(&*body->shape) : nullptr;
  }
  auto* const fixed = std::get_if<NewStatic>(&ask);
  return fixed != nullptr ? std::get_if<MeshRef>(&fixed->shape) : nullptr;
}

struct Command {
  std::uint64_t request = 0;  ///< random number of the request; copies of the command carry the same
  Step at_step = 0;           ///< the earliest state of its effect; 0: as soon as possible
  Ask ask;
};

enum class Outcome : std::uint8_t {
  kAccepted,  ///< takes effect at `at_step`
  kDone,      ///< has taken effect
  kRefused,   ///< the text gives the reason
  kSeen,      ///< reply of one region: what a ray hit, or that its part of the world is saved
};

/// Text of a reply kAccepted to a Save while the run is paused: the present state is saved. The client then sends the
/// command again with this state, so that the other nodes save it, too.
inline constexpr const char* kSavedAsItStands = "as it stands";

struct CommandReply {
  RegionId source{};
  std::uint64_t request = 0;
  Outcome outcome = Outcome::kAccepted;
  Step at_step = 0;
  std::string text;
  std::optional<ObjectRef> object;  ///< the new body or static; what a ray has hit
  Vec3 p_W = Vec3::Zero();          ///< where a ray hit
  Vec3 normal_W = Vec3::Zero();
  double distance_m = 0;
};

}  // namespace aurasim::core
