// Makes collision shapes of meshes: convex ones for links that move, triangles for static ones.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// Ending of a file's name, in small letters: ".obj".
std::string ending_of(const std::filesystem::path& file);

/// Returns all triangles of an OBJ, STL, glTF or Collada (DAE) file, times `scale`, or the reason why there are none.
/// The axes of Collada are used as written, and its up axis is ignored, as the robots' own programs do.
std::variant<core::TriangleMesh, std::string> read_triangles(const std::filesystem::path& file,
                                                             const core::Vec3& scale);

/// Returns convex shapes for a mesh: the mesh itself if it is convex, else its convex parts, else its hull. A change of
/// the shape is added to the model's findings.
std::vector<core::ConvexHull> convex_shapes(const core::TriangleMesh& mesh, const std::string& element, Model& model);

/// Returns the hull of the mesh's points; if there are very many, of the outermost ones.
core::ConvexHull hull_of_points(const core::TriangleMesh& mesh);

/// Returns the hull of evenly spread points of an ellipsoid with these half axes, m.
core::ConvexHull ellipsoid_hull(const core::Vec3& half_axes);

/// Writes triangles as the text of an OBJ file.
std::string obj_text(const core::TriangleMesh& mesh);

/// Adds a collision shape to the link for each convex part of the mesh. A static link gets the file itself if the scene
/// reader can read it, or else the triangles. Returns the mesh. Throws BadModel if the file cannot be read.
core::TriangleMesh add_mesh(const std::filesystem::path& file, const core::Vec3& scale, Collision collision,
                            const std::string& element, Link& link, Model& model);

}  // namespace aurasim::importing
