// A push along contacts against momentum: what a chain of bodies that do not bounce can come to have.
#include "core/pushes.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace aurasim::core::testing {
namespace {

constexpr BodyTraits kPlastic{1, 0};
constexpr BodyTraits kElastic{1, 1};
constexpr double kUncertainty = 0.5;

class PushesTest : public ::testing::Test {
 protected:
  void chain(const std::vector<double>& own_m_s, const std::vector<BodyTraits>& kinds, bool rigid = false) {
    kinds_ = kinds;
    pushes.begin(own_m_s, kinds_, kUncertainty);
    for (std::uint32_t i = 0; i + 1 < own_m_s.size(); ++i) pushes.add(i, i + 1, rigid);
    for (std::uint32_t i = 0; i < own_m_s.size(); ++i) pushes.start(i);
    pushes.spread(raised);
  }

  Pushes pushes;
  std::vector<std::uint32_t> raised;

 private:
  std::vector<BodyTraits> kinds_;
};

/// Onto the ground, say: what does not bounce stops, what bounces fully comes back as fast.
TEST_F(PushesTest, ABodyByItselfMayLoseOrTurnItsOwnSpeed) {
  chain({20}, {kPlastic});
  EXPECT_EQ(kUncertainty * pushes.off_path_m_s(0), 20);
  EXPECT_EQ(pushes.speed(0), 20) << "others it pushes no harder";
  chain({20}, {kElastic});
  EXPECT_EQ(kUncertainty * pushes.off_path_m_s(0), 40);
}

TEST_F(PushesTest, AChainThatDoesNotBounceSharesTheMomentum) {
  chain({20, 0, 0, 0, 0, 0}, std::vector(6, kPlastic));
  for (std::uint32_t i = 0; i < 6; ++i) {
    const double together_m_s = 20.0 / (i + 1);
    EXPECT_GE(kUncertainty * pushes.speed(i), std::min(together_m_s, 10.0) - 1e-9) << i;
    EXPECT_NEAR(pushes.speed(i), std::min(20.0, together_m_s / kUncertainty), 1e-9) << i;
  }
}

/// Of equal masses, each gets the speed of the one before.
TEST_F(PushesTest, BodiesThatBounceFullyPassOnEverything) {
  chain({0, 0, 20, 0, 0, 0}, std::vector(6, kElastic));
  for (std::uint32_t i = 0; i < 6; ++i) EXPECT_NEAR(kUncertainty * pushes.speed(i), 20, 1e-9) << i;
}

/// Two masses that meet, restitution e: what is at rest leaves with (1 + e) m / (m + M) of the speed.
TEST_F(PushesTest, OneImpactIsWhatMechanicsSays) {
  Random random("impact");
  for (int run = 0; run < 200; ++run) {
    const double e = random.between(0, 1), m = random.between(0.1, 50), other = random.between(0.1, 50);
    chain({10, 0}, {BodyTraits{m, e}, BodyTraits{other, e}});
    EXPECT_NEAR(kUncertainty * pushes.speed(1), (1 + e) * m / (m + other) * 10, 1e-9);
  }
}

TEST_F(PushesTest, JointedBodiesPassOnEverything) {
  chain({0, 0, 20, 0}, std::vector(4, kPlastic), true);
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(pushes.speed(i), 20) << i;
}

TEST_F(PushesTest, AHeavyBodyIsHardlyMovedByALightOneAndALightOneWhollyByAHeavyOne) {
  chain({20, 0}, {BodyTraits{1, 0}, BodyTraits{1000, 0}});
  EXPECT_LT(pushes.speed(1), 0.05);
  chain({20, 0, 0, 0, 0}, {BodyTraits{1000, 0}, kPlastic, kPlastic, kPlastic, kPlastic});
  EXPECT_NEAR(kUncertainty * pushes.speed(4), 20, 0.1);
}

TEST_F(PushesTest, WhatIsHeavyAndSlowIsStillFeltWhereWhatIsLightAndFastHasTired) {
  std::vector<double> own(100, 0);
  std::vector<BodyTraits> traits(100, kPlastic);
  own[0] = 20;
  own[1] = 5;
  traits[1] = {1000, 0};
  chain(own, traits);
  EXPECT_GE(pushes.speed(2), 5);
  EXPECT_GE(pushes.speed(99), 4.9);
}

TEST_F(PushesTest, NobodyIsMadeSlower) {
  chain({0, 3, 20, 1, 0, 7}, std::vector(6, kPlastic));
  EXPECT_GE(pushes.speed(1), 3);
  EXPECT_EQ(pushes.speed(2), 20);
  EXPECT_GE(pushes.speed(5), 7);
}

TEST(Push, WhatIsJoinedCoversBoth) {
  Random random("pushes");
  const auto any = [&] {
    const BodyTraits traits{random.chance(0.2) ? 100 : random.between(0.1, 2), random.chance(0.5) ? 0 : 0.5};
    Push push = Push::of(random.between(0, 30), traits, random.between(0.1, 1));
    for (int i = 0; i < 3; ++i) push = push.through(random.between(0, 5));
    return push;
  };
  int covered = 0;
  for (int run = 0; run < 20'000; ++run) {
    const Push a = any(), b = any(), both = a.joined_with(b);
    EXPECT_TRUE(both.covers(a));
    EXPECT_TRUE(both.covers(b));
    for (double more_kg = 0; more_kg < 500; more_kg = 1.3 * more_kg + 0.1) {
      const double most = std::max(a.speed_with(more_kg), b.speed_with(more_kg));
      ASSERT_GE(both.speed_with(more_kg), (1 - 1e-9) * most);
      if (a.covers(b) && b.speed_with(more_kg) > Push::kUnfelt_m_s) {
        ASSERT_GE(a.speed_with(more_kg), (1 - 1e-6) * b.speed_with(more_kg));
      }
    }
    covered += a.covers(b);
  }
  EXPECT_GT(covered, 1000);
}

/// Of two pushes of which neither covers the other, both are passed on as one that covers both: somewhat more than
/// either. Which are joined depends on the order in which they are found (which is the same in every run: by body). So
/// speeds may differ, by a quarter in what is tried here; but in any order, nothing is left to pass on.
TEST_F(PushesTest, AreAtMostAQuarterMoreInAnotherOrderAndCompleteInEach) {
  Random random("order");
  for (int run = 0; run < 200; ++run) {
    const std::uint32_t count = 3 + random.below(40);
    std::vector<double> own(count);
    std::vector<BodyTraits> traits(count, kPlastic);
    for (double& v : own) v = random.chance(0.2) ? random.between(0, 20) : 0;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t i = 0; i < 2 * count; ++i) pairs.emplace_back(random.below(count), random.below(count));
    pushes.begin(own, traits, kUncertainty);
    for (const auto& [a, b] : pairs) pushes.add(a, b, false);
    for (std::uint32_t i = 0; i < count; ++i) pushes.start(i);
    pushes.spread(raised);
    Pushes later;
    later.begin(own, traits, kUncertainty);
    for (auto pair = pairs.rbegin(); pair != pairs.rend(); ++pair) {
      later.add(pair->first, pair->second, false);
      later.start(pair->first);
      later.start(pair->second);
      later.spread(raised);
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      EXPECT_NEAR(pushes.speed(i), later.speed(i), 0.25 * pushes.speed(i) + Push::kUnfelt_m_s) << run << " " << i;
    }
    for (Pushes* found : {&pushes, &later}) {
      raised.clear();
      for (std::uint32_t i = 0; i < count; ++i) found->start(i);
      found->spread(raised);
      EXPECT_TRUE(raised.empty()) << "run " << run;
    }
  }
}

}  // namespace
}  // namespace aurasim::core::testing
