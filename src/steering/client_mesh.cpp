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
  if (const auto* why = std::get_if<std::string>(&mesh)) throw BadMesh(file + ": " + *why);
  return std::get<core::TriangleMesh>(std::move(mesh));
}

}  // namespace

core::MeshRef bring_mesh(const std::string& file, core::MeshUse use, CommandClient& client) {
  core::TriangleMesh mesh = sound(config::load_mesh({file, core::Vec3::Ones(), config::usual_up_axis(file)}), file);
  if (use == core::MeshUse::kDecomposition) mesh = sound(config::decompose(mesh), file);
  const std::uint64_t hash = core::content_hash(mesh);
  client.bring(hash, mesh);
  return {hash, use};
}

}  // namespace aurasim::steering
