#include "import/read_model.h"

#include <set>

#include <fmt/format.h>

#include "config/meshes.h"
#include "import/mesh_shapes.h"
#include "import/stand_ins.h"
#include "import/xml_file.h"

namespace aurasim::importing {
namespace {

constexpr std::uintmax_t kLargestModelBytes = 64u << 20;
const std::set<std::string> kMeshEndings = {".obj", ".stl", ".gltf", ".glb", ".dae"};

[[noreturn]] void refuse_file(const std::filesystem::path& file, const std::string& why) {
  throw BadModel({fmt::format("{}: {}", file.string(), why)});
}

void check_size(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) refuse_file(file, "no such file");
  const auto size = std::filesystem::file_size(file, error);
  if (error) refuse_file(file, error.message());
  if (size > kLargestModelBytes)
    refuse_file(file, fmt::format("it has {} bytes, at most {}", size, kLargestModelBytes));
}

/// Reads a mesh file as one static mesh or, with a mass, as one body about its centre of mass.
Model read_mesh_model(const std::filesystem::path& file, const ReadSettings& settings) {
  Model model;
  model.name = file.stem().string();
  Link link;
  link.name = model.name;
  link.is_static = !settings.mass_kg;
  const core::TriangleMesh mesh =
      add_mesh(file, core::Vec3::Ones(), {.name = "mesh", .geometry = {}, .X_LC = {}, .surface = {}},
               element_name("mesh", model.name), link, model);
  if (settings.mass_kg) spread_mass_evenly(*settings.mass_kg, config::centre_of_mass(mesh), link);
  model.links.push_back(std::move(link));
  return model;
}

std::string outermost_element(const std::filesystem::path& file) {
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement* root = load_xml(file, document);
  return root == nullptr ? "" : root->Name();
}

Model read_described(const std::filesystem::path& file, const ReadSettings& settings) {
  const std::string outermost = outermost_element(file);
  if (outermost == "robot") return read_urdf(file, settings);
  if (outermost == "sdf") return read_sdf(file, settings);
  if (outermost == "mujoco") return read_mjcf(file, settings);
  refuse_file(file,
              fmt::format("found the outermost element <{}>, allowed: robot (URDF), sdf, mujoco (MJCF)", outermost));
}

void check_names(const std::filesystem::path& file, const Model& model) {
  std::set<std::string> names;
  for (const Link& link : model.links) {
    if (!names.insert(link.name).second)
      refuse_file(file, element_name("link", link.name) + ": its name is there twice");
  }
}

}  // namespace

Model read_model(const std::filesystem::path& file, const ReadSettings& settings) {
  check_size(file);
  const bool is_mesh = kMeshEndings.contains(ending_of(file));
  if (!is_mesh && settings.mass_kg) refuse_file(file, "a mass is for mesh files; the model has its own");
  Model model = is_mesh ? read_mesh_model(file, settings) : read_described(file, settings);
  if (model.links.empty()) refuse_file(file, "it has no links");
  check_names(file, model);
  tidy_apart(model);
  return model;
}

}  // namespace aurasim::importing
