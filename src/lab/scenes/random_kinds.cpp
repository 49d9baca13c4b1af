#include "lab/scenes/random_kinds.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace aurasim::lab {
namespace {

using core::Vec3;

double nearly(double value, Chance& chance) { return rounded(value * chance.between(0.6, 1.4)); }

Kind sphere_kind(double half_m, Chance& chance) {
  const double radius = nearly(half_m, chance);
  return {"sphere", {{"sphere", {{"radius", radius}}}}, radius, radius};
}

Kind box_of(const Vec3& size) {
  return {"box", {{"box", {{"size", json_vec3(size)}}}}, 0.5 * size.norm(), 0.5 * size.z()};
}

Kind box_kind(double half_m, Chance& chance) {
  const double x = nearly(2 * half_m, chance), y = nearly(2 * half_m, chance);
  return box_of({x, y, nearly(2 * half_m, chance)});
}

Kind capsule_kind(double half_m, Chance& chance) {
  const double radius = nearly(0.5 * half_m, chance);
  const double height = nearly(1.2 * half_m, chance);
  const double half = 0.5 * height + radius;
  return {"capsule", {{"capsule", {{"radius", radius}, {"height", height}}}}, half, half};
}

Kind cylinder_of(double radius_m, double height_m) {
  return {"cylinder",
          {{"cylinder", {{"radius", radius_m}, {"height", height_m}}}},
          std::sqrt(radius_m * radius_m + 0.25 * height_m * height_m),
          0.5 * height_m};
}

Kind cylinder_kind(double half_m, Chance& chance) {
  const double radius = nearly(0.8 * half_m, chance);
  return cylinder_of(radius, nearly(1.4 * half_m, chance));
}

/// The corners of an uneven octahedron, so that it has a volume, and more points.
Kind hull_kind(double half_m, Chance& chance) {
  Json points = Json::array();
  double radius = 0, lowest = 0;
  const auto add = [&](const Vec3& p) {
    points.push_back(json_vec3(p));
    radius = std::max(radius, p.norm() + 1e-4);
    lowest = std::min(lowest, p.z());
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) add(sign * nearly(half_m, chance) * Vec3::Unit(axis));
  }
  for (std::uint32_t more = chance.below(7); more > 0; --more) {
    const double x = chance.between(-half_m, half_m), y = chance.between(-half_m, half_m);
    add({x, y, chance.between(-half_m, half_m)});
  }
  return {"hull", {{"convex_hull", {{"points", points}}}}, radius, -lowest};
}

constexpr std::uint32_t kMaterialCount = 4;

std::string name_of_material(std::uint32_t i) { return fmt::format("m{}", i); }

/// A part is small and stands off the origin.
Json compound_part(double half_m, const Vec3& p, double& radius_m, Chance& chance) {
  using MakePart = Kind (*)(double, Chance&);
  constexpr std::array<MakePart, 5> kParts = {sphere_kind, box_kind, capsule_kind, cylinder_kind, hull_kind};
  const Kind part = kParts[chance.below(kParts.size())](half_m, chance);
  radius_m = std::max(radius_m, p.norm() + part.radius_m + 1e-4);
  Json json = part.shape;
  json["position"] = json_vec3(p);
  if (chance.below(3) == 0) json["material"] = name_of_material(chance.below(kMaterialCount));
  if (chance.below(2) == 0) json["orientation"] = {{"rpy_deg", {rounded(chance.between(-180, 180)), 0, 90}}};
  return json;
}

Kind compound_kind(double half_m, Chance& chance) {
  Json parts = Json::array();
  double radius = 0;
  const double arm = chance.between(0.6, 1.1) * half_m;
  for (const double sign : {-1.0, 1.0}) {
    parts.push_back(compound_part(0.6 * half_m, {sign * arm, 0, 0}, radius, chance));
  }
  if (chance.below(2) == 0) parts.push_back(compound_part(0.5 * half_m, {0, arm, 0}, radius, chance));
  return {"compound", {{"compound", {{"parts", parts}}}}, radius, radius};
}

using MakeKind = Kind (*)(double, Chance&);
constexpr std::array<MakeKind, 6> kMakers = {sphere_kind,   box_kind,  capsule_kind,
                                             cylinder_kind, hull_kind, compound_kind};

Kind bar_kind(double half_m, Chance& chance) {
  return box_of({nearly(5 * half_m, chance), nearly(0.5 * half_m, chance), nearly(0.5 * half_m, chance)});
}

/// 0.05 to 50 kg, each order of magnitude as likely.
double random_mass_kg(Chance& chance) {
  return std::max(0.05, std::round(1e3 * 0.05 * std::pow(1000.0, chance.between(0, 1))) / 1e3);
}

Json random_material(Chance& chance) {
  constexpr std::array kRestitution = {0.0, 0.0, 0.3, 0.6, 0.9, 1.0};
  Json material = {{"friction", rounded(chance.between(0, 1.3))},
                   {"restitution", kRestitution[chance.below(kRestitution.size())]}};
  if (chance.below(3) == 0) material["rolling_friction"] = rounded(chance.between(0, 0.05));
  if (chance.below(4) == 0) material["spinning_friction"] = rounded(chance.between(0, 0.05));
  if (chance.below(3) == 0) material["linear_damping"] = rounded(chance.between(0, 0.4));
  if (chance.below(3) == 0) material["angular_damping"] = rounded(chance.between(0, 0.6));
  return material;
}

}  // namespace

double Kinds::largest_radius_m() const {
  double radius = 0;
  for (const Kind& kind : all) radius = std::max(radius, kind.radius_m);
  return radius;
}

Kinds random_kinds(double half_m, double largest_m, Chance& chance) {
  Kinds kinds;
  kinds.all.push_back(bar_kind(half_m, chance));
  kinds.all.push_back(box_of({nearly(0.3 * half_m, chance), nearly(1.5 * half_m, chance), nearly(3 * half_m, chance)}));
  const double wheel_m = nearly(0.7 * half_m, chance);
  kinds.all.push_back(cylinder_of(wheel_m, nearly(0.5 * half_m, chance)));
  const std::uint32_t first = chance.below(kMakers.size());
  const std::uint32_t count = 3 + chance.below(4);
  for (std::uint32_t i = 0; i < count; ++i) {
    kinds.all.push_back(kMakers[(first + i) % kMakers.size()](half_m, chance));
  }
  if (largest_m > 0) {
    Kind large = kMakers[chance.below(kMakers.size())](0.5 * largest_m, chance);
    kinds.all.push_back(large);
  }
  for (std::size_t i = 0; i < kinds.all.size(); ++i) {
    kinds.all[i].name = fmt::format("{}_{}", kinds.all[i].name, i);
    kinds.all[i].mass_kg = random_mass_kg(chance);
  }
  return kinds;
}

void add_kinds(const Kinds& kinds, Json& scene, Chance& chance) {
  for (std::uint32_t i = 0; i < kMaterialCount; ++i) scene["materials"][name_of_material(i)] = random_material(chance);
  scene["materials"]["ground"] = random_material(chance);
  for (const Kind& kind : kinds.all) {
    scene["shapes"][kind.name] = kind.shape;
    Json prototype = {{"shape", kind.name}, {"mass", kind.mass_kg}};
    prototype["material"] = name_of_material(chance.below(kMaterialCount));
    if (chance.below(5) == 0) prototype["can_sleep"] = false;
    scene["prototypes"][kind.name] = prototype;
  }
}

}  // namespace aurasim::lab
