#include "config/scene_file.h"

#include "config/bodies.h"
#include "config/generators.h"
#include "config/injectors.h"
#include "config/joints.h"
#include "config/launch.h"

namespace aurasim::config {
namespace {

constexpr Range kGravity = Range::from_to(-1000, 1000);

void read_scene_layout(const Field& field, const LaunchLayout& launch, SceneDraft& draft) {
  if (!field.given()) return;
  if (field.is_word("launch")) {
    draft.layout = launch.layout;
    draft.layout_is_wrong = !launch.layout;
    if (!launch.is_known) field.refuse("a layout of its own, where there is no launch file");
    return;
  }
  if (!field.is_map()) {
    field.refuse("launch, or a map such as {layout: columns, count: 2, width: 80}");
  } else {
    Fields fields(field);
    draft.layout = read_layout(fields);
    fields.close();
  }
  draft.layout_is_wrong = !draft.layout;
}

core::Scene read_scene_map(const YamlNode& root, const std::filesystem::path& file, const LaunchLayout& launch,
                           Errors& errors) {
  SceneDraft draft;
  draft.folder = file.parent_path();
  draft.scene.name = file.stem().string();
  Fields fields(Field(&root, root.place, "", true, errors));
  if (const Field name = fields.optional("name"); name.given()) {
    draft.scene.name = name.text("a name").value_or(draft.scene.name);
  }
  if (const Field gravity = fields.optional("gravity"); gravity.given()) {
    draft.scene.gravity = gravity.vec3(kGravity).value_or(draft.scene.gravity);
  }
  read_scene_layout(fields.optional("layout"), launch, draft);
  read_materials(fields.optional("materials"), draft);
  read_shapes(fields.optional("shapes"), draft);
  read_prototypes(fields.optional("prototypes"), draft);
  read_statics(fields.optional("statics"), draft);
  read_bodies(fields.optional("bodies"), draft);
  read_generators(fields.optional("generators"), draft);
  read_joints(fields.optional("joints"), draft);
  number_bodies(draft);
  number_joints(draft);
  read_injectors(fields.optional("injectors"), draft);
  fields.close();
  return std::move(draft.scene);
}

}  // namespace

core::Scene read_scene_file(const std::filesystem::path& file, const std::vector<Override>& overrides,
                            const LaunchLayout& launch, Errors& errors) {
  std::optional<YamlNode> root = read_yaml(file, errors);
  if (!root) return {};
  for (const Override& change : overrides) apply_override(change, *root, errors);
  if (YamlNode* layout = root->find("layout")) settle_overridden_layout(*layout);
  return read_scene_map(*root, file, launch, errors);
}

core::Scene read_scene(const std::filesystem::path& file) {
  Errors errors;
  core::Scene scene = read_scene_file(std::filesystem::absolute(file).lexically_normal(), {}, {}, errors);
  errors.throw_if_any();
  return scene;
}

}  // namespace aurasim::config
