// Other scene files as parts of a scene: posed, each under a name of its own.
//
// An included file is read as if it stood alone, except that its name, gravity and ids have no effect. `NAME/` is put
// before the name of everything in it. Its bodies get their ids after those of the file that includes it; its joints
// and injectors follow that file's.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/scene_draft.h"

namespace aurasim::config {

inline constexpr std::size_t kMostIncludes = 1000;

const KeyTable& include_keys();

/// The files that are being read, each included by the one before, and the number of all files read so far.
struct IncludeChain {
  std::vector<std::filesystem::path> files;
  std::size_t included = 0;
};

/// One file that a scene includes.
struct Included {
  std::string name;
  core::Pose X_WI;  ///< pose of its world in the scene's world
  Field blame;      ///< the entry of `include`, for messages
  SceneDraft draft;
  /// Indices in the scene, once its things have been taken over.
  std::size_t first_material = 0, first_shape = 0, first_prototype = 0, first_body = 0;
};

/// Reads a scene file, up to the numbers of its bodies and joints.
using DraftReader = std::function<SceneDraft(const std::filesystem::path& file, IncludeChain& chain)>;

/// Reads the files that `include` names. Refuses a file that includes itself, also through others, and a model of
/// another format.
std::vector<Included> read_includes(const Field& field, const SceneDraft& scene, IncludeChain& chain,
                                    const DraftReader& read);

/// Adds materials, shapes and prototypes to the scene. Called before the scene's own are read, which may use them.
void take_over_kinds(std::vector<Included>& includes, SceneDraft& draft);
/// Adds statics and bodies, after the scene's own. The scene's joints may bind them.
void take_over_bodies(std::vector<Included>& includes, SceneDraft& draft);
/// Adds joints, after the scene's own.
void take_over_joints(std::vector<Included>& includes, SceneDraft& draft);
/// Adds injectors, after the scene's own, when all bodies have their ids.
void take_over_injectors(std::vector<Included>& includes, SceneDraft& draft);

}  // namespace aurasim::config
