// Meshes as collision shapes: convex ones for what moves, triangles for what does not.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// Of its name, in small letters: ".obj".
std::string ending_of(const std::filesystem::path& file);

/// All triangles of an OBJ, STL, glTF or Collada (DAE) file, times `scale`, or why there are none. Of Collada the axes
/// are taken as they are written, whatever is said to be up: as the robots' own programs do.
std::variant<core::TriangleMesh, std::string> read_triangles(const std::filesystem::path& file,
                                                             const core::Vec3& scale);

/// Convex shapes in the place of the mesh: itself if it is convex, else the parts that it is taken apart into, else its
/// hull. What that changes is told of.
std::vector<core::ConvexHull> convex_shapes(const core::TriangleMesh& mesh, const std::string& element, Model& model);

/// The hull of the mesh's points; of very many the outermost.
core::ConvexHull hull_of_points(const core::TriangleMesh& mesh);

/// Points of an ellipsoid with these half axes, evenly spread.
core::ConvexHull ellipsoid_hull(const core::Vec3& half_axes);

/// Triangles as the text of an OBJ file.
std::string obj_text(const core::TriangleMesh& mesh);

/// Gives the link a collision shape for each convex part of the mesh; of a static link, the file itself where the scene
/// reader reads it, or else the triangles. Returns the mesh. Throws BadModel if the file cannot be read.
core::TriangleMesh add_mesh(const std::filesystem::path& file, const core::Vec3& scale, Collision collision,
                            const std::string& element, Link& link, Model& model);

}  // namespace aurasim::importing
