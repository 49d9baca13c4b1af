#include "lab/pair.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/horizon.h"
#include "core/make_aura.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

constexpr double kCell_m = 1000;
constexpr std::uint32_t kSphere = 0, kBox = 1, kCapsule = 2;
constexpr std::array<std::string_view, 6> kNames = {"head_on", "corner", "grazing", "boxes", "capsules", "random"};

/// A scene without bodies. Its bodies must never sleep, because in Bullet a slow one in free flight would stop.
core::Scene empty_scene() {
  core::Scene scene;
  scene.name = "pair";
  scene.gravity = Vec3::Zero();
  scene.shapes = {{"sphere", core::Sphere{kRadius_m}},
                  {"box", core::Box{kRadius_m * Vec3(0.48, 0.6, 0.64)}},
                  {"capsule", core::Capsule{0.5 * kRadius_m, kRadius_m}}};
  scene.materials = {core::Material{}};
  scene.prototypes = {{"sphere", kSphere, 0, 1, false}, {"box", kBox, 0, 1, false}, {"capsule", kCapsule, 0, 1, false}};
  return scene;
}

/// How two bodies come together. Their bounding spheres touch with their centres `offset_m` off the line of the
/// relative motion.
struct Meeting {
  Vec3 v_a, v_b;
  double offset_m = 0;
};

/// The thesis takes each speed up to 1 m/s lower, at random; here no more than half of it.
double varied(double speed_m_s, Chance& chance) {
  return speed_m_s - chance.between(0, std::min(1.0, 0.5 * speed_m_s));
}

Meeting head_on(const Vec3& heading, double speed_m_s, Chance& chance) {
  return {varied(speed_m_s, chance) * heading, -varied(speed_m_s, chance) * heading, 0};
}

Meeting at_random(double speed_m_s, Chance& chance) {
  for (;;) {
    const Vec3 v_a = chance.between(0.2, 1) * speed_m_s * chance.direction();
    const Vec3 v_b = chance.between(0.2, 1) * speed_m_s * chance.direction();
    const double across = std::abs((v_a - v_b).x());
    if (across >= 0.5 * speed_m_s) return {v_a, v_b, chance.between(0, 1.2) * kRadius_m};
  }
}

Meeting draw(PairKind kind, double speed_m_s, Chance& chance) {
  if (kind == PairKind::kCorner) {
    const double turn = chance.between(0, 2 * std::numbers::pi);
    return head_on({std::cos(turn), std::sin(turn), 0}, speed_m_s, chance);
  }
  if (kind == PairKind::kRandom) return at_random(speed_m_s, chance);
  Meeting meeting = head_on(Vec3::UnitX(), speed_m_s, chance);
  if (kind == PairKind::kGrazing) meeting.offset_m = chance.between(1.4, 1.98) * kRadius_m;
  if (kind == PairKind::kBoxes || kind == PairKind::kCapsules) {
    meeting.offset_m = chance.between(0, 0.8) * kRadius_m;
  }
  return meeting;
}

/// Place of one body's centre when they touch: over the border x = 0, or over the corner.
Vec3 over_the_border(PairKind kind, Chance& chance) {
  if (kind != PairKind::kCorner) return {chance.between(-1, 1) * kRadius_m, chance.between(-50, 50), 0};
  const double turn = chance.between(0, 2 * std::numbers::pi);
  const double r = kRadius_m * std::sqrt(chance.between(0, 1));
  return {r * std::cos(turn), r * std::sin(turn), 0};
}

std::uint32_t shape_of(PairKind kind, Chance& chance) {
  if (kind == PairKind::kBoxes) return kBox;
  if (kind == PairKind::kCapsules) return kCapsule;
  return kind == PairKind::kRandom ? chance.below(3) : kSphere;
}

/// Seconds before the meeting at which no aura of any kind links the bodies yet, not even in state 0, when clusters
/// look four times as far ahead (core::assign_hosts), and from which on the nodes have 12 K steps to talk.
double notice_s(PairKind kind, const Conditions& conditions, double v_a, double v_b, double closing_m_s) {
  const int hops = kind == PairKind::kCorner ? core::horizon::kMostHops : 1;
  const RoundShapes shapes(kRadius_m);
  double far_m = 0;
  double swept_s = 0;
  for (const AuraChoice choice :
       {AuraChoice::kThesis, AuraChoice::kTight, AuraChoice::kTightAtThesisSize, AuraChoice::kSwept}) {
    core::AuraRules rules = rules_for(choice, conditions);
    rules.lookahead = core::horizon::lookahead_at_start(rules.lookahead);
    core::BodyState body;
    body.v_WB.x() = v_a + v_b;
    const std::unique_ptr<const core::Aura> aura = core::make_aura(rules, shapes);
    const double stated = aura->speed_of(body) + aura->speed_of({});
    if (choice == AuraChoice::kSwept) {
      swept_s = core::horizon::announcing(rules.lookahead, hops) * kStep_s;
      swept_s += rules.uncertainty * swept_s * stated / closing_m_s;
    } else {
      far_m = std::max(far_m, aura->link_range(hops).at(stated) + 2 * kRadius_m);
    }
  }
  const double talk_s = (12 * lookahead(conditions.promised) + 8) * kStep_s;
  return std::max({far_m / closing_m_s, swept_s, talk_s}) + 4 * kStep_s;
}

core::InitialBody body_before(double t_s, std::uint64_t id, std::uint32_t prototype, const Vec3& p, const Vec3& v,
                              Chance& chance) {
  core::InitialBody body;
  body.id = core::BodyId{id};
  body.prototype = core::PrototypeId{prototype};
  body.pose.p_WB = p - t_s * v;
  body.v_WB = v;
  if (prototype != kSphere) {
    body.pose.q_WB = chance.rotation();
    body.w_WB = chance.between(0, 3) * chance.direction();
  }
  return body;
}

/// A random unit vector perpendicular to `line`.
Vec3 square_to(const Vec3& line, Chance& chance) {
  for (;;) {
    const Vec3 side = line.cross(chance.direction());
    if (side.norm() > 0.1) return side.normalized();
  }
}

}  // namespace

Vec3 Chance::direction() {
  const double z = between(-1, 1);
  const double turn = between(0, 2 * std::numbers::pi);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

core::Quat Chance::rotation() {
  const Vec3 axis = direction();
  return core::Quat(Eigen::AngleAxisd(between(0, 2 * std::numbers::pi), axis));
}

std::string_view name_of(PairKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

Pair make_pair(PairKind kind, const Conditions& conditions, Chance& chance) {
  Pair pair;
  pair.scene = empty_scene();
  pair.map =
      kind == PairKind::kCorner ? core::RegionMap::grid(2, 2, kCell_m, kCell_m) : core::RegionMap::columns(2, kCell_m);
  for (;;) {
    const Meeting meeting = draw(kind, conditions.speed_m_s, chance);
    const Vec3 closing = meeting.v_a - meeting.v_b;
    const Vec3 line = closing.normalized();
    const double along_m = std::sqrt(4 * kRadius_m * kRadius_m - meeting.offset_m * meeting.offset_m);
    const Vec3 apart = along_m * line + meeting.offset_m * square_to(line, chance);
    const double t_s =
        notice_s(kind, conditions, meeting.v_a.norm(), meeting.v_b.norm(), closing.norm()) + chance.between(0, kStep_s);
    const Vec3 place = over_the_border(kind, chance);
    const bool first = chance.below(2) == 0;
    const Vec3 p_a = first ? place : Vec3(place - apart);
    const Vec3 p_b = first ? Vec3(place + apart) : place;
    pair.scene.bodies = {body_before(t_s, 0, shape_of(kind, chance), p_a, meeting.v_a, chance),
                         body_before(t_s, 1, shape_of(kind, chance), p_b, meeting.v_b, chance)};
    pair.expected_step = static_cast<core::Step>(std::ceil(t_s / kStep_s));
    pair.passed_step = pair.expected_step + static_cast<core::Step>(2 * along_m / closing.norm() / kStep_s) + 2;
    const auto owner = [&](int i) { return pair.map.owner(pair.scene.bodies[static_cast<std::size_t>(i)].pose.p_WB); };
    if (owner(0) != owner(1)) return pair;
  }
}

}  // namespace aurasim::lab
