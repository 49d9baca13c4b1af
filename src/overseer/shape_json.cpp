#include "overseer/shape_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "physics/hull_triangles.h"

namespace aurasim::overseer {
namespace {

using Json = nlohmann::json;
using core::Vec3;

constexpr double kLargestNumber = 1e7;
constexpr std::size_t kMostPoints = 10'000;
constexpr std::size_t kMostParts = 256;

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Json to_json(const core::Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

Json mesh_to_json(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<double> numbers;
  for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
  std::vector<std::uint32_t> indices;
  for (const auto& t : triangles) indices.insert(indices.end(), t.begin(), t.end());
  return {{"kind", "mesh"}, {"points", std::move(numbers)}, {"triangles", std::move(indices)}};
}

struct ToJson {
  Json operator()(const core::Sphere& s) const { return {{"kind", "sphere"}, {"radius", s.radius}}; }
  Json operator()(const core::Box& s) const { return {{"kind", "box"}, {"half_extents", to_json(s.half_extents)}}; }
  Json operator()(const core::Capsule& s) const {
    return {{"kind", "capsule"}, {"radius", s.radius}, {"height", s.height}};
  }
  Json operator()(const core::Cylinder& s) const {
    return {{"kind", "cylinder"}, {"radius", s.radius}, {"height", s.height}};
  }
  Json operator()(const core::ConvexHull& s) const { return mesh_to_json(s.points, physics::hull_triangles(s.points)); }
  Json operator()(const core::TriangleMesh& s) const { return mesh_to_json(s.points, s.triangles); }
  Json operator()(const core::Plane& s) const {
    return {{"kind", "plane"}, {"normal", to_json(s.normal)}, {"offset", s.offset}};
  }
  Json operator()(const core::Compound& s) const {
    Json parts = Json::array();
    for (const core::CompoundPart& part : s.parts) {
      parts.push_back(
          {{"shape", std::visit(*this, part.shape)}, {"p", to_json(part.pose.p_WB)}, {"q", to_json(part.pose.q_WB)}});
    }
    return {{"kind", "compound"}, {"parts", std::move(parts)}};
  }
};

double length_in(const Json& json, const char* name) {
  const double length = number_of(field(json, name), name);
  if (!(length >= 1e-3 && length <= 1e4)) throw BadField(fmt::format("{} is not from 0.001 to 10000", name));
  return length;
}

core::TriangleMesh read_mesh(const Json& json) {
  core::TriangleMesh mesh;
  const Json& points = field(json, "points");
  if (!points.is_array() || points.size() % 3 != 0 || points.size() < 12 || points.size() / 3 > kMostPoints)
    throw BadField(fmt::format("points is not a list of 4 to {} times x, y, z", kMostPoints));
  for (std::size_t i = 0; i < points.size(); i += 3) {
    mesh.points.emplace_back(number_of(points[i], "points"), number_of(points[i + 1], "points"),
                             number_of(points[i + 2], "points"));
  }
  const Json& triangles = field(json, "triangles");
  if (!triangles.is_array() || triangles.size() % 3 != 0 || triangles.empty())
    throw BadField("triangles is not a list of triples");
  const auto last = static_cast<std::int64_t>(mesh.points.size()) - 1;
  const auto index = [&](std::size_t i) {
    return static_cast<std::uint32_t>(whole_of(triangles[i], "triangles", 0, last));
  };
  for (std::size_t i = 0; i < triangles.size(); i += 3)
    mesh.triangles.push_back({index(i), index(i + 1), index(i + 2)});
  return mesh;
}

core::Plane read_plane(const Json& json) {
  core::Plane plane;
  plane.normal = vector_of(field(json, "normal"), "normal");
  if (plane.normal.norm() < 1e-6) throw BadField("normal has no direction");
  plane.normal.normalize();
  plane.offset = number_of(field(json, "offset"), "offset");
  return plane;
}

core::ConvexShape read_part(const Json& json) {
  core::Shape shape = read_shape(json);
  if (auto* mesh = std::get_if<core::TriangleMesh>(&shape)) return core::ConvexHull{std::move(mesh->points)};
  return std::visit(
      [](auto&& part) -> core::ConvexShape {
        if constexpr (std::is_constructible_v<core::ConvexShape, decltype(part)>) return part;
        throw BadField("a part of a compound is not convex");
      },
      std::move(shape));
}

core::Compound read_compound(const Json& json) {
  const Json& parts = field(json, "parts");
  if (!parts.is_array() || parts.empty() || parts.size() > kMostParts)
    throw BadField(fmt::format("parts is not a list of 1 to {}", kMostParts));
  core::Compound compound;
  for (const Json& part : parts) {
    if (!part.is_object()) throw BadField("a part is not an object");
    only(part, {"shape", "p", "q"});
    const Json& shape = field(part, "shape");
    if (shape.is_object() && shape.contains("parts")) throw BadField("a compound within a compound");
    compound.parts.push_back({read_part(shape), pose_in(part)});
  }
  return compound;
}

}  // namespace

Json shape_to_json(const core::Shape& shape) { return std::visit(ToJson{}, shape); }

const Json& field(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end()) throw BadField(fmt::format("{} is missing", name));
  return *found;
}

void only(const Json& json, const std::vector<const char*>& names) {
  for (const auto& [key, value] : json.items()) {
    if (std::none_of(names.begin(), names.end(), [&](const char* name) { return key == name; }))
      throw BadField(fmt::format("field '{}' is unknown", key.substr(0, 50)));
  }
}

double number_of(const Json& json, const char* name) {
  if (!json.is_number()) throw BadField(fmt::format("{} is not a number", name));
  const auto number = json.get<double>();
  if (!std::isfinite(number) || std::abs(number) > kLargestNumber)
    throw BadField(fmt::format("{} is beyond {:.0e}", name, kLargestNumber));
  return number;
}

std::int64_t whole_of(const Json& json, const char* name, std::int64_t low, std::int64_t high) {
  const bool fits = json.is_number_integer() &&
                    !(json.is_number_unsigned() && json.get<std::uint64_t>() > static_cast<std::uint64_t>(high));
  if (!fits || json.get<std::int64_t>() < low || json.get<std::int64_t>() > high)
    throw BadField(fmt::format("{} is not a whole number from {} to {}", name, low, high));
  return json.get<std::int64_t>();
}

std::string text_of(const Json& json, const char* name, std::size_t longest) {
  if (!json.is_string()) throw BadField(fmt::format("{} is not a text", name));
  auto text = json.get<std::string>();
  if (text.size() > longest) throw BadField(fmt::format("{} is longer than {} bytes", name, longest));
  return text;
}

Vec3 vector_of(const Json& json, const char* name) {
  if (!json.is_array() || json.size() != 3) throw BadField(fmt::format("{} is not [x, y, z]", name));
  return {number_of(json[0], name), number_of(json[1], name), number_of(json[2], name)};
}

core::Pose pose_in(const Json& json) {
  core::Pose pose;
  pose.p_WB = vector_of(field(json, "p"), "p");
  if (!json.contains("q")) return pose;
  const Json& q = json.at("q");
  if (!q.is_array() || q.size() != 4) throw BadField("q is not [w, x, y, z]");
  pose.q_WB = core::Quat(number_of(q[0], "q"), number_of(q[1], "q"), number_of(q[2], "q"), number_of(q[3], "q"));
  const double length = pose.q_WB.norm();
  if (!(std::abs(length - 1) < 0.01)) throw BadField("q does not have length 1");
  pose.q_WB.normalize();
  return pose;
}

core::Shape read_shape(const Json& json) {
  if (!json.is_object()) throw BadField("shape is not an object");
  const std::string kind = text_of(field(json, "kind"), "kind", 20);
  const auto fields = [&](std::vector<const char*> names) {
    names.insert(names.end(), {"kind", "name"});
    only(json, names);
  };
  if (kind == "sphere") {
    fields({"radius"});
    return core::Sphere{length_in(json, "radius")};
  }
  if (kind == "box") {
    fields({"half_extents"});
    const Vec3 half = vector_of(field(json, "half_extents"), "half_extents");
    if (!(half.minCoeff() >= 1e-3 && half.maxCoeff() <= 1e4))
      throw BadField("half_extents are not from 0.001 to 10000");
    return core::Box{half};
  }
  if (kind == "capsule" || kind == "cylinder") {
    fields({"radius", "height"});
    const double radius = length_in(json, "radius"), height = length_in(json, "height");
    if (kind == "capsule") return core::Capsule{radius, height};
    return core::Cylinder{radius, height};
  }
  if (kind == "mesh") {
    fields({"points", "triangles"});
    return read_mesh(json);
  }
  if (kind == "compound") {
    fields({"parts"});
    return read_compound(json);
  }
  if (kind == "plane") {
    fields({"normal", "offset"});
    return read_plane(json);
  }
  throw BadField(fmt::format("shape kind '{}' is unknown", kind));
}

}  // namespace aurasim::overseer
