#include "steering/client_mesh.h"

#include <utility>
#include <variant>

#include "config/convex_parts.h"
#include "config/meshes.h"
#include "core/mesh_hash.h"

namespace aurasim::steering {
namespace {

using MeshOrWhy = std::variant<core::TriangleMesh, std::string>;

core::TriangleMesh sound(MeshOrWhy mesh, const std::string& file) {
  if (const auto* why = std::get_if<std::string>(&mesh)) throw BadAsk(file + ": " + *why);
  return std::get<core::TriangleMesh>(std::move(mesh));
}

void bring_mesh(const std::string& file, core::MeshRef& ref, CommandClient& client) {
  core::TriangleMesh mesh = sound(config::load_mesh({file, core::Vec3::Ones(), config::usual_up_axis(file)}), file);
  if (ref.use == core::MeshUse::kDecomposition) mesh = sound(config::decompose(mesh), file);
  ref.hash = core::content_hash(mesh);
  client.bring(ref.hash, mesh);
}

}  // namespace

core::Command command_of(Ask ask, const core::Scene& scene, CommandClient& client) {
  look_up_static(ask, scene);
  core::Command command;
  command.at_step = ask.at_step;
  command.ask = std::get<core::Ask>(std::move(ask.what));
  if (!ask.mesh_file.empty()) bring_mesh(ask.mesh_file, *core::mesh_in(command.ask), client);
  return command;
}

}  // namespace aurasim::steering
