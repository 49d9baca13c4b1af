#include "steering/ask_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "config/shapes.h"
#include "core/limits.h"
#include "cut/saved_world.h"
#include "steering/json_fields.h"

namespace aurasim::steering {
namespace {

using core::Vec3;

constexpr double kLongestCounted = 1e15;  ///< a whole number's limit beyond it is that of JSON, and is not shown

std::string with_unit(std::string text, const Field& field) {
  return field.unit.empty() ? text : fmt::format("{} {}", text, field.unit);
}

std::string refusal(std::string_view path, const Field& field, const std::string& found) {
  return fmt::format("{}.{}: found {}, allowed: {}", path, field.name, found, allowed(field));
}

std::string first_of(std::initializer_list<std::string> problems) {
  for (const std::string& problem : problems) {
    if (!problem.empty()) return problem;
  }
  return {};
}

/// Fault of the declared sizes of a shape. A mesh declares no sizes.
struct SizeProblem {
  std::string path;

  std::string with(std::string_view kind, std::string_view name, double value) const {
    return problem_with(path, field_of(kind, name), value);
  }
  std::string operator()(const core::Sphere& s) const { return with("sphere", "radius", s.radius); }
  std::string operator()(const core::Box& s) const {
    return problem_with(path, field_of("box", "size"), Vec3(2 * s.half_extents));
  }
  std::string operator()(const core::Capsule& s) const {
    return first_of({with("capsule", "radius", s.radius), with("capsule", "height", s.height)});
  }
  std::string operator()(const core::Cylinder& s) const {
    return first_of({with("cylinder", "radius", s.radius), with("cylinder", "height", s.height)});
  }
  std::string operator()(const core::MeshRef&) const { return {}; }
};

std::string problem_with_client_shape(std::string_view kind, const core::ClientShape& shape) {
  const std::string path = fmt::format("{}.shape", kind);
  if (std::string why = std::visit(SizeProblem{path}, shape); !why.empty()) return why;
  return std::visit(
      [&](const auto& simple) -> std::string {
        if constexpr (std::is_constructible_v<core::Shape, decltype(simple)>) {
          const std::string why = problem_with_shape(simple, kind == "spawn");
          return why.empty() ? why : path + ": " + why;
        } else {
          return {};  // nodes check a mesh when they have it
        }
      },
      shape);
}

std::string problem_with_pose(std::string_view kind, const core::Pose& pose) {
  return first_of(
      {problem_with(kind, field_of(kind, "p"), pose.p_WB), problem_with(kind, field_of(kind, "q"), pose.q_WB)});
}

struct Problem {
  static std::string with(std::string_view kind, std::string_view name, const auto& value) {
    return problem_with(kind, field_of(kind, name), value);
  }

  std::string operator()(const core::NewBody& ask) const {
    const std::string motion =
        first_of({problem_with_pose("spawn", ask.pose), with("spawn", "v", ask.v_WB), with("spawn", "w", ask.w_WB)});
    if (!motion.empty()) return motion;
    if (!ask.shape) return with("spawn", "prototype", ask.prototype);
    return first_of({with("spawn", "mass", ask.mass_kg), problem_with_client_shape("spawn", *ask.shape)});
  }
  std::string operator()(const core::NewStatic& ask) const {
    return first_of({problem_with_pose("static", ask.pose), problem_with_client_shape("static", ask.shape)});
  }
  std::string operator()(const core::RemoveBody&) const { return {}; }
  std::string operator()(const core::RemoveStatic&) const { return {}; }
  std::string operator()(const core::SendStatic& ask) const {
    return first_of({problem_with_pose("move", ask.to), with("move", "seconds", ask.duration_s)});
  }
  std::string operator()(const core::Impulse& ask) const {
    return first_of({with("impulse", "J", ask.J_W), ask.p_W ? with("impulse", "p", *ask.p_W) : std::string()});
  }
  std::string operator()(const core::SetVelocity& ask) const {
    return first_of({with("velocity", "v", ask.v_WB), ask.w_WB ? with("velocity", "w", *ask.w_WB) : std::string()});
  }
  std::string operator()(const core::SetRate& ask) const { return with("rate", "value", ask.rate); }
  std::string operator()(const core::Repartition& ask) const {
    const Field& field = field_of("regions", "boxes");
    const auto count = static_cast<double>(ask.boxes.size());
    if (!(count >= field.low && count <= field.high)) return refusal("regions", field, fmt::format("{} boxes", count));
    for (const core::Rectangle& box : ask.boxes) {
      if (box.x0 < box.x1 && box.y0 < box.y1) continue;
      return refusal("regions", field, fmt::format("[{:g}, {:g}, {:g}, {:g}]", box.x0, box.y0, box.x1, box.y1));
    }
    return {};
  }
  std::string operator()(const core::ChangeScene& ask) const { return with("scene", "name", ask.name); }
  std::string operator()(const core::Ray& ask) const {
    return first_of({with("ray", "from", ask.from_W), with("ray", "to", ask.to_W)});
  }
  std::string operator()(const core::Save& ask) const { return with("save", "name", ask.file); }
  std::string operator()(const core::Load& ask) const { return with("load", "name", ask.file); }
};

bool is_file_name(std::string_view name) {
  return name.find_first_of("/\\") == std::string_view::npos && !name.starts_with('.');
}

}  // namespace

std::string allowed(const Field& field) {
  switch (field.form) {
    case Form::kNumber:
      return with_unit(fmt::format("{:g} to {:g}", field.low, field.high), field);
    case Form::kWhole:
      if (field.high > kLongestCounted) return fmt::format("a whole number from {:g} on", field.low);
      return fmt::format("a whole number from {:.0f} to {:.0f}", field.low, field.high);
    case Form::kVector:
      return with_unit(fmt::format("three finite numbers from {:g} to {:g}", field.low, field.high), field);
    case Form::kLength:
      return fmt::format("{} at most{}{}, three finite numbers", with_unit(fmt::format("{:g}", field.high), field),
                         field.run_limit.empty() ? "" : " and ", field.run_limit);
    case Form::kRotation:
      return "a quaternion w x y z of finite numbers, e.g. 1 0 0 0";
    case Form::kText:
      return fmt::format("a text of {:g} to {:g} bytes", field.low, field.high);
    case Form::kFileName:
      return fmt::format("a file's name of {:g} to {:g} bytes, without / and \\, that does not begin with '.'",
                         field.low, field.high);
    case Form::kSaveName:
      return fmt::format(
          "a saved world's name has letters, digits, '.', '_' and '-', {:g} to {:g} of them, and does not begin with "
          "'.' "
          "or '-'. It is a file in the nodes' folder of saved worlds (--saves)",
          field.low, field.high);
    case Form::kStatic:
      return "the name or number of a static";
    case Form::kBoxes:
      return fmt::format("{:g} to {:g} boxes x0 y0 x1 y1 with x0 < x1 and y0 < y1; null is infinite", field.low,
                         field.high);
    case Form::kShape:
      return "one of the shapes";
    case Form::kHash:
      return "16 hexadecimal digits";
    case Form::kMeshUse:
      return "hull or decomposition; not of a static";
  }
  return {};
}

std::string problem_with(std::string_view path, const Field& field, double value) {
  return value >= field.low && value <= field.high ? std::string() : refusal(path, field, shown(value));
}

std::string problem_with(std::string_view path, const Field& field, const Vec3& value) {
  if (field.form == Form::kLength && value.norm() <= field.high) return {};
  const auto is_in = [&field](double number) { return number >= field.low && number <= field.high; };
  if (field.form == Form::kVector && is_in(value.x()) && is_in(value.y()) && is_in(value.z())) return {};
  return refusal(path, field, shown(value));
}

std::string problem_with(std::string_view path, const Field& field, const core::Quat& value) {
  if (std::abs(value.norm() - 1) < 1e-3) return {};
  return refusal(path, field, fmt::format("[{:g}, {:g}, {:g}, {:g}]", value.w(), value.x(), value.y(), value.z()));
}

std::string problem_with(std::string_view path, const Field& field, const std::string& value) {
  const auto size = static_cast<double>(value.size());
  const bool is_sound = size >= field.low && size <= field.high &&
                        (field.form != Form::kFileName || is_file_name(value)) &&
                        (field.form != Form::kSaveName || cut::is_save_name(value));
  return is_sound ? std::string() : refusal(path, field, shown(nlohmann::json(value)));
}

std::string problem_with(const core::Ask& ask) { return std::visit(Problem{}, ask); }

std::string problem_with_shape(const core::Shape& shape, bool is_body) {
  using namespace core::limits;
  if (const auto* const mesh = std::get_if<core::TriangleMesh>(&shape)) {
    if (is_body) return "a mesh of triangles cannot move; use its hull";
    if (mesh->triangles.size() > kMostTriangles) {
      return fmt::format("the mesh has {} triangles, allowed: {}", mesh->triangles.size(), kMostTriangles);
    }
  }
  const double radius_m = core::bounding_radius(shape);
  if (!(radius_m >= kSmallestRadius_m && radius_m <= kLargestRadius_m)) {
    return fmt::format("its radius is {:.4g} m, allowed: {} to {} m", radius_m, kSmallestRadius_m, kLargestRadius_m);
  }
  const double thickness_m = config::thickness_m(shape);
  if (!(thickness_m >= kThinnest_m)) {
    return fmt::format("it is {:.4g} m thin, allowed: {} m or more", thickness_m, kThinnest_m);
  }
  return {};
}

}  // namespace aurasim::steering
