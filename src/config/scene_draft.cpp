#include "config/scene_draft.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "config/shapes.h"

namespace aurasim::config {
namespace {

constexpr double kSmallestQuaternion = 1e-6;

core::Quat from_rpy_deg(const core::Vec3& rpy_deg) {
  const core::Vec3 rpy = rpy_deg * (std::numbers::pi / 180);
  return core::Quat(Eigen::AngleAxisd(rpy.z(), core::Vec3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), core::Vec3::UnitY()) *
                    Eigen::AngleAxisd(rpy.x(), core::Vec3::UnitX()));
}

}  // namespace

SceneSource source_of(const Field& field, std::string name) {
  return {std::move(name), field.place().line, field.place().column};
}

const KeyTable& orientation_keys() {
  static const KeyTable keys{
      .title = "orientation",
      .about = "How a thing is turned: exactly one of these.",
      .keys = {optional("rpy_deg", vec3("degrees", Range::from_to(-3600, 3600)),
                        "[roll, pitch, yaw], about the fixed axes x, y, z, in this order"),
               optional("quaternion", numbers(4, kAnyNumber), "[w, x, y, z], of any length but 0")},
      .one_of = {"rpy_deg", "quaternion"}};
  return keys;
}

const KeyTable& pose_keys() {
  static const KeyTable keys{
      .title = "position and orientation",
      .about = "The pose of a thing: the place and rotation of its origin.",
      .keys = {optional("position", vec3("m", kPlace), "[x, y, z]; z is up").usual("[0, 0, 0]"),
               optional("orientation", map(orientation_keys), "how it is turned").otherwise("not turned")}};
  return keys;
}

Key shape_key(std::string_view meaning) {
  return required("shape", name_of("shape").or_else(map(shape_keys)), meaning);
}

Key material_key() {
  return optional("material", name_of("material"), "what its surface is like")
      .otherwise("the material `default`, if there is one of this name, or else one of defaults");
}

Key own_name_key(std::string_view meaning, std::string otherwise) {
  return optional("name", text("a name"), meaning).otherwise(std::move(otherwise));
}

core::Quat read_orientation(const Field& field) {
  core::Quat q = core::Quat::Identity();
  if (!field.given()) return q;
  const Fields fields(field);
  fields.close();
  if (!fields.given()) return q;
  if (fields.given_of(orientation_keys()).size() != 1) {
    field.refuse("one of rpy_deg, quaternion");
    return q;
  }
  if (const Field rpy_field = fields["rpy_deg"]; rpy_field.given()) {
    if (const auto rpy_deg = rpy_field.vec3()) q = from_rpy_deg(*rpy_deg);
    return q;
  }
  const Field quaternion_field = fields["quaternion"];
  const auto wxyz = quaternion_field.numbers();
  if (!wxyz) return q;
  const core::Quat given((*wxyz)[0], (*wxyz)[1], (*wxyz)[2], (*wxyz)[3]);
  if (given.norm() < kSmallestQuaternion) {
    quaternion_field.complain("found a quaternion of length 0, allowed: [w, x, y, z] that can be normalised");
    return q;
  }
  return given.normalized();
}

std::uint32_t Names::add(const std::string& name) {
  const auto index = static_cast<std::uint32_t>(names_.size());
  names_.push_back(name);
  index_.emplace(name, index);
  return index;
}

std::optional<std::uint32_t> Names::index_of(const std::string& name) const {
  const auto found = index_.find(name);
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint32_t> Names::find(const Field& field) const {
  const auto index = field.is_text() ? index_of(field.node()->text) : std::nullopt;
  if (index) return index;
  field.refuse(fmt::format("a {} of this scene: {}", kind_, listed({names_.begin(), names_.end()})));
  return std::nullopt;
}

void SceneDraft::name_next_body(const std::string& name, const Field& blame) {
  if (body_names.index_of(name)) {
    blame.complain(fmt::format("found the name {} a second time, allowed: each name once", in_quotes(name)));
    return;
  }
  body_names.add(name);
  named_bodies.push_back(bodies.size());
}

bool SceneDraft::has_room_for(std::uint64_t count, const Field& blame) const {
  const std::uint64_t taken = bodies.size() + injected_bodies;
  if (count <= kMostBodies - std::min(taken, kMostBodies)) return true;
  blame.complain(
      fmt::format("found {} bodies after {} others, allowed: {} in the whole scene", count, taken, kMostBodies));
  return false;
}

core::Pose read_pose(const Fields& fields) {
  core::Pose pose;
  pose.p_WB = fields["position"].vec3().value_or(pose.p_WB);
  pose.q_WB = read_orientation(fields["orientation"]);
  return pose;
}

/// The comparison is written so that NaN counts as out of reach.
bool is_within_reach(const core::Vec3& p_W) { return p_W.cwiseAbs().maxCoeff() <= core::limits::kFarthestPlace_m; }

void complain_of_place(const Field& blame, std::string_view what, const core::Vec3& p_W) {
  blame.complain(fmt::format("found {} at [{:.4g}, {:.4g}, {:.4g}] m, allowed: each coordinate from -{:g} to {:g} m",
                             what, p_W.x(), p_W.y(), p_W.z(), core::limits::kFarthestPlace_m,
                             core::limits::kFarthestPlace_m));
}

std::optional<std::uint32_t> read_shape_reference(const Field& field, const std::string& own_name, SceneDraft& draft) {
  if (!field.is_map()) return draft.shapes.find(field);
  const auto shape = read_shape(field, draft);
  if (!shape) return std::nullopt;
  draft.scene.shapes.push_back({own_name, *shape});
  return draft.shapes.add(own_name);
}

std::optional<std::uint32_t> read_material_reference(const Field& field, SceneDraft& draft) {
  if (field.given()) return draft.materials.find(field);
  if (const auto index = draft.materials.index_of("default")) return index;
  draft.scene.materials.push_back({.name = "default"});
  return draft.materials.add("default");
}

}  // namespace aurasim::config
