#include "cut/saved_shapes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/limits.h"
#include "cut/cut_file.h"

namespace aurasim::cut {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestShape = std::size_t{64} << 20U;  // octets of JSON: twice those of the largest mesh

json to_json(const std::vector<core::Vec3>& points) {
  json all = json::array();
  for (const core::Vec3& p : points) all.insert(all.end(), {p.x(), p.y(), p.z()});
  return all;
}

std::vector<core::Vec3> points_of(const json& numbers) {
  std::vector<core::Vec3> points;
  const auto all = numbers.get<std::vector<double>>();
  if (all.empty() || all.size() % 3 != 0 || all.size() > 9 * core::limits::kMostTriangles)
    throw BadCut("damaged: a shape");
  if (!std::ranges::all_of(all, [](double x) { return std::isfinite(x); })) throw BadCut("damaged: a shape");
  for (std::size_t i = 0; i < all.size(); i += 3) points.emplace_back(all[i], all[i + 1], all[i + 2]);
  return points;
}

/// JSON of the shape that a mesh becomes: a hull, hulls in a compound, or triangles (config/meshes.h).
struct ToJson {
  json operator()(const core::ConvexHull& hull) const { return {{"points", to_json(hull.points)}}; }
  json operator()(const core::TriangleMesh& mesh) const {
    json triangles = json::array();
    for (const auto& t : mesh.triangles) triangles.insert(triangles.end(), {t[0], t[1], t[2]});
    return {{"points", to_json(mesh.points)}, {"triangles", std::move(triangles)}};
  }
  json operator()(const core::Compound& compound) const {
    json parts = json::array();
    for (const core::CompoundPart& part : compound.parts) {
      json one = std::visit(*this, part.shape);
      const core::Quat& q = part.pose.q_WB;
      one["p"] = {part.pose.p_WB.x(), part.pose.p_WB.y(), part.pose.p_WB.z()};
      one["q"] = {q.w(), q.x(), q.y(), q.z()};
      parts.push_back(std::move(one));
    }
    return {{"parts", std::move(parts)}};
  }
  /// A sphere replaces a mesh that was missing.
  json operator()(const core::Sphere& sphere) const { return {{"radius", sphere.radius}}; }
  template <class Other>
  json operator()(const Other&) const {
    throw std::logic_error("no mesh becomes such a shape");
  }
};

core::TriangleMesh triangles_of(const json& shape) {
  core::TriangleMesh mesh{points_of(shape.at("points")), {}};
  const json& all = shape.at("triangles");
  const auto is_index = [&](const json& i) {
    return i.is_number_unsigned() && i.get<std::uint64_t>() < mesh.points.size();
  };
  const bool fit = all.is_array() && !all.empty() && all.size() % 3 == 0 &&
                   all.size() <= 3 * core::limits::kMostTriangles && std::ranges::all_of(all, is_index);
  if (!fit) throw BadCut("damaged: a shape's triangles");
  const auto corners = all.get<std::vector<std::uint32_t>>();
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  }
  return mesh;
}

core::Compound compound_of(const json& parts) {
  core::Compound compound;
  for (const json& part : parts) {
    const auto p = part.at("p").get<std::array<double, 3>>();
    const auto q = part.at("q").get<std::array<double, 4>>();
    core::CompoundPart& made = compound.parts.emplace_back();
    made.shape = core::ConvexHull{points_of(part.at("points"))};
    made.pose = {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
    if (!made.pose.p_WB.allFinite() || !(std::abs(made.pose.q_WB.norm() - 1) < 1e-6)) throw BadCut("damaged: a shape");
  }
  if (compound.parts.empty()) throw BadCut("damaged: a shape without parts");
  return compound;
}

core::Shape shape_of(const json& shape) {
  if (shape.contains("parts")) return compound_of(shape.at("parts"));
  if (shape.contains("triangles")) return triangles_of(shape);
  if (!shape.contains("radius")) return core::ConvexHull{points_of(shape.at("points"))};
  const auto radius = shape.at("radius").get<double>();
  if (!(radius > 0 && radius <= core::limits::kLargestRadius_m)) throw BadCut("damaged: a shape's radius");
  return core::Sphere{radius};
}

}  // namespace

std::string encode_shape(const core::SavedShape& saved) {
  json shape = std::visit(ToJson{}, saved.shape);
  shape["mesh"] = saved.mesh.hash;
  shape["use"] = static_cast<int>(saved.mesh.use);
  return shape.dump();
}

core::SavedShape decode_shape(std::string_view text) {
  if (text.size() > kLongestShape) throw BadCut("damaged: a shape is too large");
  try {
    const json saved = json::parse(text);
    const json &hash = saved.at("mesh"), &use = saved.at("use");
    const bool fit = hash.is_number_unsigned() && use.is_number_unsigned() &&
                     use.get<std::uint64_t>() <= static_cast<std::uint64_t>(core::MeshUse::kTriangles);
    if (!fit) throw BadCut("damaged: which mesh a shape is of");
    return {{hash.get<std::uint64_t>(), static_cast<core::MeshUse>(use.get<int>())}, shape_of(saved)};
  } catch (const json::exception& error) {
    throw BadCut(fmt::format("damaged: a shape: {}", error.what()));
  }
}

}  // namespace aurasim::cut
