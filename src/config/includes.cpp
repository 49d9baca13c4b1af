#include "config/includes.h"

#include <algorithm>
#include <array>
#include <unordered_set>

#include <fmt/format.h>

#include "config/injectors.h"

namespace aurasim::config {
namespace {

namespace fs = std::filesystem;
using core::Pose;

constexpr std::size_t kDeepest = 16;
constexpr std::size_t kMostFiles = 10'000;  ///< most files in all, each counted as often as it is included
constexpr std::array kOtherFormats = {".urdf", ".sdf", ".world", ".xml", ".mjcf"};

std::string name_in(const Included& included, const std::string& name) { return included.name + "/" + name; }

/// True when the file may be included; otherwise adds an error with the reason.
bool may_be_included(const fs::path& file, const Field& field, const IncludeChain& chain) {
  if (std::ranges::find(kOtherFormats, file.extension()) != kOtherFormats.end()) {
    field.complain(
        fmt::format("found a model of another format, allowed: a scene file; `aurasim import {} --out {}` "
                    "makes one",
                    file.filename().string(), file.stem().string() + ".yaml"));
    return false;
  }
  if (const auto first = std::ranges::find(chain.files, file); first != chain.files.end()) {
    std::string circle;
    for (auto at = first; at != chain.files.end(); ++at) circle += at->filename().string() + " includes ";
    field.complain(fmt::format("found a circle: {}{}, allowed: files that do not include themselves", circle,
                               file.filename().string()));
    return false;
  }
  if (chain.files.size() >= kDeepest) {
    field.complain(fmt::format("found files included {} deep, allowed: {}", chain.files.size() + 1, kDeepest));
    return false;
  }
  if (chain.included >= kMostFiles) {
    field.complain(fmt::format("found more than {} files, allowed: as many in the whole scene", kMostFiles));
    return false;
  }
  return true;
}

/// Path of the file that `name` names, in the form that all parts of the reader use.
fs::path file_of(const std::string& name, const SceneDraft& scene) {
  return fs::absolute(scene.folder / name).lexically_normal();
}

void read_include(const Field& item, const SceneDraft& scene, IncludeChain& chain, const DraftReader& read,
                  std::vector<Included>& includes) {
  const Fields fields(item);
  const Field file_field = fields["file"], name_field = fields["name"];
  const auto file = file_field.text();
  const auto name = name_field.text();
  Pose X_WI;
  if (const Field at = fields["at"]; at.given()) {
    const Fields place(at);
    X_WI = read_pose(place);
    place.close();
  }
  fields.close();
  if (!file || !name) return;
  if (std::ranges::find(includes, *name, &Included::name) != includes.end()) {
    return name_field.complain(
        fmt::format("found the name {} a second time, allowed: each name once", in_quotes(*name)));
  }
  const fs::path path = file_of(*file, scene);
  if (!may_be_included(path, file_field, chain)) return;
  ++chain.included;
  chain.files.push_back(path);
  includes.push_back(Included{.name = *name, .X_WI = X_WI, .blame = item, .draft = read(path, chain)});
  chain.files.pop_back();
}

/// Appends the included things. Returns the index of the first.
template <class Thing>
std::size_t take_over(const std::vector<Thing>& from, const Included& included, std::vector<Thing>& to, Names& names) {
  const std::size_t first = to.size();
  for (Thing thing : from) {
    thing.name = name_in(included, thing.name);
    names.add(thing.name);
    to.push_back(std::move(thing));
  }
  return first;
}

template <class Thing>
void shift(Thing& thing, const Included& included) {
  thing.shape += static_cast<std::uint32_t>(included.first_shape);
  thing.material += static_cast<std::uint32_t>(included.first_material);
}

/// Shifts the materials of a shape's parts to their indices in the scene.
void shift_materials(core::Shape& shape, const Included& included) {
  auto* const compound = std::get_if<core::Compound>(&shape);
  if (compound == nullptr) return;
  for (core::CompoundPart& part : compound->parts) {
    if (part.material) *part.material += static_cast<std::uint32_t>(included.first_material);
  }
}

core::PrototypeId shifted(core::PrototypeId prototype, const Included& included) {
  return core::PrototypeId{value_of(prototype) + static_cast<std::uint32_t>(included.first_prototype)};
}

void take_over_statics(const Included& included, std::unordered_set<std::string>& names, SceneDraft& draft) {
  for (core::StaticBody body : included.draft.scene.statics) {
    body.name = name_in(included, body.name);
    body.pose = included.X_WI * body.pose;
    shift(body, included);
    if (!names.insert(body.name).second) {
      included.blame.complain(
          fmt::format("found the name {} a second time, allowed: each name once", in_quotes(body.name)));
    }
    draft.scene.statics.push_back(std::move(body));
  }
}

void take_over_moving(const Included& included, SceneDraft& draft) {
  std::optional<core::Vec3> too_far_W;
  for (DraftBody body : included.draft.bodies) {
    body.id = std::nullopt;
    body.body.prototype = shifted(body.body.prototype, included);
    body.body.pose = included.X_WI * body.body.pose;
    body.body.v_WB = included.X_WI.q_WB * body.body.v_WB;
    body.body.w_WB = included.X_WI.q_WB * body.body.w_WB;
    const std::string name = body.source.name.empty() ? "" : name_in(included, body.source.name);
    body.source = source_of(included.blame, name);
    if (!name.empty()) draft.name_next_body(name, included.blame);
    if (!too_far_W && !is_within_reach(body.body.pose.p_WB)) too_far_W = body.body.pose.p_WB;
    draft.bodies.push_back(std::move(body));
  }
  if (too_far_W) complain_of_place(included.blame, "a body", *too_far_W);
}

}  // namespace

const KeyTable& include_keys() {
  static const KeyTable keys{
      .title = "include",
      .about =
          "Another scene file as a part of this one, as often as you like. `NAME/` comes before all names in it: "
          "this file's joints may bind `NAME/body`, its bodies may be of prototype `NAME/prototype`. Its name, "
          "gravity and ids say nothing.",
      .keys = {required("file", text("another scene file"), "relative to this file; so are its own paths to it"),
               required("name", text("a name"), "of this copy; each once"),
               optional("at", map(pose_keys), "where its origin is").otherwise("at this file's")}};
  return keys;
}

std::vector<Included> read_includes(const Field& field, const SceneDraft& scene, IncludeChain& chain,
                                    const DraftReader& read) {
  std::vector<Included> includes;
  if (!field.given()) return includes;
  for (const Field& item : field.items()) read_include(item, scene, chain, read, includes);
  return includes;
}

void take_over_kinds(std::vector<Included>& includes, SceneDraft& draft) {
  for (Included& included : includes) {
    core::Scene& from = included.draft.scene;
    included.first_material = take_over(from.materials, included, draft.scene.materials, draft.materials);
    for (core::NamedShape& shape : from.shapes) shift_materials(shape.shape, included);
    included.first_shape = take_over(from.shapes, included, draft.scene.shapes, draft.shapes);
    for (core::Prototype& prototype : from.prototypes) shift(prototype, included);
    included.first_prototype = take_over(from.prototypes, included, draft.scene.prototypes, draft.prototypes);
  }
}

void take_over_bodies(std::vector<Included>& includes, SceneDraft& draft) {
  std::unordered_set<std::string> names;
  if (!includes.empty()) {
    for (const core::StaticBody& body : draft.scene.statics) names.insert(body.name);
  }
  for (Included& included : includes) {
    included.first_body = draft.bodies.size();
    take_over_statics(included, names, draft);
    if (draft.has_room_for(included.draft.bodies.size(), included.blame)) take_over_moving(included, draft);
  }
}

void take_over_joints(std::vector<Included>& includes, SceneDraft& draft) {
  for (Included& included : includes) {
    const std::size_t first = included.first_body;
    const auto first_joint = static_cast<std::uint32_t>(draft.joints.size());
    for (DraftJoint joint : included.draft.joints) {
      joint.joint.name = name_in(included, joint.joint.name);
      joint.joint.X_WJ = included.X_WI * joint.joint.X_WJ;
      if (auto coupling = core::coupling_of(joint.joint.kind)) {
        coupling->leader = core::JointId{first_joint + core::value_of(coupling->leader)};
        core::couple(joint.joint.kind, *coupling);
      }
      joint.a += first;
      if (joint.b) *joint.b += first;
      if (joint.a < draft.bodies.size()) draft.joints.push_back(std::move(joint));
    }
  }
}

void take_over_injectors(std::vector<Included>& includes, SceneDraft& draft) {
  for (Included& included : includes) {
    const Pose& X_WI = included.X_WI;
    if (!included.draft.scene.injectors.empty() && !X_WI.q_WB.vec().isZero(0)) {
      included.blame.complain("found an injector in what is turned, allowed: injectors in what is only moved");
    }
    for (core::Injector injector : included.draft.scene.injectors) {
      if (!draft.has_room_for(injector.max_bodies, included.blame)) return;
      injector.name = name_in(included, injector.name);
      injector.volume_min += X_WI.p_WB;
      injector.volume_max += X_WI.p_WB;
      for (core::PrototypeId& prototype : injector.prototypes) prototype = shifted(prototype, included);
      add_injector(std::move(injector), included.blame, draft);
    }
  }
}

}  // namespace aurasim::config
