// Formations with joints.
#include <algorithm>
#include <array>

#include "lab/scenes/formations.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

Json with_axis(const char* kind, const Vec3& axis) { return {{kind, {{"axis", json_vec3(axis)}}}}; }

Json motor_of(double speed_rad_s, double max_impulse) {
  return {{"speed", rounded(speed_rad_s)}, {"max_impulse", rounded(max_impulse)}};
}

double either_way(double low, double high, Chance& chance) {
  const double value = chance.between(low, high);
  return chance.below(2) == 0 ? value : -value;
}

/// Along x, at a height; at times hung up at one end or both.
Formation chain(const Makings& makings, Chance& chance) {
  Formation formation;
  const std::size_t kind = makings.any_kind(chance);
  const double apart = 2.05 * makings.radius_m(kind), z = makings.radius_m(kind) + chance.between(0.05, 2.5);
  const std::size_t count = 3 + chance.below(6);
  const bool fixed = chance.below(4) == 0;
  for (std::size_t i = 0; i < count; ++i) {
    Piece& piece = formation.pieces.emplace_back();
    piece.kind = kind;
    piece.p = {(static_cast<double>(i) - 0.5 * static_cast<double>(count - 1)) * apart, 0, z};
    const Json joint = fixed && i % 2 == 1 ? Json{{"fixed", Json::object()}} : Json{{"ball", Json::object()}};
    if (i > 0) formation.links.push_back({joint, {i, i - 1}, piece.p - Vec3(0.5 * apart, 0, 0)});
  }
  const Json ball = {{"ball", Json::object()}};
  const Vec3 end(0.5 * apart, 0, 0);
  if (chance.below(3) == 0) formation.links.push_back({ball, {0}, formation.pieces.front().p - end});
  if (chance.below(3) == 0) formation.links.push_back({ball, {count - 1}, formation.pieces.back().p + end});
  formation.pieces.back().v.y() = either_way(0, 0.6 * makings.speed_m_s, chance);
  if (chance.below(3) == 0) formation.links[0].joint["break_impulse"] = rounded(chance.between(0.5, 20));
  return formation;
}

/// A bar that turns about one end, or its middle, and sweeps what is there.
Formation mill(const Makings& makings, Chance& chance) {
  Formation formation;
  Piece& piece = formation.pieces.emplace_back();
  piece.kind = Kinds::kBar;
  piece.p.z() = makings.half_height_m(Kinds::kBar) + chance.between(0.02, 0.6);
  const bool door = chance.below(2) == 0;
  Json joint = with_axis("hinge", Vec3::UnitZ());
  const double mass = makings.kind(piece).mass_kg;
  if (!door || chance.below(2) == 0) {
    const double speed = either_way(1, 12, chance);
    joint["hinge"]["motor"] = motor_of(speed, mass * chance.between(0.5, 5));
  } else {
    piece.spin.z() = either_way(1, 10, chance);
  }
  if (door) joint["hinge"]["limits_deg"] = {-rounded(chance.between(10, 120)), rounded(chance.between(10, 120))};
  formation.links.push_back({joint, {0}, piece.p - Vec3(door ? 0.8 * makings.radius_m(Kinds::kBar) : 0, 0, 0)});
  return formation;
}

/// A body on an arm about a place: again and again over the same borders.
Formation orbit(const Makings& makings, Chance& chance) {
  Formation formation;
  Piece& piece = formation.pieces.emplace_back();
  piece.kind = makings.any_kind(chance);
  const double arm = makings.radius_m(piece.kind) + chance.between(0.2, 0.4) * makings.region_m;
  piece.p = {arm, 0, makings.radius_m(piece.kind) + chance.between(0.05, 0.8)};
  const double speed = std::min(12.0, chance.between(0.2, 0.7) * makings.speed_m_s / arm);
  piece.v = {0, arm * speed, 0};
  piece.spin.z() = speed;
  Json joint = with_axis("hinge", Vec3::UnitZ());
  joint["hinge"]["motor"] = motor_of(speed, makings.kind(piece).mass_kg * arm * arm);
  formation.links.push_back({joint, {0}, Vec3(0, 0, piece.p.z())});
  return formation;
}

Formation pendulum(const Makings& makings, Chance& chance) {
  Formation formation;
  Piece& piece = formation.pieces.emplace_back();
  piece.kind = makings.any_kind(chance);
  const double length = makings.radius_m(piece.kind) + chance.between(0.5, 2.5);
  piece.p = {0, 0, makings.radius_m(piece.kind) + chance.between(0.03, 0.3)};
  piece.v = {either_way(0.1, 0.6, chance) * makings.speed_m_s, 0, 0};
  formation.links.push_back({{{"ball", Json::object()}}, {0}, piece.p + Vec3(0, 0, length)});
  return formation;
}

/// A body on a rail, held by the world or by another body.
Formation slide(const Makings& makings, Chance& chance) {
  Formation formation;
  const Vec3 axis = Vec3::Unit(static_cast<int>(chance.below(3)));
  Piece piece;
  piece.kind = makings.any_kind(chance);
  piece.p.z() = makings.radius_m(piece.kind) + chance.between(0.02, 1);
  piece.v = either_way(0, 0.5 * makings.speed_m_s, chance) * axis;
  formation.pieces.push_back(piece);
  Json joint = with_axis("slider", axis);
  if (chance.below(3) != 0) joint["slider"]["limits"] = {-rounded(chance.between(0.1, 2)), 1};
  Link link{joint, {0}, piece.p};
  if (chance.below(2) == 0) {
    piece.kind = makings.any_kind(chance);
    const double apart = 1.02 * (makings.radius_m(piece.kind) + makings.radius_m(formation.pieces[0].kind));
    piece.p.x() += apart;
    piece.v = Vec3::Zero();
    formation.pieces.push_back(piece);
    link.pieces.push_back(1);
    link.p.x() += 0.5 * apart;
  }
  formation.links.push_back(link);
  return formation;
}

/// Two bodies, or one and the world, between springs along and about some axes.
Formation sprung(const Makings& makings, Chance& chance) {
  Formation formation;
  const std::size_t kind = makings.any_kind(chance);
  const double mass = makings.kinds.all[kind].mass_kg, apart = 2.1 * makings.radius_m(kind);
  const std::size_t count = 1 + chance.below(2);
  for (std::size_t i = 0; i < count; ++i) {
    Piece& piece = formation.pieces.emplace_back();
    piece.kind = kind;
    piece.p = {static_cast<double>(i) * apart, 0, makings.radius_m(kind) + chance.between(0.1, 1.5)};
    piece.v.y() = either_way(0, 0.4 * makings.speed_m_s, chance);
  }
  Json axes = Json::object();
  for (const char* name : {"x", "y", "z"}) {
    if (chance.below(3) == 0) continue;
    axes[name] = {{"stiffness", rounded(mass * chance.between(1, 200))},
                  {"damping", rounded(mass * chance.between(0, 5))}};
    if (chance.below(3) == 0) axes[name]["limits"] = {-rounded(chance.between(0.1, 1)), 0.5};
  }
  if (chance.below(2) == 0) axes["rz"] = Json::object();
  if (chance.below(3) == 0) axes["rx"] = {{"limits_deg", {-40, 40}}, {"stiffness", rounded(mass)}};
  formation.links.push_back({{{"spring", axes}}, {0}, formation.pieces[0].p});
  if (count == 2) formation.links.back().pieces.push_back(1);
  return formation;
}

/// Four wheels, two with motors, under a body; drives along x.
Formation cart(const Makings& makings, Chance& chance) {
  Formation formation;
  const double wheel_r = makings.half_height_m(Kinds::kBar);  // of the body, which lies above the wheels
  const double radius = makings.radius_m(Kinds::kWheel), bar = makings.radius_m(Kinds::kBar);
  Piece& body = formation.pieces.emplace_back();
  body.kind = Kinds::kBar;
  body.p.z() = radius + wheel_r + 0.01;
  const double speed = either_way(2, std::max(2.5, std::min(30.0, 0.5 * makings.speed_m_s / radius)), chance);
  for (const double x : {-0.7, 0.7}) {
    for (const double y : {-1.0, 1.0}) {
      Piece& wheel = formation.pieces.emplace_back();
      wheel.kind = Kinds::kWheel;
      wheel.p = {x * bar, y * (radius + wheel_r), radius + 0.01};
      wheel.rpy_deg.x() = 90;
      Json joint = with_axis("hinge", Vec3::UnitY());
      if (x > 0) joint["hinge"]["motor"] = motor_of(speed, makings.kind(wheel).mass_kg * 0.5);
      formation.links.push_back({joint, {formation.pieces.size() - 1, 0}, wheel.p});
    }
  }
  return formation;
}

/// A palm with two fingers: the second goes where the first does, and at times a wheel turns with them as on a rack. At
/// times the first has a stiff drive of its own, at times it swings on a spring and breaks off.
Formation gripper(const Makings& makings, Chance& chance) {
  Formation formation;
  const std::size_t kind = makings.any_kind(chance);
  const double apart = 2.1 * makings.radius_m(kind), mass = makings.kinds.all[kind].mass_kg;
  const Vec3 velocity = {either_way(0, 0.5 * makings.speed_m_s, chance), 0, 0};
  for (const double y : {0.0, apart, -apart}) {
    Piece& piece = formation.pieces.emplace_back();
    piece.kind = kind;
    piece.p = {0, y, makings.radius_m(kind) + 0.3};
    piece.v = velocity;
  }
  Json first = with_axis("slider", Vec3::UnitY()), second = with_axis("slider", -Vec3::UnitY());
  first["slider"]["limits"] = {-rounded(0.02 * apart), rounded(apart)};
  if (chance.below(2) == 0) {
    first["slider"]["drive"] = {{"position", rounded(chance.between(0, apart))},
                                {"stiffness", rounded(mass * chance.between(20, 2000))},
                                {"damping", rounded(mass * chance.between(1, 40))}};
  } else {
    first["slider"]["stiffness"] = rounded(mass * chance.between(5, 100));
    first["slider"]["rest"] = rounded(chance.between(0, apart));
    if (chance.below(2) == 0) first["break_impulse"] = rounded(mass * chance.between(0.1, 3));
  }
  const auto gear = [&](const char* of, double inertia, Json& joint) {
    joint[of]["drive"] = {{"stiffness", rounded(inertia * 3e4)},
                          {"damping", rounded(inertia * 300)},
                          {"max_effort", rounded(mass * chance.between(10, 1000))}};
    joint[of]["follows"] = {{"ratio", rounded(either_way(0.3, 2, chance))}};
  };
  gear("slider", mass, second);
  formation.links.push_back({first, {1, 0}, formation.pieces[1].p});
  formation.links.push_back({second, {2, 0}, formation.pieces[2].p, 0});
  if (chance.below(2) == 0) {
    Piece wheel = formation.pieces[0];
    wheel.p.z() += apart;
    formation.pieces.push_back(wheel);
    Json turning = with_axis("hinge", Vec3::UnitX());
    gear("hinge", mass * makings.radius_m(kind) * makings.radius_m(kind), turning);
    formation.links.push_back({turning, {3, 0}, wheel.p, chance.below(2)});
  }
  return formation;
}

/// As a quarter turn about z does it.
Vec3 quarter_turn(const Vec3& v) { return {-v.y(), v.x(), v.z()}; }

void turn_axis(Json& joint) {
  Json& settings = joint.begin().value();
  if (!settings.contains("axis")) return;
  const Json axis = settings["axis"];
  settings["axis"] = {-axis[1].get<double>(), axis[0], axis[2]};
}

}  // namespace

Formation random_mechanism(const Makings& makings, Chance& chance) {
  using Make = Formation (*)(const Makings&, Chance&);
  constexpr std::array<Make, 9> kMakers = {chain, chain, mill, orbit, pendulum, slide, sprung, cart, gripper};
  return kMakers[chance.below(kMakers.size())](makings, chance);
}

Formation turned(Formation formation, std::uint32_t quarters) {
  for (; quarters > 0; --quarters) {
    for (Piece& piece : formation.pieces) {
      piece.p = quarter_turn(piece.p);
      piece.v = quarter_turn(piece.v);
      piece.spin = quarter_turn(piece.spin);
      piece.rpy_deg.z() += 90;
    }
    for (Link& link : formation.links) {
      link.p = quarter_turn(link.p);
      turn_axis(link.joint);
    }
  }
  return formation;
}

}  // namespace aurasim::lab
