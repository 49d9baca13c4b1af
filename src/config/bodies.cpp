#include "config/bodies.h"

#include <algorithm>
#include <numeric>
#include <unordered_set>

#include <fmt/format.h>

#include "config/keys_of.h"
#include "config/shapes.h"
#include "config/static_paths.h"
#include "core/limits.h"

namespace aurasim::config {
namespace {

const KeysOf<core::Material>& keys_of_material() {
  using core::Material;
  static const KeysOf<Material> keys(
      "material", "The properties of a body's surface, and its damping.",
      {
          optional("friction", &Material::friction, number(Range::from_to(0, 100)),
                   "Coulomb's; that of a contact is the product of the two bodies'"),
          optional("rolling_friction", &Material::rolling_friction, number(Range::from_to(0, 100), "m"),
                   "resists rolling: without it, a ball on a plane rolls for ever"),
          optional("spinning_friction", &Material::spinning_friction, number(Range::from_to(0, 100), "m"),
                   "resists spinning about the contact's normal"),
          optional("restitution", &Material::restitution, number(Range::from_to(0, 1)),
                   "share of its speed that it bounces back with; that of a contact is the product of the two bodies'"),
          optional("linear_damping", &Material::linear_damping, number(Range::from_to(0, 1)),
                   "share of its velocity that a body loses in a second"),
          optional("angular_damping", &Material::angular_damping, number(Range::from_to(0, 1)),
                   "share of its spin that a body loses in a second"),
      });
  return keys;
}

const KeysOf<core::Prototype>& keys_of_prototype() {
  using namespace core::limits;
  using core::Prototype;
  static const KeysOf<Prototype> keys(
      "prototype", "The properties that bodies of one kind share.",
      {
          shape_key("one that can move: no mesh, no heightfield, no plane"),
          required("mass", &Prototype::mass_kg, number(Range::from_to(kLightestOfScene_kg, kHeaviestOfScene_kg), "kg"),
                   "spread evenly over the shape, unless it has an `inertia`; of a compound, about its origin"),
          optional(
              "inertia", &Prototype::inertia,
              vec3("kg m^2", Range::from_to(kSmallestInertia_kg_m2, kLargestInertia_kg_m2)),
              "[ixx, iyy, izz], moments of inertia about the centre of mass along the axes of the body; none above "
              "the sum of the two others")
              .otherwise("that of mass spread evenly over the shape"),
          material_key(),
          optional("collides", &Prototype::collides, flag(),
                   "whether it touches anything; without, it is moved by its joints alone, and rays pass through it"),
          optional("can_sleep", &Prototype::can_sleep, flag(),
                   "whether it is put to rest, and costs no more, when it has lain still for 2 s"),
      });
  return keys;
}

const KeysOf<core::InitialBody>& keys_of_body() {
  using core::InitialBody;
  static const KeysOf<InitialBody> keys(
      "body", "A body that is there at the start.",
      {
          required("prototype", name_of("prototype"), "what kind of body"),
          own_name_key("by which joints refer to it", "it has none"),
          optional("id", integer(0, kLargestBodyId), "which commands and reports name it by; each once")
              .otherwise("the lowest free one, in the order of the file"),
          optional("velocity", &InitialBody::v_WB, vec3("m/s", kSpeed), "at the start"),
          optional("spin", &InitialBody::w_WB, vec3("rad/s", kSpeed), "angular velocity at the start, in the world"),
      });
  return keys;
}

const KeysOf<core::StaticBody>& keys_of_static() {
  using core::limits::kFastestStatic_m_s;
  static const KeysOf<core::StaticBody> keys(
      "static", "A thing that nothing moves, the same on every node. It stands, or goes as its path says.",
      {
          shape_key("any shape"),
          own_name_key("by which commands and reports refer to it; each once",
                       "`static N`, N from 0 in the order of the file"),
          material_key(),
          optional("path", map(path_keys), "where it goes: a lift, a gate, a turntable").otherwise("it stands"),
          optional("belt", &core::StaticBody::belt_S,
                   vec3("m/s", Range::from_to(-kFastestStatic_m_s, kFastestStatic_m_s)),
                   "how its surface runs along itself, in its axes: a conveyor. Solver soft_step only"),
      });
  return keys;
}

constexpr double kRoundedMoments = 1e-9;  ///< relative tolerance: rounding error of a thin plate's moments

/// Checks that no moment is larger than the sum of the two others, as for any real body.
void check_inertia(const Field& field, const std::optional<core::Vec3>& inertia) {
  if (!inertia || 2 * inertia->maxCoeff() <= inertia->sum() * (1 + kRoundedMoments)) return;
  field.refuse("three moments of inertia of which none is above the sum of the two others");
}

core::Material read_material(const std::string& name, const Field& field) {
  core::Material material{.name = name};
  keys_of_material().read(field, material);
  return material;
}

core::Prototype read_prototype(const std::string& name, const Field& field, SceneDraft& draft) {
  core::Prototype prototype{.name = name};
  const Fields fields(field);
  if (fields.given()) {
    const Field shape_field = fields["shape"];
    if (const auto shape = read_shape_reference(shape_field, "prototypes." + name, draft)) {
      prototype.shape = *shape;
      if (!can_move(draft.scene.shapes[*shape].shape)) {
        shape_field.complain("found a mesh, heightfield or plane, allowed: a shape that can move");
      }
    }
  }
  keys_of_prototype().read_members(fields, prototype);
  if (fields.given()) check_inertia(fields["inertia"], prototype.inertia);
  prototype.material = read_material_reference(fields["material"], draft).value_or(0);
  fields.close();
  return prototype;
}

/// Refuses a name that something of an included file already has.
void refuse_taken(const std::string& name, const Names& names, const Field& blame) {
  if (!names.index_of(name)) return;
  blame.complain(fmt::format("found the name {} a second time, allowed: each name once", in_quotes(name)));
}

core::StaticBody read_static(const Field& field, std::size_t index, SceneDraft& draft) {
  core::StaticBody body;
  const Fields fields(field);
  body.name = fields["name"].text().value_or(core::StaticList::usual_name(index));
  if (fields.given()) {
    body.shape = read_shape_reference(fields["shape"], fmt::format("statics[{}]", index), draft).value_or(0);
  }
  body.material = read_material_reference(fields["material"], draft).value_or(0);
  body.pose = read_pose(fields);
  keys_of_static().read_members(fields, body);
  const Field path = fields["path"];
  body.path = read_path(path);
  const std::vector<core::NamedShape>& shapes = draft.scene.shapes;
  if (body.path && body.shape < shapes.size() && std::holds_alternative<core::Plane>(shapes[body.shape].shape)) {
    path.complain("found the path of a plane, allowed: of shapes that end somewhere");
  }
  fields.close();
  return body;
}

DraftBody read_body(const Field& field, SceneDraft& draft) {
  DraftBody draft_body;
  core::InitialBody& body = draft_body.body;
  const Fields fields(field);
  const Field name = fields["name"];
  draft_body.source = source_of(field, name.text().value_or(""));
  if (!draft_body.source.name.empty()) draft.name_next_body(draft_body.source.name, name);
  if (const auto id = fields["id"].integer()) draft_body.id = core::BodyId{static_cast<std::uint64_t>(*id)};
  if (fields.given()) body.prototype = core::PrototypeId{draft.prototypes.find(fields["prototype"]).value_or(0)};
  body.pose = read_pose(fields);
  keys_of_body().read_members(fields, body);
  fields.close();
  return draft_body;
}

}  // namespace

const KeyTable& material_keys() { return keys_of_material(); }

const KeyTable& prototype_keys() { return keys_of_prototype(); }

const KeyTable& static_keys() { return keys_of_static(); }

const KeyTable& body_keys() { return keys_of_body(); }

void read_materials(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const auto& [name, entry] : field.entries()) {
    refuse_taken(name, draft.materials, entry);
    draft.scene.materials.push_back(read_material(name, entry));
    draft.materials.add(name);
  }
}

void read_shapes(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const auto& [name, entry] : field.entries()) {
    refuse_taken(name, draft.shapes, entry);
    // A shape that could not be read still gets its name; otherwise every use of it would be one more error.
    draft.scene.shapes.push_back({name, read_shape(entry, draft).value_or(core::Sphere{})});
    draft.shapes.add(name);
  }
}

void read_prototypes(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const auto& [name, entry] : field.entries()) {
    refuse_taken(name, draft.prototypes, entry);
    draft.scene.prototypes.push_back(read_prototype(name, entry, draft));
    draft.prototypes.add(name);
  }
}

void read_statics(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  core::StaticList& statics = draft.scene.statics;
  std::unordered_set<std::string> given;  // names; most statics have their usual one
  field.for_each_item([&](const Field& item) {
    const std::size_t index = statics.size();
    const core::StaticBody body = read_static(item, index, draft);
    const bool is_usual = body.name == core::StaticList::usual_name(index);
    const bool is_taken = given.contains(body.name) || statics.find_usual(body.name);
    if (is_taken) {
      item.complain(fmt::format("found the name {} a second time, allowed: each name once", in_quotes(body.name)));
    }
    if (!is_usual) given.insert(body.name);
    statics.push_back(body);
  });
}

void read_bodies(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  std::unordered_set<std::uint64_t> ids;
  field.for_each_item([&](const Field& item) {
    DraftBody body = read_body(item, draft);
    if (body.id && !ids.insert(value_of(*body.id)).second) {
      item.complain(fmt::format("found the id {} a second time, allowed: each id once", value_of(*body.id)));
    }
    draft.bodies.push_back(std::move(body));
  });
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
  }
  // Sorts places, not bodies, because joints refer to bodies by their places.
  std::vector<std::size_t> order(draft.bodies.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return draft.bodies[i].body.id; });
  for (const std::size_t i : order) {
    draft.scene.bodies.push_back(draft.bodies[i].body);
    draft.body_sources.push_back(std::move(draft.bodies[i].source));
  }
}

}  // namespace aurasim::config
