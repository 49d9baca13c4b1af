#include "config/bodies.h"

#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>

#include "config/shapes.h"

namespace aurasim::config {
namespace {

constexpr std::size_t kMostStatics = 100'000;
constexpr Range kMass = Range::above(0, 1e9);

/// Takes over `value` where one is given.
void read_number(Field field, const Range& range, double& value) {
  if (!field.given()) return;
  value = field.number(range).value_or(value);
}

core::Material read_material(const std::string& name, const Field& field) {
  core::Material material{.name = name};
  Fields fields(field);
  read_number(fields.optional("friction"), Range::from_to(0, 100), material.friction);
  read_number(fields.optional("rolling_friction"), Range::from_to(0, 100), material.rolling_friction);
  read_number(fields.optional("spinning_friction"), Range::from_to(0, 100), material.spinning_friction);
  read_number(fields.optional("restitution"), Range::from_to(0, 1), material.restitution);
  read_number(fields.optional("linear_damping"), Range::from_to(0, 1), material.linear_damping);
  read_number(fields.optional("angular_damping"), Range::from_to(0, 1), material.angular_damping);
  fields.close();
  return material;
}

core::Prototype read_prototype(const std::string& name, const Field& field, SceneDraft& draft) {
  core::Prototype prototype{.name = name};
  Fields fields(field);
  const Field shape_field = fields.required("shape");
  if (fields.given()) {
    if (const auto shape = read_shape_reference(shape_field, "prototypes." + name, draft)) {
      prototype.shape = *shape;
      if (!can_move(draft.scene.shapes[*shape].shape)) {
        shape_field.complain("found a mesh, heightfield or plane, allowed: a shape that can move");
      }
    }
  }
  prototype.mass_kg = fields.required("mass").number(kMass).value_or(1);
  prototype.material = read_material_reference(fields.optional("material"), draft).value_or(0);
  if (const Field can_sleep = fields.optional("can_sleep"); can_sleep.given()) {
    prototype.can_sleep = can_sleep.flag().value_or(true);
  }
  fields.close();
  return prototype;
}

core::StaticBody read_static(const Field& field, std::size_t index, SceneDraft& draft) {
  core::StaticBody body;
  Fields fields(field);
  body.name = fmt::format("static {}", index);
  if (const Field name = fields.optional("name"); name.given()) body.name = name.text("a name").value_or(body.name);
  const Field shape = fields.required("shape");
  if (fields.given()) {
    body.shape = read_shape_reference(shape, fmt::format("statics[{}]", index), draft).value_or(0);
  }
  body.material = read_material_reference(fields.optional("material"), draft).value_or(0);
  body.pose = read_pose(fields);
  fields.close();
  return body;
}

DraftBody read_body(const Field& field, SceneDraft& draft) {
  DraftBody draft_body;
  core::InitialBody& body = draft_body.body;
  Fields fields(field);
  if (const Field name = fields.optional("name"); name.given()) {
    if (const auto text = name.text("a name")) draft.name_next_body(*text, name);
  }
  if (const Field id = fields.optional("id"); id.given()) {
    if (const auto number = id.integer(0, kLargestBodyId))
      draft_body.id = core::BodyId{static_cast<std::uint64_t>(*number)};
  }
  const Field prototype = fields.required("prototype");
  if (fields.given()) body.prototype = core::PrototypeId{draft.prototypes.find(prototype).value_or(0)};
  body.pose = read_pose(fields);
  if (const Field v = fields.optional("velocity"); v.given()) body.v_WB = v.vec3(kSpeed).value_or(body.v_WB);
  if (const Field w = fields.optional("spin"); w.given()) body.w_WB = w.vec3(kSpeed).value_or(body.w_WB);
  fields.close();
  return draft_body;
}

}  // namespace

void read_materials(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const auto& [name, entry] : field.entries("a map of materials by name")) {
    draft.scene.materials.push_back(read_material(name, entry));
    draft.materials.add(name);
  }
}

void read_shapes(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const auto& [name, entry] : field.entries("a map of shapes by name")) {
    // A shape that could not be read has its name all the same, or every use of it would be one more error.
    draft.scene.shapes.push_back({name, read_shape(entry, draft.folder).value_or(core::Sphere{})});
    draft.shapes.add(name);
  }
}

void read_prototypes(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const auto& [name, entry] : field.entries("a map of prototypes by name")) {
    draft.scene.prototypes.push_back(read_prototype(name, entry, draft));
    draft.prototypes.add(name);
  }
}

void read_statics(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  std::unordered_set<std::string> names;
  std::size_t index = 0;
  for (const Field& item : field.items(0, kMostStatics)) {
    core::StaticBody body = read_static(item, index++, draft);
    if (!names.insert(body.name).second) {
      item.complain(fmt::format("found the name {} a second time, allowed: each name once", in_quotes(body.name)));
    }
    draft.scene.statics.push_back(std::move(body));
  }
}

void read_bodies(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  std::unordered_set<std::uint64_t> ids;
  for (const Field& item : field.items(0, kMostBodies)) {
    DraftBody body = read_body(item, draft);
    if (body.id && !ids.insert(value_of(*body.id)).second) {
      item.complain(fmt::format("found the id {} a second time, allowed: each id once", value_of(*body.id)));
    }
    draft.bodies.push_back(std::move(body));
  }
}

void number_bodies(SceneDraft& draft) {
  std::unordered_set<std::uint64_t> taken;
  for (const DraftBody& body : draft.bodies) {
    if (body.id) taken.insert(value_of(*body.id));
  }
  std::uint64_t next = 0;
  for (DraftBody& body : draft.bodies) {
    while (!body.id && taken.contains(next)) ++next;
    body.body.id = body.id ? *body.id : core::BodyId{next++};
    draft.scene.bodies.push_back(body.body);
  }
  std::sort(draft.scene.bodies.begin(), draft.scene.bodies.end(),
            [](const core::InitialBody& a, const core::InitialBody& b) { return a.id < b.id; });
}

}  // namespace aurasim::config
