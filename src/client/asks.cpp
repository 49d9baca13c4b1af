#include "client/asks.h"

#include <cmath>
#include <filesystem>

namespace aurasim::client {
namespace {

using nlohmann::json;

json shape_json(const Shape& shape, bool is_body) {
  switch (shape.kind) {
    case Shape::Kind::kNone:
      return nullptr;
    case Shape::Kind::kSphere:
      return {{"kind", "sphere"}, {"radius", shape.radius_m}};
    case Shape::Kind::kBox:
      return {{"kind", "box"}, {"size", shape.size}};
    case Shape::Kind::kCapsule:
      return {{"kind", "capsule"}, {"radius", shape.radius_m}, {"height", shape.height_m}};
    case Shape::Kind::kMesh: {
      // Absolute, because this program may have changed its folder since the agent was started.
      json mesh = {{"kind", "mesh"}, {"file", std::filesystem::absolute(shape.file).string()}};
      if (is_body && shape.in_parts) mesh["as"] = "decomposition";
      return mesh;
    }
  }
  return nullptr;
}

}  // namespace

json ask_json(const char* kind) { return {{"kind", kind}}; }

json spawn_json(const NewBody& body) {
  json ask = {{"kind", "spawn"},
              {"p", body.position},
              {"q", body.rotation},
              {"v", body.linear_velocity},
              {"w", body.angular_velocity}};
  if (!body.prototype.empty()) {
    ask["prototype"] = body.prototype;
  } else {
    ask["shape"] = shape_json(body.shape, true);
    ask["mass"] = body.mass_kg;
  }
  return ask;
}

json static_json(const NewStatic& fixed) {
  return {{"kind", "static"}, {"shape", shape_json(fixed.shape, false)}, {"p", fixed.position}, {"q", fixed.rotation}};
}

json move_json(const std::variant<std::uint32_t, std::string>& fixed, const Vec3& position, const Quaternion& rotation,
               double duration) {
  json ask = {{"kind", "move"}, {"p", position}, {"q", rotation}, {"seconds", duration}};
  std::visit([&ask](const auto& named) { ask["static"] = named; }, fixed);
  return ask;
}

json impulse_json(std::uint64_t body, const Vec3& impulse, const std::optional<Vec3>& point) {
  json ask = {{"kind", "impulse"}, {"body", body}, {"J", impulse}};
  if (point) ask["p"] = *point;
  return ask;
}

json velocity_json(std::uint64_t body, const Vec3& linear, const std::optional<Vec3>& angular) {
  json ask = {{"kind", "velocity"}, {"body", body}, {"v", linear}};
  if (angular) ask["w"] = *angular;
  return ask;
}

json regions_json(const std::vector<std::array<double, 4>>& boxes) {
  json ask = {{"kind", "regions"}, {"boxes", json::array()}};
  for (const auto& box : boxes) {
    json& sides = ask["boxes"].emplace_back();
    for (const double side : box) sides.push_back(std::isfinite(side) ? json(side) : json(nullptr));
  }
  return ask;
}

}  // namespace aurasim::client
