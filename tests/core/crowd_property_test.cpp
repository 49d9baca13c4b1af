// Four bodies at once, where pulls chain: a hit body takes others along, and those meet others still.
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "core/meetings.h"

namespace aurasim::core::testing {
namespace {

struct Crowded {
  std::string name;
  RegionMap map;
};

class Crowd : public ::testing::TestWithParam<std::tuple<int, AuraKind, Crowded>> {
 protected:
  static constexpr std::uint32_t kBodies = 4;

  Crowd() {
    rules.lookahead = std::get<0>(GetParam());
    rules.kind = std::get<1>(GetParam());
    rules.substeps = 5 - rules.lookahead;
    rules.contact_margin_m = 0;
    rules.gravity = Vec3::Zero();
  }

  Traveller passer_by(Random& random, const Vec3& centre, double spread, Step steps) {
    const double v = random.chance(0.6) ? rules.top_speed_m_s : random.between(0, rules.top_speed_m_s);
    const Vec3 velocity = v * random.direction();
    const double when = random.between(10 * rules.lookahead + 2, 14 * rules.lookahead + 15);
    return on_straight_line({}, {}, rules, centre + random.in_box(spread), when, velocity, steps);
  }

  Tally pass_by(int worlds, std::uint32_t crowds_each) {
    Random random("crowds");
    Tally tally;
    const double way = 4 * rules.lookahead * rules.top_speed_m_s * rules.step_s;
    const Step steps = 16 * rules.lookahead + 25;
    for (int w = 0; w < worlds; ++w) {
      RoundShapes shapes;
      const PrototypeId kinds[] = {shapes.sphere(random.between(0.05, 1)), shapes.sphere(random.between(0.05, 1))};
      KinematicWorld world(std::get<2>(GetParam()).map, rules, shapes);
      const double spread = random.between(0.5, way);
      for (std::uint32_t i = 0; i < crowds_each * kBodies; ++i) {
        Traveller t = passer_by(random, Vec3(0, 0, 300.0 * (i / kBodies)), spread, steps);
        t.id = BodyId{i};
        t.prototype = kinds[random.below(2)];
        world.place(std::move(t));
        for (std::uint32_t j = i - i % kBodies; j < i; ++j) world.watch(BodyId{j}, BodyId{i});
      }
      world.start();
      world.run_steps(steps);
      tally.add(world, crowds_each * kBodies * (kBodies - 1) / 2);
    }
    return tally;
  }

  AuraRules rules;
};

TEST_P(Crowd, MeetsOnOneNodeEach) {
  const Tally t = pass_by(20, 12);
  std::printf("[  counts  ] K %d S %d: %zu pairs, %zu on two hosts, %zu met, %llu hand-offs, %zu late\n",
              rules.lookahead, rules.substeps, t.pairs, t.apart, t.met, static_cast<unsigned long long>(t.hand_offs),
              t.late);
  EXPECT_EQ(t.late, 0u) << t.first_late;
  EXPECT_EQ(t.broken, 0u);
  EXPECT_GT(t.met, 50u);
}

INSTANTIATE_TEST_SUITE_P(All, Crowd,
                         ::testing::Combine(::testing::Values(1, 2, 3),
                                            ::testing::Values(AuraKind::kTight, AuraKind::kSwept),
                                            ::testing::Values(Crowded{"Edge", RegionMap::columns(2, 60)},
                                                              Crowded{"Grid", RegionMap::grid(2, 2, 60, 60)},
                                                              Crowded{"Bricks", RegionMap::brick(2, 2, 60, 60)},
                                                              Crowded{"NarrowColumns", RegionMap::columns(3, 4)})),
                         [](const auto& info) {
                           std::string name = std::get<2>(info.param).name;
                           name.append(std::get<1>(info.param) == AuraKind::kTight ? "TightK" : "SweptK");
                           return name.append(std::to_string(std::get<0>(info.param)));
                         });

}  // namespace
}  // namespace aurasim::core::testing
