#include "lab/scenes/random_world.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "lab/scenes/formations.h"
#include "lab/scenes/random_orders.h"
#include "lab/scenes/random_programs.h"
#include "physics/region_world.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

constexpr std::size_t kMostBodies = 70;
constexpr double kSmallestBlock_m = 4;  ///< the largest has 16 times its side
constexpr const char* kUsualSolver = "soft_step";
constexpr const char* kOtherSolver = "sequential_impulse";
constexpr std::uint64_t kBlocksOf = 0xD1B54A32D192ED03;    ///< separates the random numbers of blocks from the rest
constexpr std::uint64_t kProgramsOf = 0x9E3779B97F4A7C15;  ///< separates the random numbers of programs from the rest

/// Parameters that determine the rest of a world.
struct Dials {
  double step_hz = 60;
  int lookahead = 1;
  int substeps = 4;
  double promised_m_s = 32;  ///< tolerances.speed
  double speed_m_s = 32;     ///< that bodies may start with; in some worlds more than is promised
  double half_m = 0.2;       ///< of a usual body
  const char* solver = kUsualSolver;
};

Dials random_dials(Chance& chance) {
  constexpr std::array kRates = {60.0, 60.0, 60.0, 60.0, 50.0, 120.0};
  constexpr std::array kSpeeds = {10.0, 16.0, 20.0, 32.0};
  constexpr std::array kSolvers = {kUsualSolver, kUsualSolver, kUsualSolver, kUsualSolver,
                                   kOtherSolver, kOtherSolver, kOtherSolver, kOtherSolver};
  Dials dials;
  dials.step_hz = kRates[chance.below(kRates.size())];
  dials.lookahead = 1 + static_cast<int>(chance.below(3));
  dials.substeps = 1 + static_cast<int>(chance.below(4));
  dials.promised_m_s = kSpeeds[chance.below(kSpeeds.size())];
  dials.speed_m_s = dials.promised_m_s * (chance.below(8) == 0 ? 1.6 : 0.9);
  dials.half_m = chance.between(0.1, 0.4);
  dials.solver = kSolvers[chance.below(kSolvers.size())];
  return dials;
}

/// Width that a region needs for points at the promised speed, metres (docs/design.md, "The aura and its reach"),
/// rounded up.
double way_m(const Dials& dials) { return 3 * dials.promised_m_s * dials.lookahead / dials.step_hz + 0.1; }

Json launch_of(const Dials& dials, const Json& regions, Chance& chance) {
  constexpr std::array kIterations = {4, 10, 10, 20};
  Json physics = {{"solver", dials.solver},
                  {"iterations", kIterations[chance.below(kIterations.size())]},
                  {"friction_directions", 1 + chance.below(2)}};
  if (chance.below(3) == 0) physics["erp"] = rounded(chance.between(0.05, 0.6));
  if (chance.below(5) == 0) physics["continuous"] = true;
  return {{"scene", "scene.yaml"},
          {"regions", regions},
          {"time",
           {{"step_hz", dials.step_hz},
            {"substeps", dials.substeps},
            {"sync", "deterministic"},
            {"lookahead", dials.lookahead},
            {"pace", "none"}}},
          {"tolerances", {{"speed", dials.promised_m_s}}},
          {"physics", physics}};
}

/// Puts formations where regions meet, each where there is room for it.
class Builder {
 public:
  Builder(const Makings& makings, const RandomLayout& layout, Json& scene, Chance& chance)
      : makings_(makings), layout_(layout), scene_(scene), chance_(chance) {
    scene_["bodies"] = Json::array();
    scene_["joints"] = Json::array();
  }

  std::size_t bodies() const { return taken_.size(); }

  void put(const Formation& formation, bool at_a_spot) {
    constexpr int kTries = 8;
    const Formation as_turned = turned(formation, chance_.below(4));
    for (int i = 0; i < kTries; ++i) {
      const Vec3 place = at_a_spot ? near_a_spot() : anywhere();
      if (!has_room(as_turned, place)) continue;
      add(as_turned, place);
      return;
    }
  }

 private:
  struct Taken {
    Vec3 p;
    double radius_m;
  };

  /// A place near a spot where regions meet, often exactly on it.
  Vec3 near_a_spot() {
    const Vec3 spot = layout_.spots[chance_.below(static_cast<std::uint32_t>(layout_.spots.size()))];
    if (chance_.below(3) == 0) return spot;
    const Vec3 aside = {chance_.between(-0.2, 0.2), chance_.between(-0.2, 0.2), 0};
    return spot + makings_.region_m * aside;
  }
  Vec3 anywhere() { return {chance_.between(-1, 1) * layout_.half_x_m, chance_.between(-1, 1) * layout_.half_y_m, 0}; }

  bool has_room(const Formation& formation, const Vec3& place) const {
    return std::ranges::all_of(formation.pieces, [&](const Piece& piece) {
      const double radius = makings_.kind(piece).radius_m;
      return std::ranges::none_of(
          taken_, [&](const Taken& taken) { return (piece.p + place - taken.p).norm() < radius + taken.radius_m; });
    });
  }

  void add(const Formation& formation, const Vec3& place) {
    const std::size_t first = taken_.size();
    for (const Piece& piece : formation.pieces) {
      const std::size_t id = taken_.size();
      Json body = {{"name", name_of_body(id)}, {"id", id}, {"prototype", makings_.kind(piece).name}};
      body["position"] = json_vec3(piece.p + place);
      if (!piece.rpy_deg.isZero()) body["orientation"] = {{"rpy_deg", json_vec3(piece.rpy_deg)}};
      if (!piece.v.isZero()) body["velocity"] = json_vec3(piece.v);
      if (!piece.spin.isZero()) body["spin"] = json_vec3(piece.spin);
      scene_["bodies"].push_back(std::move(body));
      taken_.push_back({piece.p + place, makings_.kind(piece).radius_m});
    }
    const std::size_t first_joint = scene_["joints"].size();
    for (const Link& link : formation.links) {
      Json joint = link.joint;
      if (link.leader) {
        Json& kind = joint[joint.contains("hinge") ? "hinge" : "slider"];
        kind["follows"]["joint"] = name_of_joint(first_joint + *link.leader);
      }
      joint["name"] = name_of_joint(scene_["joints"].size());
      joint["bodies"] = Json::array();
      for (const std::size_t piece : link.pieces) joint["bodies"].push_back(name_of_body(first + piece));
      joint["position"] = json_vec3(link.p + place);
      scene_["joints"].push_back(std::move(joint));
    }
  }

  static std::string name_of_joint(std::size_t id) { return fmt::format("j{}", id); }
  static std::string name_of_body(std::size_t id) { return fmt::format("b{}", id); }

  const Makings& makings_;
  const RandomLayout& layout_;
  Json& scene_;
  Chance& chance_;
  std::vector<Taken> taken_;
};

/// Rain onto what stands where regions meet. Nothing falls faster than is promised.
Json random_injector(const Makings& makings, const RandomLayout& layout, double gravity, Chance& chance) {
  const Vec3 spot = layout.spots[chance.below(static_cast<std::uint32_t>(layout.spots.size()))];
  const double highest = 0.3 * makings.speed_m_s * makings.speed_m_s / gravity;
  const double wide = chance.between(0.2, 1.2) * makings.region_m, across = 0.1 * makings.speed_m_s;
  Json names = Json::array();
  for (std::uint32_t left = 1 + chance.below(3); left > 0; --left) {
    names.push_back(makings.kinds.all[makings.any_kind(chance)].name);
  }
  return {{"seed", chance.below(1u << 30)},
          {"count", 6 + chance.below(25)},
          {"rate", rounded(chance.between(3, 25))},
          {"start", rounded(chance.between(0, 3))},
          {"velocity", {{"min", json_vec3({-across, -across, -1})}, {"max", json_vec3({across, across, 0.5})}}},
          {"random_orientation", chance.below(3) != 0},
          {"prototypes", names},
          {"volume",
           {{"center", json_vec3(spot + Vec3(0, 0, std::min(highest, chance.between(1.5, 4))))},
            {"size", json_vec3({wide, wide, 0.5})}}}};
}

void add_bodies(const Makings& makings, const RandomLayout& layout, Json& scene, Chance& chance) {
  Builder builder(makings, layout, scene, chance);
  for (std::uint32_t left = 2 + chance.below(3); left > 0; --left) builder.put(random_heap(makings, chance), true);
  for (std::uint32_t left = 1 + chance.below(4); left > 0; --left) builder.put(random_mechanism(makings, chance), true);
  for (std::uint32_t left = 4 + chance.below(24); left > 0 && builder.bodies() < kMostBodies; --left) {
    builder.put(thrown_body(makings, chance), false);
  }
  for (std::uint32_t left = chance.below(3); left > 0; --left) {
    scene["injectors"].push_back(random_injector(makings, layout, -scene["gravity"][2].get<double>(), chance));
  }
}

/// Adds orders that send two of three moving statics elsewhere, once or twice, independent of their paths.
void send_statics(World& world, Chance& chance) {
  for (const Json& moving : world.scene["statics"]) {
    if (!moving.contains("path") && !moving.contains("belt")) continue;
    for (std::uint32_t left = chance.below(3); left > 0; --left) {
      const Vec3 way = {chance.between(-2, 2), chance.between(-2, 2), chance.between(0, 1)};
      const Json& p = moving["position"];
      Json order = {{"at_step", kFirstOrder + chance.below(kLastOrder - kFirstOrder)}};
      order["move_static"] = {{"name", moving["name"]},
                              {"position", json_vec3(Vec3(p[0], p[1], p[2]) + way)},
                              {"states", 30 + chance.below(120)}};
      world.interference["orders"].push_back(std::move(order));
    }
  }
}

/// Chooses two of three moving statics for a program. Clients do not move these, because the later of two moves of one
/// static does not begin before the earlier one.
std::vector<std::string> movers_for_a_program(World& world, Chance& chance) {
  std::vector<std::string> names;
  for (const Json& fixed : world.scene["statics"]) {
    const bool moves = fixed.contains("path") || fixed.contains("belt");
    if (!moves || chance.below(3) == 0) continue;
    names.push_back(fixed["name"]);
    if (!world.interference.contains("orders")) continue;
    Json rest = Json::array();
    for (const Json& order : world.interference["orders"]) {
      if (!order.contains("move_static") || order["move_static"]["name"] != fixed["name"]) rest.push_back(order);
    }
    world.interference["orders"] = std::move(rest);
  }
  return names;
}

}  // namespace

World random_world(std::uint64_t seed) {
  constexpr std::array kGravity = {9.81, 9.81, 9.81, 3.7};
  Chance chance(seed);
  World world;
  const Dials dials = random_dials(chance);
  const double large_m = chance.below(2) == 0 ? way_m(dials) / 4 : 0;
  const Kinds kinds = random_kinds(dials.half_m, large_m, chance);
  const double least_m = std::max(2.0, way_m(dials) + 2 * kinds.largest_radius_m());
  const double region_m = rounded(least_m * chance.between(1, chance.below(3) == 0 ? 4 : 1.5));
  const RandomLayout layout = random_layout(region_m, chance);
  world.scene["name"] = fmt::format("seed {}", seed);
  world.scene["gravity"] = {0, 0, -kGravity[chance.below(kGravity.size())]};
  add_kinds(kinds, world.scene, chance);
  add_ground(layout, world.scene, world.meshes, chance);
  add_bodies({kinds, dials.speed_m_s, region_m}, layout, world.scene, chance);
  world.launch = launch_of(dials, layout.regions, chance);
  world.interference = random_interference(kinds, layout, world.scene, dials.speed_m_s, chance);
  // Separate random numbers, so that a seed's world without moving statics and programs stays the same as in earlier
  // versions.
  Chance of_statics(~seed);
  if (dials.solver == kUsualSolver && of_statics.below(3) == 0) {
    add_moving_statics(layout, world.scene, of_statics);
    send_statics(world, of_statics);
  }
  Chance of_blocks(seed ^ kBlocksOf);
  if (of_blocks.below(6) > 0) {
    world.launch["physics"]["block"] = rounded(kSmallestBlock_m * std::pow(2, of_blocks.between(0, 4)));
  }
  Chance of_programs(seed ^ kProgramsOf);
  if (of_programs.below(3) == 0) {
    world.interference["programs"] =
        random_programs({kinds, dials.speed_m_s, region_m}, world.scene, dials.lookahead, of_programs);
    world.launch["control"] = random_control_rules(of_programs);
  }
  Chance of_movers(~seed ^ kProgramsOf);
  const std::vector<std::string> movers = movers_for_a_program(world, of_movers);
  for (Json& word : random_movers(movers, world.scene, dials.lookahead, of_movers)) {
    world.interference["programs"].push_back(std::move(word));
  }
  return world;
}

}  // namespace aurasim::lab
