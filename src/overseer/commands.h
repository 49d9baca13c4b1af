// Commands of pages (docs/viewer.md, "JSON from the page") as plain values, and the interface that executes them.
// Everything in a Command has been checked: numbers are finite and in range, shapes are sound, rotations have length 1.
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
/// Computes so many states. Only while the run is paused.
struct StepOn {
  std::int64_t count = 1;
};
/// Sets the rate: simulated seconds per second.
struct SetRate {
  double value = 1;
};
/// Changes to the scene file of this name beside that of the run.
struct LoadScene {
  std::string name;
};
/// Makes the nodes save the world under this name, or go back to the world of this name.
struct SaveWorld {
  std::string name;
};
struct LoadWorld {
  std::string name;
};
/// Goes back to the newest earlier kept state.
struct StepBack {};
/// Sets a new region map, one rectangle per node. The sink checks that they tile the plane.
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
/// Asks what a ray hits first. Changes nothing.
struct CastRay {
  core::Vec3 from = core::Vec3::Zero();
  core::Vec3 to = core::Vec3::Zero();
  std::vector<core::RegionId> regions;  ///< regions that are to answer; empty: all
};

using Command = std::variant<Pause, Resume, Reset, StepOn, SetRate, LoadScene, SetRegions, Spawn, PlaceStatic, Remove,
                             Impulse, SetVelocity, CastRay, SaveWorld, LoadWorld, StepBack>;

/// Name of a command on the wire: "pause", "spawn", ...
const char* name_of(const Command& command);
/// True when the command needs an operator's token, if the server has one.
bool changes_the_world(const Command& command);

/// Identifies one connection of one page. Never reused.
enum class ClientId : std::uint64_t {};

struct Request {
  ClientId client{};
  std::string id;  ///< chosen by the page; returned in the reply
  Command command;
};

struct Reply {
  ClientId client{};
  std::string request;
  bool ok = false;
  std::string text;       ///< reason for a refusal, or description of what was done
  nlohmann::json result;  ///< null, or an object
};

/// Executes the commands of pages. Used by one thread, which also serves pages: nothing in here may block it.
class CommandSink {
 public:
  CommandSink() = default;
  virtual ~CommandSink() = default;
  CommandSink(const CommandSink&) = delete;
  CommandSink& operator=(const CommandSink&) = delete;

  /// Begins to execute a request. Each request gets exactly one reply, at once or later, in any order.
  virtual void submit(Request request) = 0;
  /// Continues the requests that have begun, and returns the replies that are ready. Called often.
  virtual std::vector<Reply> take_replies() = 0;
};

}  // namespace aurasim::overseer
