// The asks: what clients can request of a run. Every client (`aurasim send`, the viewer's page, the client library)
// sends an ask as the same JSON object, {"kind": "impulse", "body": 3, "J": [0, 0, 20]}. asks() declares all kinds and
// fields once: readers, refusals, command-line options, help and docs/commands.md all come from that table.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/command.h"
#include "messages/control_messages.h"

namespace aurasim::steering {

/// Steers the whole run: pause, resume, step, reset or stop.
struct Steer {
  messages::RunCommandKind kind = messages::RunCommandKind::kPause;
  std::int64_t count = 1;  ///< states of a step
};
/// Makes the node of a region leave, so that another process takes the region over.
struct Drain {
  core::RegionId region{};
};

/// One ask, with everything checked that can be checked without the run.
struct Ask {
  std::variant<Steer, Drain, core::Ask> what;
  core::Step at_step = 0;  ///< the earliest state of its effect; 0: as soon as possible
  /// File of this host whose mesh is the shape in `what`. The hash there is 0 until the mesh has been read.
  std::string mesh_file;
  /// Name of the static in `what`, whose id is 0 until look_up_static(). Empty: the ask gave the id.
  std::string static_name;
};

/// An ask or a field of it is wrong. what() names the field, what was found, and what is allowed.
class BadAsk : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class Form : std::uint8_t {
  kNumber,
  kWhole,     ///< a whole number, from 0 on
  kVector,    ///< three numbers, each in the range
  kLength,    ///< three numbers: a vector whose length is in the range
  kRotation,  ///< a quaternion w x y z of any length but 0
  kText,      ///< `low` to `high` bytes
  kFileName,  ///< of a scene file beside the launch file
  kSaveName,  ///< of a saved world
  kStatic,    ///< a static's name or number
  kBoxes,     ///< one box x0 y0 x1 y1 for each region; null: infinite
  kShape,     ///< one of shapes()
  kHash,      ///< of a mesh, 16 hexadecimal digits
  kMeshUse,   ///< hull or decomposition
};

struct Field {
  std::string_view name;  ///< in JSON, and of the option of `aurasim send`
  Form form = Form::kNumber;
  std::string_view help = {};
  std::string_view unit = {};
  double low = 0;
  double high = 0;
  std::string_view absent = {};     ///< what holds without the field; empty: the field is required
  std::string_view run_limit = {};  ///< a lower limit, which depends on the run and which nodes check
  bool is_argument = false;         ///< `aurasim send` takes it as an argument without a name
};

struct AskKind {
  std::string_view name;
  std::string_view help;
  std::string_view example;  ///< options that follow `aurasim send KIND FILE`
  std::vector<Field> fields = {};
  /// Names of two fields, of which exactly one has to be given; `of_second` goes with the second of them only.
  std::string_view first = {}, second = {}, of_second = {};
};

struct ShapeKind {
  std::string_view name;
  std::string_view help;
  std::vector<Field> fields;
};

/// All kinds of asks, in the order in which they are shown.
std::span<const AskKind> asks();
/// The kinds of shapes that new bodies and statics can have.
std::span<const ShapeKind> shapes();
/// The field `at`, which every ask can have.
const Field& at_field();
/// The declared field. Precondition: it exists. For a shape's field: `kind` is the shape's.
const Field& field_of(std::string_view kind, std::string_view name);

/// Meshes by the name of a file are for clients that read files for their own user. A page would read the server's.
enum class MeshFiles : std::uint8_t { kRefused, kAllowed };

/// Reads an ask. Throws BadAsk, and nothing else, whatever the JSON is.
Ask read_ask(const nlohmann::json& json, MeshFiles files);

/// Replaces the static's name by its id. Throws BadAsk if `scene` has no static of this name or number.
void look_up_static(Ask& ask, const core::Scene& scene);

/// Fault of an ask of any client, in the words of read_ask(); empty: none that can be found without the run. Nodes
/// check the asks that come over the wire with it.
std::string problem_with(const core::Ask& ask);
/// Fault of a shape of a new body or static; empty: none.
std::string problem_with_shape(const core::Shape& shape, bool is_body);

/// True for asks that change the world or its course. Only rays do not.
bool changes_the_world(const Ask& ask);

}  // namespace aurasim::steering
