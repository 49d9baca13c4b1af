// Other scene files as parts of a scene: posed, each under a name of its own.
//
// What such a file gives and needs is read as if it stood alone, except that its name, gravity and ids say nothing.
// `NAME/` is put before the name of everything in it. Its bodies get their ids after those of the file that includes
// it, its joints and injectors come after that one's.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/scene_draft.h"

namespace aurasim::config {

inline constexpr std::size_t kMostIncludes = 1000;

const KeyTable& include_keys();

/// Which files are being read, each included by the one before; and how many have been, in all.
struct IncludeChain {
  std::vector<std::filesystem::path> files;
  std::size_t included = 0;
};

/// One file that a scene includes.
struct Included {
  std::string name;
  core::Pose X_WI;  ///< of its world in that of the scene
  Field blame;      ///< the entry
  SceneDraft draft;
  /// In the scene, once they are there.
  std::size_t first_material = 0, first_shape = 0, first_prototype = 0, first_body = 0;
};

/// Reads a scene file, up to the numbers of its bodies and joints.
using DraftReader = std::function<SceneDraft(const std::filesystem::path& file, IncludeChain& chain)>;

/// What `include` names. A file that includes itself, also by others, is refused, and so is a model of another format.
std::vector<Included> read_includes(const Field& field, const SceneDraft& scene, IncludeChain& chain,
                                    const DraftReader& read);

/// Before the scene's own: materials, shapes and prototypes, which it may use.
void take_over_kinds(std::vector<Included>& includes, SceneDraft& draft);
/// After the scene's own: statics and bodies, which its joints may bind.
void take_over_bodies(std::vector<Included>& includes, SceneDraft& draft);
/// After the scene's own.
void take_over_joints(std::vector<Included>& includes, SceneDraft& draft);
/// After the scene's own, when all bodies have their ids.
void take_over_injectors(std::vector<Included>& includes, SceneDraft& draft);

}  // namespace aurasim::config
