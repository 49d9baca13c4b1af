#include "core/meetings.h"

namespace aurasim::core::testing {
namespace {

constexpr double kSlotHeight = 300;  // metres: no reach of any test is as long

}  // namespace

void Tally::add(const KinematicWorld& world, std::size_t pairs_in_it) {
  pairs += pairs_in_it;
  apart += world.apart();
  met += world.met();
  late += world.late();
  hand_offs += world.hand_offs();
  broken += world.broken();
  if (first_late.empty()) first_late = world.first_late();
}

void Tally::add(const Tally& other) {
  pairs += other.pairs;
  apart += other.apart;
  met += other.met;
  late += other.late;
  hand_offs += other.hand_offs;
  broken += other.broken;
  if (first_late.empty()) first_late = other.first_late;
}

double RandomPair::speed() {
  const double kind = random_.between(0, 1);
  if (full_speed_ || kind < 0.5) return rules_.top_speed_m_s;
  return kind < 0.65 ? 0 : random_.between(0, rules_.top_speed_m_s);
}

void RandomPair::place_in(KinematicWorld& world, std::uint32_t slot, const Meeting& meeting, PrototypeId a,
                          PrototypeId b, const RoundShapes& shapes) {
  const Vec3 place = meeting.places[random_.below(static_cast<std::uint32_t>(meeting.places.size()))];
  Vec3 m = place + random_.in_box(meeting.spread_m);
  m.z() += kSlotHeight * slot;
  const double early = random_.chance(0.1) && !full_speed_ ? 0.1 : 9.0 * rules_.lookahead + 2;
  const double when = random_.between(early, 9.0 * rules_.lookahead + 12);

  const bool head_on = full_speed_ || random_.chance(0.5);
  Vec3 heading = random_.direction();
  if (full_speed_ || random_.chance(0.5)) heading = random_.chance(0.5) ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 v_a = heading * speed();
  Vec3 v_b = (head_on ? Vec3(-heading) : random_.direction()) * speed();
  if ((v_a - v_b).norm() < 1) v_b = -heading * rules_.top_speed_m_s;
  const Vec3 closing = (v_a - v_b).normalized();
  Vec3 normal = closing;  // from A to B when they touch
  if (!head_on) {
    do normal = (closing + 0.9 * random_.direction()).normalized();
    while (normal.dot(closing) < 0.05);
  }
  const double r_a = shapes.bounding_radius(a);
  const double r_b = shapes.bounding_radius(b);
  const BodyId id_a{2 * slot};
  const BodyId id_b{2 * slot + 1};
  Traveller first = on_straight_line(id_a, a, rules_, m - r_a * normal, when, v_a, steps(rules_));
  Traveller second = on_straight_line(id_b, b, rules_, m + r_b * normal, when, v_b, steps(rules_));
  first.awake = v_a.norm() > 0 || random_.chance(0.5);
  second.awake = v_b.norm() > 0 || random_.chance(0.5);
  world.place(std::move(first));
  world.place(std::move(second));
  world.watch(id_a, id_b);
}

}  // namespace aurasim::core::testing
