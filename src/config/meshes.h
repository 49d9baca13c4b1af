// Reads mesh files (OBJ, STL, glTF) as points and triangles, through assimp.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/order.h"
#include "core/scene.h"

namespace aurasim::config {

enum class UpAxis { kY, kZ };

struct MeshRequest {
  std::filesystem::path file;
  core::Vec3 scale = core::Vec3::Ones();
  UpAxis up = UpAxis::kZ;  ///< kY: the file's y becomes our z, and its z our -y
};

/// The up axis that a file's format prescribes: y for glTF, z for all others.
UpAxis usual_up_axis(const std::filesystem::path& file);

/// Returns all triangles of the file with equal points joined, or the reason why there are none.
std::variant<core::TriangleMesh, std::string> load_mesh(const MeshRequest& request);

/// Reads a mesh from the bytes of a file. `name` gives the format by its ending. No other files are read, even if the
/// bytes name some.
std::variant<core::TriangleMesh, std::string> read_mesh(const std::string& name, std::string_view bytes);

/// Hash by which clients and nodes name a mesh of this content.
std::uint64_t content_hash(std::string_view bytes);

/// Points of the convex hull of a mesh: all of them up to a limit, beyond it those that are extreme in many directions.
std::vector<core::Vec3> hull_points(const core::TriangleMesh& mesh);

/// Returns the shape of a client's mesh for the intended use. Hulls and parts are about their centre of mass.
core::Shape shape_for(const core::TriangleMesh& mesh, core::MeshUse use);

/// Centre of mass of the volume inside a closed mesh; the mean of its points if it encloses nothing.
core::Vec3 centre_of_mass(const core::TriangleMesh& mesh);

}  // namespace aurasim::config
