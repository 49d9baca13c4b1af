// What a page can ask for (docs/viewer.md, "JSON from the page"), as plain values, and who does it. Everything in a
// Command has been checked: numbers are finite and in range, shapes are sound, rotations have length 1.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/region_map.h"
#include "core/scene.h"

namespace aurasim::overseer {

struct Pause {};
struct Resume {};
struct Reset {};
/// Only while paused: compute so many states.
struct StepOn {
  std::int64_t count = 1;
};
/// Simulated seconds per second.
struct SetRate {
  double value = 1;
};
/// The scene file of this name beside that of the run.
struct LoadScene {
  std::string name;
};
/// The nodes keep the world under this name, or go back to the one of this name.
struct SaveWorld {
  std::string name;
};
struct LoadWorld {
  std::string name;
};
/// To the newest earlier state that is kept.
struct StepBack {};
/// A new region map, one rectangle per node. That they tile the plane is for the sink to check.
struct SetRegions {
  std::vector<core::Rectangle> boxes;
};

/// A mesh that was sent to /api/shapes.
struct StoredShape {
  enum class As : std::uint8_t { kMesh, kHull, kDecomposition };
  std::uint64_t hash = 0;
  As as = As::kMesh;
};
using ShapeChoice = std::variant<core::Shape, StoredShape>;

/// A kind of body that the scene does not have.
struct NewKind {
  ShapeChoice shape;
  double mass_kg = 1;
};
struct Spawn {
  std::variant<std::string, NewKind> kind;  ///< name of a prototype, or a new kind
  core::Pose pose;
  core::Vec3 v_WB = core::Vec3::Zero();
  core::Vec3 w_WB = core::Vec3::Zero();
};
struct PlaceStatic {
  ShapeChoice shape;
  core::Pose pose;
};
struct Remove {
  std::variant<core::BodyId, core::StaticId> what;
};
struct Impulse {
  core::BodyId body{};
  core::Vec3 J_W = core::Vec3::Zero();  ///< N s
  std::optional<core::Vec3> p_W;        ///< point of attack; nothing: the centre of mass
};
/// Sent again and again while a body is dragged.
struct SetVelocity {
  core::BodyId body{};
  core::Vec3 v_WB = core::Vec3::Zero();
  std::optional<core::Vec3> w_WB;
};
/// What does a ray hit first? Changes nothing.
struct CastRay {
  core::Vec3 from = core::Vec3::Zero();
  core::Vec3 to = core::Vec3::Zero();
  std::vector<core::RegionId> regions;  ///< that are to answer; none: all
};

using Command = std::variant<Pause, Resume, Reset, StepOn, SetRate, LoadScene, SetRegions, Spawn, PlaceStatic, Remove,
                             Impulse, SetVelocity, CastRay, SaveWorld, LoadWorld, StepBack>;

/// The word for it on the wire: "pause", "spawn", ...
const char* name_of(const Command& command);
/// Whether it takes an operator's token, where there is one.
bool changes_the_world(const Command& command);

/// One connection of one page; never given out again.
enum class ClientId : std::uint64_t {};

struct Request {
  ClientId client{};
  std::string id;  ///< made up by the page, comes back in the reply
  Command command;
};

struct Reply {
  ClientId client{};
  std::string request;
  bool ok = false;
  std::string text;       ///< why not, or what was done
  nlohmann::json result;  ///< null, or an object
};

/// Does what pages ask for. Used by one thread, which also serves: nothing in here may block it.
class CommandSink {
 public:
  CommandSink() = default;
  virtual ~CommandSink() = default;
  CommandSink(const CommandSink&) = delete;
  CommandSink& operator=(const CommandSink&) = delete;

  /// Begins it. Each request is answered by exactly one reply, at once or later, in any order.
  virtual void submit(Request request) = 0;
  /// Goes on with what has begun; called often. The replies that are ready.
  virtual std::vector<Reply> take_replies() = 0;
};

}  // namespace aurasim::overseer
