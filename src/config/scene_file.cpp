#include "config/scene_file.h"

#include "config/bodies.h"
#include "config/generators.h"
#include "config/includes.h"
#include "config/injectors.h"
#include "config/joints.h"
#include "config/keys_of.h"
#include "config/launch.h"
#include "config/shapes.h"

namespace aurasim::config {
namespace {

constexpr std::size_t kMostStatics = 100'000;
/// Keys of lists that grow with the world.
constexpr std::string_view kLongLists[] = {"statics", "bodies"};

const KeysOf<core::Scene>& scene_keys() {
  using core::Scene;
  static const KeysOf<Scene> keys(
      "scene file", "The contents of a world. Lengths are in metres, z is up; paths are relative to the file.",
      {
          optional("name", &Scene::name, text("a name"), "shown by the viewer and in reports")
              .otherwise("the file's, without its ending"),
          optional("gravity", &Scene::gravity, vec3("m/s^2", Range::from_to(-1000, 1000)),
                   "acceleration of all bodies"),
          optional("layout", layout_value().or_word("launch"),
                   "what injectors `per` region or boundary go by. launch: the regions of the launch file; a layout of "
                   "its own keeps the world the same on any number of nodes")
              .otherwise("none: `per` is refused"),
          optional("include", list(0, kMostIncludes, map(include_keys)), "other scene files as parts of this one"),
          optional("materials", named("a map of materials by name", map(material_keys)), "surfaces, by name"),
          optional("shapes", named("a map of shapes by name", map(shape_keys)), "shapes, by name"),
          optional("prototypes", named("a map of prototypes by name", map(prototype_keys)), "kinds of bodies, by name"),
          optional("statics", list(0, kMostStatics, map(static_keys).with(pose_keys)), "what nothing moves"),
          optional("bodies", list(0, kMostBodies, map(body_keys).with(pose_keys)), "what is there at the start"),
          optional("generators", list(0, kMostGenerators, map(generator_keys)), "bodies in regular formations"),
          optional("joints", list(0, kMostJoints, map(joint_keys)), "what holds bodies together"),
          optional("injectors", list(0, kMostInjectors, map(injector_keys)), "what throws bodies in, over time"),
      });
  return keys;
}

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
    draft.layout = read_layout(field);
  }
  draft.layout_is_wrong = !draft.layout;
}

/// Reads scene files, which may include each other.
class Reader {
 public:
  Reader(const LaunchLayout& launch, Errors& errors) : launch_(launch), errors_(errors) {}

  SceneDraft read(const YamlNode& root, const std::filesystem::path& file, IncludeChain& chain, bool is_whole) {
    static const Value kFile = map(scene_keys);
    SceneDraft draft;
    draft.folder = file.parent_path();
    draft.scene.name = file.stem().string();
    const Fields fields(Field(&root, root.place, "", kFile, true, errors_));
    scene_keys().read_members(fields, draft.scene);
    read_scene_layout(fields["layout"], launch_, draft);
    std::vector<Included> includes = read_includes(
        fields["include"], draft, chain,
        [this](const std::filesystem::path& other, IncludeChain& onwards) { return read_part(other, onwards); });
    take_over_kinds(includes, draft);
    read_materials(fields["materials"], draft);
    read_shapes(fields["shapes"], draft);
    read_prototypes(fields["prototypes"], draft);
    read_statics(fields["statics"], draft);
    read_bodies(fields["bodies"], draft);
    read_generators(fields["generators"], draft);
    take_over_bodies(includes, draft);
    read_joints(fields["joints"], draft);
    take_over_joints(includes, draft);
    if (is_whole) number_bodies(draft), number_joints(draft);
    read_injectors(fields["injectors"], draft);
    take_over_injectors(includes, draft);
    fields.close();
    return draft;
  }

 private:
  SceneDraft read_part(const std::filesystem::path& file, IncludeChain& chain) {
    const std::optional<YamlNode> root = read_yaml(file, errors_, kLongLists);
    return root ? read(*root, file, chain, false) : SceneDraft{};
  }

  const LaunchLayout& launch_;
  Errors& errors_;
};

}  // namespace

const KeyTable& scene_file_keys() { return scene_keys(); }

SceneFile read_scene_file(const std::filesystem::path& file, const std::vector<Override>& overrides,
                          const LaunchLayout& launch, Errors& errors) {
  std::optional<YamlNode> root = read_yaml(file, errors, kLongLists);
  if (!root) return {};
  for (const Override& change : overrides) apply_override(change, *root, errors);
  if (YamlNode* layout = root->find("layout")) settle_overridden_layout(*layout);
  IncludeChain chain{.files = {std::filesystem::absolute(file).lexically_normal()}};
  SceneDraft draft = Reader(launch, errors).read(*root, file, chain, true);
  return {std::move(draft.scene), std::move(draft.body_sources), std::move(draft.injector_sources)};
}

core::Scene read_scene(const std::filesystem::path& file) {
  Errors errors;
  core::Scene scene = read_scene_file(std::filesystem::absolute(file).lexically_normal(), {}, {}, errors).scene;
  errors.throw_if_any();
  return scene;
}

}  // namespace aurasim::config
