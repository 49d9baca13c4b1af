#include "config/shape_keys.h"

#include "config/heightfield.h"
#include "config/meshes.h"
#include "config/scene_draft.h"
#include "config/shapes.h"

namespace aurasim::config {
namespace {

constexpr std::size_t kMostPartsOfCompound = 1000;
constexpr std::size_t kMostPoints = 1000;

const KeyTable& sphere_keys() {
  static const KeyTable keys{
      .title = "shape: sphere", .about = "A ball.", .keys = {required("radius", number(kSize, "m"), "of the ball")}};
  return keys;
}

const KeyTable& box_keys() {
  static const KeyTable keys{.title = "shape: box",
                             .about = "A cuboid.",
                             .keys = {required("size", vec3("m", kSize), "whole edges, along x, y, z")}};
  return keys;
}

const KeyTable& cylinder_keys() {
  static const KeyTable keys{.title = "shape: cylinder",
                             .about = "Its axis is z.",
                             .keys = {required("radius", number(kSize, "m"), "of the round"),
                                      required("height", number(kSize, "m"), "the whole height")}};
  return keys;
}

const KeyTable& compound_keys() {
  static const KeyTable keys{
      .title = "shape: compound",
      .about = "Convex parts that stick together. The origin is the centre of mass.",
      .keys = {required("parts", list(1, kMostPartsOfCompound, map(part_keys).with(pose_keys)), "what it is made of")}};
  return keys;
}

Key scale_key() {
  const Range any = Range::from_to(1e-9, 1e6);
  return optional("scale", number(any).or_else(vec3("", any)), "all points times this, or each axis times its own")
      .usual("1");
}

Key up_key() {
  return optional("up", choice<UpAxis>({{"y", UpAxis::kY}, {"z", UpAxis::kZ}}), "which axis of the file is up")
      .otherwise("y for glTF, z for others");
}

const KeyTable& mesh_keys() {
  static const KeyTable keys{.title = "shape: mesh",
                             .about = "Triangles. Statics only.",
                             .keys = {required("file", text("an OBJ, STL or glTF file"), "relative to the scene file"),
                                      scale_key(), up_key()}};
  return keys;
}

const KeyTable& plane_keys() {
  static const KeyTable keys{
      .title = "shape: plane",
      .about = "The half-space below `normal . x = offset`. Statics only.",
      .keys = {optional("normal", vec3(), "points out of the ground; of any length but 0").usual("[0, 0, 1]"),
               optional("offset", number(kAnyNumber, "m"), "how far from the origin, along the normal").usual("0")}};
  return keys;
}

}  // namespace

const KeyTable& capsule_keys() {
  static const KeyTable keys{.title = "shape: capsule",
                             .about = "A cylinder with round caps. Its axis is z. Exactly one of the heights.",
                             .keys = {required("radius", number(kSize, "m"), "of the caps"),
                                      optional("height", number(kSize, "m"), "between the centres of the caps"),
                                      optional("total_height", number(Range::above(0, kSize.high), "m"),
                                               "over all; more than twice the radius")},
                             .one_of = {"height", "total_height"}};
  return keys;
}

const KeyTable& hull_of_points_keys() {
  static const KeyTable keys{
      .title = "shape: convex_hull of points",
      .about = "The smallest convex shape that holds all of them.",
      .keys = {required("points", list(4, kMostPoints, vec3("m", kPlace)), "not all in one plane")}};
  return keys;
}

const KeyTable& hull_of_mesh_keys() {
  static const KeyTable keys{
      .title = "shape: convex_hull of a mesh",
      .about = "The smallest convex shape that holds all points of a mesh file.",
      .keys = {required("mesh", text("an OBJ, STL or glTF file"), "relative to the scene file"), scale_key(), up_key(),
               optional("recentre", flag(), "moves the origin to the centre of mass").usual("false")}};
  return keys;
}

const KeyTable& part_keys() {
  static const KeyTable keys{
      .title = "part of a compound",
      .about = "Exactly one convex shape, and where it is.",
      .keys = {optional("sphere", map(sphere_keys), "a ball"), optional("box", map(box_keys), "a cuboid"),
               optional("capsule", map(capsule_keys), "a cylinder with round caps"),
               optional("cylinder", map(cylinder_keys), "a cylinder"),
               optional("convex_hull", map_of_one({hull_of_points_keys, hull_of_mesh_keys}), "a convex hull"),
               optional("material", name_of("material"),
                        "what the surface of this part is like; how the body is slowed "
                        "down is the body's alone")
                   .otherwise("the body's")},
      .one_of = {"sphere", "box", "capsule", "cylinder", "convex_hull"}};
  return keys;
}

const KeyTable& shape_keys() {
  static const KeyTable keys{
      .title = "shape",
      .about = "Exactly one of these. `mesh`, `heightfield` and `plane` do not move.",
      .keys = {optional("sphere", map(sphere_keys), "a ball"), optional("box", map(box_keys), "a cuboid"),
               optional("capsule", map(capsule_keys), "a cylinder with round caps"),
               optional("cylinder", map(cylinder_keys), "a cylinder"),
               optional("convex_hull", map_of_one({hull_of_points_keys, hull_of_mesh_keys}),
                        "a convex hull of points or of a mesh file"),
               optional("compound", map(compound_keys), "convex parts that stick together"),
               optional("mesh", map(mesh_keys), "triangles of a file"),
               optional("heightfield", map(heightfield_keys), "ground as a grid of heights"),
               optional("plane", map(plane_keys), "a half-space: the usual ground")},
      .one_of = {"sphere", "box", "capsule", "cylinder", "convex_hull", "compound", "mesh", "heightfield", "plane"}};
  return keys;
}

}  // namespace aurasim::config
