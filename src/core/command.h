// What clients ask for, before it has a place in time (core/order.h), and what is replied.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/order.h"

namespace aurasim::core {

/// Prototypes and statics that clients may add: what names them can be received before they are.
inline constexpr std::size_t kRoomForClients = 20'000;

using ClientShape = std::variant<Sphere, Box, Capsule, Cylinder, MeshRef>;

struct NewBody {
  std::string prototype;             ///< name of one of the scene's, or empty:
  std::optional<ClientShape> shape;  ///< a kind of its own
  double mass_kg = 1;                ///< of that
  Pose pose;
  Vec3 v_WB = Vec3::Zero();
  Vec3 w_WB = Vec3::Zero();
};
struct NewStatic {
  ClientShape shape;
  Pose pose;
};
/// A static goes evenly from where it is, and stays there.
struct SendStatic {
  StaticId id{};
  Pose to;
  double duration_s = 0;  ///< at least one state
};
/// At once, this many simulated seconds per second: of the clocks, so it is not an order.
struct SetRate {
  double rate = 1;
};
/// What does the way from one point to another hit first? Each region that is named answers for itself; none named:
/// all answer.
struct Ray {
  Vec3 from_W = Vec3::Zero();
  Vec3 to_W = Vec3::Zero();
  std::vector<RegionId> regions;
};

using Ask = std::variant<NewBody, NewStatic, RemoveBody, RemoveStatic, Impulse, SetVelocity, SetRate, Repartition,
                         ChangeScene, Ray, Save, Load, SendStatic>;

struct Command {
  std::uint64_t request = 0;  ///< random; copies carry the same
  Step at_step = 0;           ///< not before this state; 0: as soon as possible
  Ask ask;
};

enum class Outcome : std::uint8_t {
  kAccepted,  ///< takes effect at `at_step`
  kDone,      ///< has taken effect
  kRefused,   ///< text says why
  kSeen,      ///< answer of one region: to a ray, or that its part of the world is saved
};

/// Text of a reply kAccepted to a Save of a run that stands: the state that is saved is the present one. Whoever has
/// asked tells that to the other nodes, by asking again with this state.
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
