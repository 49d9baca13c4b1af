// The property that the aura exists for: whatever meets at a border is computed by one node from the first instant on.
// Every reach is exactly as in docs/design.md, "The aura and its reach", and a tenth of a step less is too little.
#include <cstdio>

#include <gtest/gtest.h>

#include "core/meetings.h"

namespace aurasim::core::testing {
namespace {

struct KS {
  int lookahead;
  int substeps;
};

AuraRules tight_rules(KS ks) {
  AuraRules rules;
  rules.kind = AuraKind::kTight;
  rules.lookahead = ks.lookahead;
  rules.substeps = ks.substeps;
  rules.contact_margin_m = 0;
  rules.gravity = Vec3::Zero();
  return rules;
}

double metres_per_step(const AuraRules& rules) { return rules.top_speed_m_s * rules.step_s; }

/// The scale at which reach() is `steps` of V shorter.
double scale_that_is_shorter_by(double steps, KS ks) {
  return 1 - steps / (3.0 * ks.lookahead - 2 + 2.0 * (ks.substeps - 1) / ks.substeps);
}

class Reach : public ::testing::TestWithParam<KS> {
 protected:
  KS ks() const { return GetParam(); }

  Tally meet(const RegionMap& map, const AuraRules& rules, const std::vector<Vec3>& places, int worlds,
             std::uint32_t pairs_each, Random& random, bool full_speed = false) {
    Tally tally;
    for (int w = 0; w < worlds; ++w) {
      RoundShapes shapes;
      const PrototypeId a = shapes.sphere(random.between(0.05, 1.5));
      const PrototypeId b = shapes.sphere(random.between(0.05, 1.5));
      KinematicWorld world(map, rules, shapes);
      RandomPair pair(random, rules);
      if (full_speed) pair.always_at_full_speed();
      const double spread = full_speed ? 0.3 : random.between(0.1, 6 * ks().lookahead * metres_per_step(rules));
      for (std::uint32_t slot = 0; slot < pairs_each; ++slot) {
        pair.place_in(world, slot, {places, spread}, a, b, shapes);
      }
      world.start();
      world.run_steps(RandomPair::steps(rules));
      tally.add(world, pairs_each);
    }
    return tally;
  }

  void print(const char* what, const Tally& t) const {
    std::printf("[  counts  ] K %d S %d %-12s %zu pairs, %zu on two hosts, %zu met, %llu hand-offs, %zu late\n",
                ks().lookahead, ks().substeps, what, t.pairs, t.apart, t.met,
                static_cast<unsigned long long>(t.hand_offs), t.late);
  }

  void expect_none_late(const Tally& tally) {
    EXPECT_EQ(tally.late, 0u) << tally.first_late;
    EXPECT_EQ(tally.broken, 0u);
    EXPECT_GT(tally.met, tally.pairs * 9 / 10);
    EXPECT_GT(tally.apart, tally.pairs / 20);
  }
};

TEST_P(Reach, OfTheTableIsEnoughAtAnEdge) {
  Random random("two columns");
  const Tally t = meet(RegionMap::columns(2, 60), tight_rules(ks()), {Vec3::Zero()}, 32, 32, random);
  print("edge", t);
  expect_none_late(t);
}

TEST_P(Reach, OfTheTableIsEnoughAtTheCornerOfAGrid) {
  Random random("grid of 2 x 2");
  const std::vector<Vec3> places = {Vec3::Zero(), Vec3::Zero(), Vec3(10, 0, 0), Vec3(0, -10, 0)};
  const Tally t = meet(RegionMap::grid(2, 2, 60, 60), tight_rules(ks()), places, 32, 24, random);
  print("grid", t);
  expect_none_late(t);
}

TEST_P(Reach, OfTheTableIsEnoughWhereThreeRegionsMeet) {
  Random random("bricks");
  const std::vector<Vec3> places = {Vec3::Zero(), Vec3(30, 0, 0), Vec3(0, -8, 0), Vec3(30, 8, 0)};
  const Tally t = meet(RegionMap::brick(2, 2, 60, 60), tight_rules(ks()), places, 32, 24, random);
  print("bricks", t);
  expect_none_late(t);
}

TEST_P(Reach, OfTheTableIsEnoughForAPairThatIsAloneInTheWorld) {
  Random random("one pair");
  const Tally t = meet(RegionMap::columns(2, 60), tight_rules(ks()), {Vec3::Zero()}, 300, 1, random);
  print("alone", t);
  expect_none_late(t);
}

TEST_P(Reach, ATenthOfAStepShorterIsTooLittle) {
  Random random("head on, a tenth of a step short");
  AuraRules rules = tight_rules(ks());
  const Tally enough = meet(RegionMap::columns(2, 60), rules, {Vec3::Zero()}, 20, 20, random, true);
  EXPECT_EQ(enough.late, 0u) << enough.first_late;
  rules.reach_scale = scale_that_is_shorter_by(0.1, ks());
  const Tally t = meet(RegionMap::columns(2, 60), rules, {Vec3::Zero()}, 20, 20, random, true);
  print("too short", t);
  EXPECT_GT(t.late, 0u);
}

TEST_P(Reach, OfNothingIsTooLittle) {
  Random random("the naive control");
  AuraRules rules = tight_rules(ks());
  rules.kind = AuraKind::kNone;
  const Tally t = meet(RegionMap::columns(2, 60), rules, {Vec3::Zero()}, 4, 25, random);
  EXPECT_GT(t.late, t.pairs / 10);
}

INSTANTIATE_TEST_SUITE_P(All, Reach,
                         ::testing::Values(KS{1, 1}, KS{1, 2}, KS{1, 4}, KS{2, 1}, KS{2, 2}, KS{2, 4}, KS{3, 1},
                                           KS{3, 2}, KS{3, 4}),
                         [](const auto& info) {
                           char name[16];
                           std::snprintf(name, sizeof name, "K%dS%d", info.param.lookahead, info.param.substeps);
                           return std::string(name);
                         });

}  // namespace
}  // namespace aurasim::core::testing
