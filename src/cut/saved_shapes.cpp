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

/// What a mesh becomes: a hull, hulls in a compound, or triangles (config/meshes.h).
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
  /// A ball stands in for a mesh that was not there.
  json operator()(const core::Sphere& sphere) const { return {{"radius", sphere.radius}}; }
  template <class Other>
  json operator()(const Other&) const {
    throw std::logic_error("no mesh becomes such a shape");
  }
};

core::TriangleMesh triangles_of(const json& shape) {
  core::TriangleMesh mesh{points_of(shape.at("points")), {}};
  const auto all = shape.at("triangles").get<std::vector<std::uint32_t>>();
  const bool fit = !all.empty() && all.size() % 3 == 0 && all.size() <= 3 * core::limits::kMostTriangles &&
                   std::ranges::all_of(all, [&](std::uint32_t i) { return i < mesh.points.size(); });
  if (!fit) throw BadCut("damaged: a shape's triangles");
  for (std::size_t i = 0; i < all.size(); i += 3) mesh.triangles.push_back({all[i], all[i + 1], all[i + 2]});
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

std::vector<std::uint8_t> encode_shapes(const std::vector<core::SavedShape>& shapes) {
  json all = json::array();
  for (const core::SavedShape& saved : shapes) {
    json shape = std::visit(ToJson{}, saved.shape);
    shape["mesh"] = saved.mesh.hash;
    shape["use"] = static_cast<int>(saved.mesh.use);
    all.push_back(std::move(shape));
  }
  return json::to_cbor(all);
}

std::vector<core::SavedShape> decode_shapes(std::string_view bytes) {
  std::vector<core::SavedShape> shapes;
  try {
    for (const json& saved : json::from_cbor(bytes.begin(), bytes.end())) {
      const int use = saved.at("use").get<int>();
      if (use < 0 || use > static_cast<int>(core::MeshUse::kTriangles)) throw BadCut("damaged: a shape's use");
      const core::MeshRef mesh{saved.at("mesh").get<std::uint64_t>(), static_cast<core::MeshUse>(use)};
      shapes.push_back({mesh, shape_of(saved)});
    }
  } catch (const json::exception& error) {
    throw BadCut(fmt::format("damaged: its shapes: {}", error.what()));
  }
  return shapes;
}

}  // namespace aurasim::cut
