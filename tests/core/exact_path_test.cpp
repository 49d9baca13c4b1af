// Bodies that fly exactly as predicted need no uncertainty: swept auras with U = 0 must not be late for any of them.
// With U = 0.5 the same mistakes are rare, not absent.
#include <algorithm>
#include <cstdio>

#include <gtest/gtest.h>

#include "core/meetings.h"

namespace aurasim::core::testing {
namespace {

constexpr BodyId kFirst{0}, kSecond{1};
constexpr RegionId kLeft{0};

class ExactPath : public ::testing::TestWithParam<int> {
 protected:
  ExactPath() {
    rules.kind = AuraKind::kSwept;
    rules.lookahead = GetParam();
    rules.substeps = 4;
    rules.uncertainty = 0;
    rules.contact_margin_m = 0;
    rules.gravity = Vec3::Zero();
  }
  int k() const { return rules.lookahead; }

  void print(const Tally& t) const {
    std::printf("[  counts  ] K %d: %zu pairs, %zu on two hosts, %zu met, %llu hand-offs, %zu late\n", k(), t.pairs,
                t.apart, t.met, static_cast<unsigned long long>(t.hand_offs), t.late);
  }

  AuraRules rules;
  RoundShapes shapes;
  PrototypeId ball = shapes.sphere(0.5);
};

TEST_P(ExactPath, NeedsNoUncertainty) {
  Random random("pairs");
  Tally tally;
  const double way = 6 * k() * rules.top_speed_m_s * rules.step_s;
  for (int w = 0; w < 100; ++w) {
    RoundShapes both;
    const PrototypeId a = both.sphere(random.between(0.05, 1.5));
    const PrototypeId b = both.sphere(random.between(0.05, 1.5));
    KinematicWorld world(RegionMap::columns(2, 60), rules, both);
    RandomPair pair(random, rules);
    const double spread = random.between(0.1, way);
    for (std::uint32_t slot = 0; slot < 40; ++slot) pair.place_in(world, slot, {{Vec3::Zero()}, spread}, a, b, both);
    world.start();
    world.run_steps(RandomPair::steps(rules));
    tally.add(world, 40);
  }
  print(tally);
  EXPECT_EQ(tally.late, 0u) << tally.first_late;
  EXPECT_EQ(tally.broken, 0u);
}

/// Both on the left node, the first over the right region and about to go home, the second about to catch up with it.
/// Were the first to leave just then, it would be back too late: 2K - 1 states later at the earliest.
TEST_P(ExactPath, ABodyThatIsAboutToBeHitByOneOfItsOwnNodeDoesNotGoHome) {
  const Step steps = 12 * k() + 30;
  for (double touch = 2; touch < 6 * k() + 6; touch += 0.125) {
    KinematicWorld world(RegionMap::columns(2, 60), rules, shapes);
    const Vec3 touch_at(0.61 + 0.05 * touch, 0, 0);
    world.place(on_straight_line(kFirst, ball, rules, touch_at, touch, Vec3(3, 0, 0), steps));
    world.place(on_straight_line(kSecond, ball, rules, touch_at - Vec3(1, 0, 0), touch, Vec3(27, 0, 0), steps));
    world.watch(kFirst, kSecond);
    world.start_on(kFirst, kLeft);
    world.start_on(kSecond, kLeft);
    world.start();
    world.run_steps(steps);
    EXPECT_EQ(world.met(), 1u);
    EXPECT_EQ(world.late(), 0u) << "touch at " << touch << ": " << world.first_late();
  }
}

/// Announced in good time, born in flight next to a border, and met by a body from elsewhere in its first steps.
TEST_P(ExactPath, OfABodyStartsAtItsBirth) {
  Random random("births");
  Tally tally;
  const Step steps = 12 * k() + 20;
  for (int run = 0; run < 3000; ++run) {
    KinematicWorld world(RegionMap::columns(2, 60), rules, shapes);
    const Step birth = 9 * k() + 3 + random.below(5);
    const Vec3 v_a = random.between(0, 30) * random.direction();
    const Vec3 v_b = random.between(0, 30) * random.direction();
    const Vec3 normal = (v_a - v_b).normalized();
    const double when = static_cast<double>(birth) + random.between(0, k() + 1);
    const Vec3 m = random.in_box(1);
    Traveller newborn = on_straight_line(kFirst, ball, rules, m - 0.5 * normal, when, v_a, steps);
    newborn.birth = birth;
    const auto first = newborn.p_WB.begin() + birth * rules.substeps;
    std::fill(newborn.p_WB.begin(), first, *first);
    world.place(newborn);
    world.place(on_straight_line(kSecond, ball, rules, m + 0.5 * normal, when, v_b, steps));
    world.watch(kFirst, kSecond);
    world.start();
    world.run_steps(steps);
    tally.add(world, 1);
  }
  print(tally);
  EXPECT_EQ(tally.late, 0u) << tally.first_late;
}

INSTANTIATE_TEST_SUITE_P(ShortestLookahead, ExactPath, ::testing::Values(1));
/// Links look 2K - 1 states ahead: a body that goes home is out of reach for that long.
INSTANTIATE_TEST_SUITE_P(LongerLookahead, ExactPath, ::testing::Values(2, 3));

}  // namespace
}  // namespace aurasim::core::testing
