// The declaration of all asks. A new kind is added here and in the builders of ask_reader.cpp.
#include <algorithm>
#include <cassert>

#include "core/limits.h"
#include "steering/ask.h"

namespace aurasim::steering {
namespace {

using namespace core::limits;

constexpr double kEveryState = 9'007'199'254'740'992;  ///< 2^53: whole numbers up to it are exact in every JSON reader
constexpr double kMostRegions = 1024;
constexpr std::string_view kOrigin = "0 0 0";

constexpr Field place(std::string_view name, std::string_view help, std::string_view absent = {}) {
  return {name, Form::kVector, help, "m", -kFarthestPlace_m, kFarthestPlace_m, absent};
}
constexpr Field rotation() { return {"q", Form::kRotation, "rotation, quaternion w x y z", "", 0, 0, "1 0 0 0"}; }
constexpr Field velocity(std::string_view absent) {
  return {"v", Form::kLength, "velocity", "m/s", 0, kFastestBody_m_s, absent, "tolerances.speed of the run"};
}
constexpr Field spin(std::string_view absent) {
  return {"w",
          Form::kLength,
          "angular velocity",
          "rad/s",
          0,
          kFastestSpin_rad_s,
          absent,
          "a quarter turn in a substep of the run"};
}
constexpr Field body() { return {"body", Form::kWhole, "id of the body", "", 0, kEveryState}; }
constexpr Field fixed() { return {"static", Form::kStatic, "the static's name in the scene, or its id"}; }
constexpr Field shape() { return {"shape", Form::kShape, "a shape of its own, see below"}; }
constexpr Field saved_world() {
  return {"name", Form::kSaveName, "its name: of a file in the nodes' --saves folder", "", 1, 100, "", "", true};
}

const std::vector<AskKind>& table() {
  static const std::vector<AskKind> kAsks = {
      {"pause", "stand still", ""},
      {"resume", "go on", ""},
      {"step",
       "compute some states while paused",
       "--count 10",
       {{"count", Form::kWhole, "how many", "", 1, kMostStepsAhead, "1"}}},
      {"reset", "begin anew", ""},
      {"stop", "end the run", ""},
      {"spawn",
       "a new body",
       "--radius 0.5 --p 0 0 10 --v 5 0 0",
       {{"prototype", Form::kText, "name of a prototype of the scene", "", 1, 256},
        shape(),
        {"mass", Form::kNumber, "of a body with a shape; a prototype has its own", "kg", kLightest_kg, kHeaviest_kg,
         "1"},
        place("p", "position", kOrigin),
        rotation(),
        velocity(kOrigin),
        spin(kOrigin)},
       "prototype",
       "shape",
       "mass"},
      {"static",
       "a new static, on every node",
       "--size 4 4 1 --p 0 0 0.5",
       {shape(), place("p", "position", kOrigin), rotation()}},
      {"remove", "take a body or a static out", "--body 3", {body(), fixed()}, "body", "static"},
      {"move",
       "send a static somewhere: a gate, a lift",
       "--static gate --p 0 0 3 --seconds 2",
       {fixed(),
        place("p", "position", kOrigin),
        rotation(),
        {"seconds", Form::kNumber, "simulated time until it is there, at most that of 1,000,000 states", "s", 0,
         kMostStepsAhead, "0"}}},
      {"impulse",
       "push a body",
       "--body 3 --J 0 0 20",
       {body(),
        {"J", Form::kLength, "impulse", "N s", 0, kHardestImpulse_Ns},
        place("p", "point of attack", "the centre of mass")}},
      {"velocity", "set a body's velocity", "--body 3 --v 0 0 8", {body(), velocity(kOrigin), spin("the spin stays")}},
      {"rate",
       "slow motion and the like",
       "--value 0.5",
       {{"value", Form::kNumber, "simulated seconds per second", "", kSlowestRate, kFastestRate}}},
      {"scene",
       "begin anew with another scene",
       "--name tower",
       {{"name", Form::kFileName, "of its file, beside the launch file", "", 1, 100}}},
      {"regions",
       "give the nodes other regions",
       "--boxes -40 -40 0 0 0 -40 40 0 -40 0 0 40 0 0 40 40",
       {{"boxes", Form::kBoxes, "x0 y0 x1 y1 of each region", "m", 1, kMostRegions}}},
      {"drain",
       "let a region's node leave: another process takes the region over",
       "2",
       {{"region", Form::kWhole, "whose node", "", 0, 4'294'967'295.0, "", "", true}}},
      {"save", "keep the world in a file", "world.cut", {saved_world()}},
      {"load", "go on from a saved world", "state-1200.cut", {saved_world()}},
      {"back", "go back to the newest earlier state that is kept", ""},
      {"ray",
       "what is first on the way from a point to another?",
       "--from 0 0 20 --to 0 0 0",
       {place("from", "beginning"), place("to", "end")}},
  };
  return kAsks;
}

const std::vector<ShapeKind>& shape_table() {
  constexpr double kWidest_m = 2 * kLargestRadius_m;
  constexpr Field radius{"radius", Form::kNumber, "radius", "m", kThinnest_m / 2, kLargestRadius_m};
  static const std::vector<ShapeKind> kShapes = {
      {"sphere", "a ball", {radius}},
      {"box", "a box", {{"size", Form::kVector, "side lengths", "m", kThinnest_m, kWidest_m}}},
      {"capsule",
       "a capsule along z",
       {radius, {"height", Form::kNumber, "between the centres of its caps", "m", 0, kWidest_m}}},
      {"cylinder",
       "a cylinder along z",
       {radius, {"height", Form::kNumber, "from end to end", "m", kThinnest_m, kWidest_m}}},
      {"mesh",
       "a mesh by `file` or `hash`; a body takes its hull or its convex parts, a static its triangles",
       {{"file", Form::kText, "OBJ, STL or glTF file on the host of the client; not for pages", "", 1, 4096,
         "`hash` is given"},
        {"hash", Form::kHash, "of a mesh that was sent to the nodes: by /api/shapes of the viewer's server", "", 0, 0,
         "`file` is given"},
        {"as", Form::kMeshUse, "of a body: hull, or decomposition into convex parts", "", 0, 0, "hull"}}},
  };
  return kShapes;
}

}  // namespace

std::span<const AskKind> asks() { return table(); }
std::span<const ShapeKind> shapes() { return shape_table(); }

const Field& at_field() {
  static const Field kAt{"at", Form::kWhole, "not before this state", "", 0, kEveryState, "0"};
  return kAt;
}

const Field& field_of(std::string_view kind, std::string_view name) {
  const auto find = [&](const auto& kinds) -> const Field* {
    for (const auto& one : kinds) {
      if (one.name != kind) continue;
      const auto found = std::ranges::find(one.fields, name, &Field::name);
      return found == one.fields.end() ? nullptr : &*found;
    }
    return nullptr;
  };
  const Field* const of_ask = find(asks());
  const Field* const found = of_ask != nullptr ? of_ask : find(shapes());
  assert(found != nullptr);
  return *found;
}

bool changes_the_world(const Ask& ask) {
  const auto* const command = std::get_if<core::Ask>(&ask.what);
  return command == nullptr || !std::holds_alternative<core::Ray>(*command);
}

}  // namespace aurasim::steering
