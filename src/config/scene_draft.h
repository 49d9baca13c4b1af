// A scene while it is being read: state that the parts of the reader share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "config/fields.h"
#include "config/launch.h"
#include "config/region_layout.h"
#include "core/scene.h"

namespace aurasim::config {

/// Most bodies of state 0 and of all injectors together.
inline constexpr std::uint64_t kMostBodies = 1'000'000;
/// Largest body id. Bullet's broadphase ids are ints, and the last ones are reserved for Bullet.
inline constexpr std::int64_t kLargestBodyId = (std::int64_t{1} << 31) - 1001;

/// Names of one kind of thing, in the order of the file, and their indices.
class Names {
 public:
  explicit Names(std::string_view kind) : kind_(kind) {}

  std::uint32_t add(const std::string& name);
  std::optional<std::uint32_t> index_of(const std::string& name) const;
  /// Returns the index of the name in `field`; complains if there is none.
  std::optional<std::uint32_t> find(const Field& field) const;

 private:
  std::string kind_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::uint32_t> index_;
};

/// A body of state 0 that may not have its id yet.
struct DraftBody {
  std::optional<core::BodyId> id;
  core::InitialBody body;
  SceneSource source;
};

/// A joint whose bodies may not have their ids yet: places in SceneDraft::bodies.
struct DraftJoint {
  core::JointSpec joint;
  std::size_t a = 0;
  std::optional<std::size_t> b;
};

struct SceneDraft {
  core::Scene scene;
  std::vector<SceneSource> body_sources;      ///< as scene.bodies
  std::vector<SceneSource> injector_sources;  ///< as scene.injectors
  std::filesystem::path folder;               ///< mesh files are relative to it
  Names shapes{"shape"};
  Names materials{"material"};
  Names prototypes{"prototype"};
  std::vector<DraftBody> bodies;
  Names body_names{"named body"};
  std::vector<std::size_t> named_bodies;  ///< places in `bodies`, in the order of body_names
  std::vector<DraftJoint> joints;
  std::uint64_t injected_bodies = 0;
  /// Layout for injectors with `per`; nothing: the scene has none, or an invalid one.
  std::optional<RegionLayout> layout;
  bool layout_is_wrong = false;

  /// Names the body that is added next; complains about a name that is taken.
  void name_next_body(const std::string& name, const Field& blame);

  /// Returns whether `count` more bodies may be added; complains if not.
  bool has_room_for(std::uint64_t count, const Field& blame) const;
};

/// Returns the place of `field`, for messages about the thing that it describes.
SceneSource source_of(const Field& field, std::string name);

/// Keys of the pose of a thing.
const KeyTable& pose_keys();
const KeyTable& orientation_keys();

/// Reads `position` and `orientation` of a map that shares pose_keys.
core::Pose read_pose(const Fields& fields);

/// True when a place is within core::limits::kFarthestPlace_m. Each coordinate in a file is, but their sums may not be.
bool is_within_reach(const core::Vec3& p_W);
/// Adds the error for a place that is out of reach: "found ... at ..., allowed: ...".
void complain_of_place(const Field& blame, std::string_view what, const core::Vec3& p_W);

/// Reads `orientation` alone.
core::Quat read_orientation(const Field& field);

/// Range of one component of a velocity, m/s and rad/s.
inline constexpr Range kSpeed = Range::from_to(-1e4, 1e4);

/// Keys `shape:` (a name or a shape in place), `material:` (a name), and a thing's own name.
Key shape_key(std::string_view meaning);
Key material_key();
Key own_name_key(std::string_view meaning, std::string otherwise);

/// Reads `shape:` of a prototype, a static or a part: a name, or a shape in place, which gets the name `own_name`.
/// Returns the shape's index.
std::optional<std::uint32_t> read_shape_reference(const Field& field, const std::string& own_name, SceneDraft& draft);

/// Reads `material:`; the material "default" if it is not given.
std::optional<std::uint32_t> read_material_reference(const Field& field, SceneDraft& draft);

}  // namespace aurasim::config
