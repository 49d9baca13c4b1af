#include "overseer/shape_json.h"

#include <array>
#include <utility>
#include <vector>

#include "physics/hull_triangles.h"

namespace aurasim::overseer {
namespace {

using Json = nlohmann::json;
using core::Vec3;

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

}  // namespace

Json shape_to_json(const core::Shape& shape) { return std::visit(ToJson{}, shape); }

}  // namespace aurasim::overseer
