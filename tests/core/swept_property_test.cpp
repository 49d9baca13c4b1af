// Swept auras: bodies fall, tumble, and leave their predicted paths by as much as the uncertainty U allows. None that
// meet are late; with U = 0 in the rules, and the same paths, some are.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "core/meetings.h"

namespace aurasim::core::testing {
namespace {

constexpr double kSweptUncertainty = 0.5;

AuraRules swept_rules(int lookahead, int substeps) {
  AuraRules rules;
  rules.kind = AuraKind::kSwept;
  rules.lookahead = lookahead;
  rules.substeps = substeps;
  rules.uncertainty = kSweptUncertainty;
  rules.contact_margin_m = 0;
  return rules;
}

/// Falls as Bullet integrates it and is knocked about, each step anew or in one long bend: two of its velocities never
/// differ by more than U times the slower one, gravity aside.
Traveller on_bent_path(Random& random, const AuraRules& rules, const Vec3& v, Step steps) {
  Traveller t;
  const double knock = kSweptUncertainty / (2 + kSweptUncertainty) * v.head<2>().norm();
  const double h = rules.step_s / rules.substeps;
  const bool bends = random.chance(0.5);
  const Step turning_point = 1 + static_cast<Step>(random.below(static_cast<std::uint32_t>(steps)));
  const Vec3 bend = knock * random.direction();
  Vec3 free_v = v;
  Vec3 p = Vec3::Zero();
  t.p_WB.push_back(p);
  t.v_WB.push_back(v);
  for (Step n = 1; n <= steps; ++n) {
    const Vec3 off = bends ? (n < turning_point ? bend : Vec3(-bend)) : Vec3(knock * random.direction());
    for (int s = 0; s < rules.substeps; ++s) {
      free_v += rules.gravity * h;
      p += (free_v + off) * h;
      t.p_WB.push_back(p);
    }
    t.v_WB.push_back(free_v + off);
  }
  return t;
}

class SweptAura : public ::testing::TestWithParam<std::pair<int, int>> {
 protected:
  /// Pairs that touch at a random instant, near the middle of `map`.
  Tally meet(const RegionMap& map, const AuraRules& rules, int worlds, std::uint32_t pairs_each) {
    Random random("bent paths");
    Tally tally;
    for (int w = 0; w < worlds; ++w) {
      RoundShapes shapes;
      const PrototypeId kinds[] = {shapes.sphere(random.between(0.1, 0.8)),
                                   shapes.dumbbell(random.between(0.1, 0.3), random.between(0.2, 0.8))};
      KinematicWorld world(map, rules, shapes);
      for (std::uint32_t slot = 0; slot < pairs_each; ++slot) place_pair(world, random, rules, slot, kinds, shapes);
      world.start();
      world.run_steps(steps(rules));
      tally.add(world, pairs_each);
    }
    std::printf("[  counts  ] K %d S %d U %.1f: %zu pairs, %zu on two hosts, %zu met, %llu hand-offs, %zu late\n",
                rules.lookahead, rules.substeps, rules.uncertainty, tally.pairs, tally.apart, tally.met,
                static_cast<unsigned long long>(tally.hand_offs), tally.late);
    return tally;
  }

 private:
  static Step steps(const AuraRules& rules) { return 46 * rules.lookahead + 20; }

  Vec3 velocity(Random& random) {
    const Vec3 heading = random.chance(0.5) ? Vec3(random.chance(0.5) ? 1 : -1, 0, 0) : random.direction();
    return random.between(0, 30) * heading;
  }

  void place_pair(KinematicWorld& world, Random& random, const AuraRules& rules, std::uint32_t slot,
                  const PrototypeId (&kinds)[2], const RoundShapes& shapes) {
    const auto touch =
        static_cast<std::size_t>(random.between(43 * rules.lookahead + 2, 45 * rules.lookahead + 15) * rules.substeps);
    const double way = 30 * rules.step_s * 6 * rules.lookahead;
    Vec3 m = random.in_box(way) + Vec3(0, 0, 300.0 * slot);
    for (std::uint32_t i = 0; i < 2; ++i) {
      Traveller t = on_bent_path(random, rules, velocity(random), steps(rules));
      t.id = BodyId{2 * slot + i};
      t.prototype = kinds[random.below(2)];
      if (random.chance(0.5)) t.w_WB = random.between(0, 20) * random.direction();
      const Vec3 shift = m - t.p_WB[touch];
      for (Vec3& p : t.p_WB) p += shift;
      m += random.between(0.5, 2) * shapes.bounding_radius(t.prototype) * random.direction();
      world.place(std::move(t));
    }
    world.watch(BodyId{2 * slot}, BodyId{2 * slot + 1});
  }
};

TEST_P(SweptAura, MissesNothingWithinItsUncertainty) {
  const auto [lookahead, substeps] = GetParam();
  const Tally t = meet(RegionMap::columns(2, 60), swept_rules(lookahead, substeps), 25, 40);
  EXPECT_EQ(t.late, 0u) << t.first_late;
  EXPECT_EQ(t.broken, 0u);
  EXPECT_GT(t.met, t.pairs / 2);
  EXPECT_GT(t.apart, t.pairs / 10);
}

TEST_P(SweptAura, MissesNothingAtTheCornerOfAGrid) {
  const auto [lookahead, substeps] = GetParam();
  const Tally t = meet(RegionMap::grid(2, 2, 60, 60), swept_rules(lookahead, substeps), 20, 30);
  EXPECT_EQ(t.late, 0u) << t.first_late;
  EXPECT_EQ(t.broken, 0u);
}

TEST_P(SweptAura, WithoutUncertaintyMissesSome) {
  const auto [lookahead, substeps] = GetParam();
  AuraRules rules = swept_rules(lookahead, substeps);
  rules.uncertainty = 0;
  EXPECT_GT(meet(RegionMap::columns(2, 60), rules, 25, 40).late, 0u);
}

std::string name_of(const ::testing::TestParamInfo<std::pair<int, int>>& info) {
  char name[16];
  std::snprintf(name, sizeof name, "K%dS%d", info.param.first, info.param.second);
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, SweptAura,
                         ::testing::Values(std::pair(1, 1), std::pair(1, 4), std::pair(2, 1), std::pair(2, 4)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(ThreeSteps, SweptAura, ::testing::Values(std::pair(3, 2)), name_of);

}  // namespace
}  // namespace aurasim::core::testing
