// What is known of the bodies of others, and the blocks in which they are asked about.
#include "core/foreign.h"

#include <limits>
#include <memory>
#include <set>

#include <gtest/gtest.h>

#include "core/make_aura.h"
#include "core/random.h"
#include "core/round_shapes.h"

namespace aurasim::core::testing {
namespace {

constexpr Step kNow = 100;

class AForeignBody : public ::testing::Test {
 protected:
  AuraRecord aura_at(const Vec3& p, double speed_m_s = 0.1, RegionId host = RegionId{1}) {
    AuraRecord aura;
    aura.id = BodyId{next_id++};
    aura.host = host;
    aura.prototype = ball;
    aura.stamp = kNow - 3;
    aura.pose.p_WB = p;
    aura.speed_m_s = speed_m_s;
    return aura;
  }
  const Foreign& receive(const AuraRecord& aura_record, Step known = kNow - 1) {
    bodies.clear();
    bodies.add(aura_record, known, kNow, *aura);
    bodies.build();
    return bodies[0];
  }

  RoundShapes shapes;
  PrototypeId ball = shapes.sphere(0.5);
  PrototypeId boulder = shapes.sphere(30);
  std::unique_ptr<const Aura> aura = make_aura(AuraRules{}, shapes);
  ForeignBodies bodies;
  std::uint64_t next_id = 1;
};

TEST_F(AForeignBody, IsAsOldAsItsAura) { EXPECT_EQ(receive(aura_at(Vec3::Zero())).path.age_steps, 3); }

TEST_F(AForeignBody, AsleepIsAsOldAsTheLastWordOfItsSource) {
  AuraRecord sleeper = aura_at(Vec3::Zero());
  sleeper.flags = kAuraAsleep;
  EXPECT_EQ(receive(sleeper).path.age_steps, 1);
  EXPECT_FALSE(receive(sleeper).path.moves);
  sleeper.flags |= kAuraGhost;  // out of its source's sight since
  EXPECT_EQ(receive(sleeper).path.age_steps, 3);
}

TEST_F(AForeignBody, IsNotBornBeforeItsBirth) {
  AuraRecord coming = aura_at(Vec3::Zero());
  coming.birth = kNow + 4;
  EXPECT_FALSE(receive(coming).born);
  EXPECT_EQ(bodies[0].path.unborn_steps, 4);
  EXPECT_EQ(bodies[0].path.age_steps, 0);
  coming.birth = kNow - 1;
  EXPECT_EQ(receive(coming).path.age_steps, 1);
}

TEST_F(AForeignBody, IsInOneBlockWithOthersOfItsHostAndPace) {
  Random random("bodies");
  for (int run = 0; run < 50; ++run) {
    bodies.clear();
    const std::uint32_t count = random.below(300);
    for (std::uint32_t i = 0; i < count; ++i) {
      AuraRecord record = aura_at(random.in_box(30), random.chance(0.2) ? 20 : 0.5, RegionId{1 + random.below(3)});
      if (random.chance(0.02)) record.prototype = boulder;
      bodies.add(record, kNow, kNow, *aura);
    }
    bodies.build();
    std::set<std::uint32_t> seen;
    for (const ForeignBlock& block : bodies.blocks()) {
      ASSERT_FALSE(block.bodies.empty());
      for (const std::uint32_t i : block.bodies) {
        const Foreign& body = bodies[i];
        EXPECT_TRUE(seen.insert(i).second);
        EXPECT_EQ(body.host, block.host);
        EXPECT_EQ(body.path.speed_m_s, bodies[block.bodies.front()].path.speed_m_s);
        const Vec3 radius = Vec3::Constant(body.path.radius_m);
        EXPECT_TRUE(((body.path.pose.p_WB - radius).array() >= block.lo.array()).all());
        EXPECT_TRUE(((body.path.pose.p_WB + radius).array() <= block.hi.array()).all());
      }
    }
    EXPECT_EQ(seen.size(), count);
  }
}

TEST_F(AForeignBody, SharesItsBlockWithThoseBesideItAndNotWithThoseFarAway) {
  for (int i = 0; i < 9; ++i) bodies.add(aura_at({0.3 + 0.1 * i, 0.5, 0}), kNow, kNow, *aura);
  for (int i = 0; i < 9; ++i) bodies.add(aura_at({50.3 + 0.1 * i, 0.5, 0}), kNow, kNow, *aura);
  bodies.build();
  ASSERT_EQ(bodies.blocks().size(), 2u);
  EXPECT_EQ(bodies.blocks()[0].bodies.size(), 9u);
}

TEST_F(AForeignBody, NowhereOrFarOutIsInABlockToo) {
  bodies.clear();
  for (const double x : {0.0, 1e300, -1e300, std::numeric_limits<double>::quiet_NaN()}) {
    bodies.add(aura_at({x, -x, 0}), kNow, kNow, *aura);
  }
  bodies.build();
  std::size_t in_blocks = 0;
  for (const ForeignBlock& block : bodies.blocks()) in_blocks += block.bodies.size();
  EXPECT_EQ(in_blocks, 4u);
}

}  // namespace
}  // namespace aurasim::core::testing
