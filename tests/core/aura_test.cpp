// Distances against docs/design.md, "The aura and its reach", and the thesis, paths against an integrator, meetings
// against sampling.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "core/make_aura.h"
#include "core/random.h"
#include "core/round_shapes.h"
#include "core/sphere_aura.h"

namespace aurasim::core::testing {
namespace {

class AuraTest : public ::testing::Test {
 protected:
  std::unique_ptr<const Aura> aura() const { return make_aura(rules, shapes); }
  /// Of rules.kind: kTight or kThesis.
  std::unique_ptr<const SphereAura> spheres() const {
    if (rules.kind == AuraKind::kThesis) return std::make_unique<ThesisAura>(rules, shapes);
    return std::make_unique<TightAura>(rules, shapes);
  }
  double steps_of_v(double metres) const { return metres / (rules.top_speed_m_s * rules.step_s); }
  Path path(const Vec3& p, const Vec3& v) const {
    Path made;
    made.prototype = ball;
    made.radius_m = shapes.bounding_radius(ball);
    made.pose.p_WB = p;
    made.v_WB = v;
    made.speed_m_s = v.norm();
    return made;
  }

  AuraRules rules;
  RoundShapes shapes;
  PrototypeId ball = shapes.sphere(0.5);
};

TEST_F(AuraTest, TheReachesAreThoseOfTheTable) {
  rules.kind = AuraKind::kTight;
  for (const int k : {1, 2, 3, 7}) {
    for (const int s : {1, 2, 4, 10}) {
      rules.lookahead = k;
      rules.substeps = s;
      const double share = 2.0 * (s - 1) / s;
      EXPECT_NEAR(steps_of_v(spheres()->reach(1)), 3 * k - 2 + share, 1e-9);
      EXPECT_NEAR(steps_of_v(spheres()->foreign_reach(1)), 5 * k - 2 + share, 1e-9);
      EXPECT_NEAR(steps_of_v(spheres()->cluster_reach(1)), 4 * k - 3 + share, 1e-9);
    }
  }
}

TEST_F(AuraTest, EveryHopThatAPullCanChainReachesTwoLookaheadsFurther) {
  rules.kind = AuraKind::kTight;
  rules.lookahead = 3;
  for (int hops = 1; hops < 5; ++hops) {
    EXPECT_NEAR(steps_of_v(spheres()->reach(hops + 1) - spheres()->reach(hops)), 6, 1e-9);
    EXPECT_NEAR(steps_of_v(spheres()->foreign_reach(hops + 1) - spheres()->foreign_reach(hops)), 6, 1e-9);
    EXPECT_NEAR(steps_of_v(spheres()->cluster_reach(hops + 1) - spheres()->cluster_reach(hops)), 6, 1e-9);
  }
}

TEST_F(AuraTest, TheThesisNeeds267CentimetresWhereOursNeeds53) {
  rules.frame_s = 0.015;
  rules.latency_s = 0.001;
  rules.top_speed_m_s = 32;
  rules.step_s = 1.0 / 60;
  rules.substeps = 1;
  rules.kind = AuraKind::kThesis;
  EXPECT_NEAR(spheres()->reach(1), 2.67, 0.005);
  rules.kind = AuraKind::kTight;
  EXPECT_NEAR(spheres()->reach(1), 0.53, 0.005);
}

TEST_F(AuraTest, ABodyProjectsWhenItsSurfaceIsWithinReachAndTheLargestForeignRadius) {
  rules.kind = AuraKind::kTight;
  rules.lookahead = 2;
  EXPECT_DOUBLE_EQ(aura()->zone(1, 1, 2, 3), spheres()->reach(1) + 3 + rules.contact_margin_m);
}

TEST_F(AuraTest, SpheresMeetUpToTheReachAndTheContactMargin) {
  rules.kind = AuraKind::kTight;
  rules.substeps = 1;
  const Path own = path(Vec3::Zero(), Vec3::Zero());
  const double meets_at = 1.0 + rules.contact_margin_m + spheres()->reach(1);
  EXPECT_TRUE(aura()->meets(path(Vec3(0, meets_at - 1e-9, 0), Vec3::Zero()), own, 1));
  EXPECT_FALSE(aura()->meets(path(Vec3(0, meets_at + 1e-9, 0), Vec3::Zero()), own, 1));
  rules.lookahead = 2;
  const double links_at = 1.0 + rules.contact_margin_m + spheres()->cluster_reach(1);
  for (const double off : {-1e-9, 1e-9}) {
    const Path other = path(Vec3(links_at + off, 0, 0), Vec3::Zero());
    EXPECT_EQ(aura()->linked(other, own, 1), off < 0);
    EXPECT_EQ(aura()->meets_ghost(other, own, 1), off < 0);
  }
}

TEST_F(AuraTest, TheNaiveControlIsWarnedOfNothing) {
  rules.kind = AuraKind::kNone;
  const Path own = path(Vec3::Zero(), Vec3::Zero());
  EXPECT_FALSE(aura()->meets(own, own, 1));
  EXPECT_FALSE(aura()->linked(own, own, 1));
  EXPECT_FALSE(aura()->meets_ghost(own, own, 1));
}

TEST_F(AuraTest, ABodyFlyingFreelyGoesWhereAnIntegratorPutsIt) {
  Random random("flights");
  for (int run = 0; run < 200; ++run) {
    rules.substeps = 1 + static_cast<int>(random.below(8));
    Path flight = path(random.in_box(100), random.in_box(30));
    flight.age_steps = random.below(5);
    const int steps = static_cast<int>(random.below(30));
    Vec3 p = flight.pose.p_WB;
    Vec3 v = flight.v_WB;
    const double h = rules.step_s / rules.substeps;
    for (int i = 0; i < (static_cast<int>(flight.age_steps) + steps) * rules.substeps; ++i) {
      v += rules.gravity * h;  // speed before place, as Bullet does
      p += v * h;
    }
    EXPECT_LT((aura()->ahead(flight, steps).p_WB - p).norm(), 1e-9);
  }
}

TEST_F(AuraTest, ASpinningBodyKeepsItsSpin) {
  Path top = path(Vec3::Zero(), Vec3::Zero());
  top.w_WB = Vec3(0, 0, 60 * std::numbers::pi / 2);  // a quarter turn each step
  top.age_steps = 1;
  const Quat q = aura()->ahead(top, 2).q_WB;
  EXPECT_LT((q * Vec3::UnitX() + Vec3::UnitY()).norm(), 1e-9);
}

TEST_F(AuraTest, ASleepingBodyStaysWhereItIs) {
  Path asleep = path(Vec3(1, 2, 3), Vec3(4, 5, 6));
  asleep.moves = false;
  asleep.age_steps = 5;
  EXPECT_EQ(aura()->ahead(asleep, 10).p_WB, Vec3(1, 2, 3));
}

TEST_F(AuraTest, ABodyThatIsNotBornYetStartsFromItsPlaceOfBirth) {
  rules.gravity = Vec3::Zero();
  Path unborn = path(Vec3::Zero(), Vec3(60, 0, 0));
  unborn.unborn_steps = 3;
  EXPECT_EQ(aura()->ahead(unborn, 2).p_WB, Vec3::Zero());
  EXPECT_EQ(aura()->ahead(unborn, 3).p_WB, Vec3::Zero());
  EXPECT_LT((aura()->ahead(unborn, 5).p_WB - Vec3(2, 0, 0)).norm(), 1e-12);
  unborn.age_steps = 4;
  EXPECT_LT((aura()->ahead(unborn, 5).p_WB - Vec3(2, 0, 0)).norm(), 1e-12);
}

TEST_F(AuraTest, TheSpeedOfABodyIsItsOwnAndALittle) {
  BodyState falling;
  falling.v_WB = Vec3(3, 4, 0);
  const double v = aura()->speed_of(falling);
  EXPECT_GT(v, 5);
  EXPECT_LT(v, 5.2);
  falling.awake = false;
  EXPECT_LT(aura()->speed_of(falling), 0.1);
  rules.kind = AuraKind::kTight;
  EXPECT_EQ(aura()->speed_of(falling), rules.top_speed_m_s);
}

class SweptMeeting : public AuraTest {
 protected:
  Path random_path(Random& random, double box) {
    Path made = path(random.in_box(box), random.in_box(20));
    made.prototype = kinds[random.below(3)];
    made.radius_m = shapes.bounding_radius(made.prototype);
    made.w_WB = random.chance(0.5) ? Vec3(Vec3::Zero()) : Vec3(random.in_box(20));
    made.moves = random.chance(0.9);
    if (!made.moves) made.v_WB = made.w_WB = Vec3::Zero();
    made.age_steps = random.below(4);
    made.unborn_steps = random.chance(0.1) ? random.below(4) : 0;
    made.speed_m_s = made.v_WB.norm() + random.between(0, 3);
    return made;
  }

  /// Room left at the tightest substep instant of the next `horizon` states: negative if they can touch.
  double room(const Path& a, const Path& b, int horizon) const {
    double least = 1e300;
    for (int i = 0; i < horizon * rules.substeps; ++i) {
      const double k = static_cast<double>(i) / rules.substeps;
      if (k + 1e-9 < std::max(a.unborn_steps, b.unborn_steps)) continue;
      const double spread =
          rules.uncertainty * rules.step_s * (a.speed_m_s * (a.age_steps + k) + b.speed_m_s * (b.age_steps + k));
      const double gap = shapes.clearance(a.prototype, aura()->ahead(a, k), b.prototype, aura()->ahead(b, k), 1e300);
      const double t = rules.step_s * std::max(a.moves ? a.age_steps + k : 0, b.moves ? b.age_steps + k : 0);
      const double fall = 0.5 * rules.gravity.norm() * t * (t + rules.step_s);
      least = std::min(least, gap - rules.contact_margin_m - spread - fall);
    }
    return least;
  }

  PrototypeId kinds[3] = {ball, shapes.dumbbell(0.2, 0.8), shapes.sphere(2)};
};

TEST_F(SweptMeeting, IsSeenExactlyWhenSamplingEverySubstepSeesIt) {
  Random random("meetings");
  int met = 0, near_misses = 0;
  for (int run = 0; run < 60000; ++run) {
    rules.lookahead = 1 + static_cast<int>(random.below(3));
    rules.substeps = 1 + static_cast<int>(random.below(6));
    rules.uncertainty = random.chance(0.2) ? 0 : 0.5;
    const int hops = 1 + static_cast<int>(random.below(3));
    const Path a = random_path(random, 4);
    const Path b = random_path(random, 4);
    const double left = room(a, b, hops * rules.lookahead);
    if (std::abs(left) < 1e-9) continue;
    met += left < 0;
    near_misses += left > 0 && left < 0.5;
    ASSERT_EQ(aura()->meets(a, b, hops), left < 0) << "run " << run << ", room " << left;
    ASSERT_EQ(aura()->meets(b, a, hops), left < 0) << "run " << run << ", room " << left;
  }
  std::printf("[  counts  ] %d met, %d near misses\n", met, near_misses);
  EXPECT_GT(met, 10000);
  EXPECT_GT(near_misses, 1000);
}

TEST_F(SweptMeeting, LinksLookAheadAtLeastAsFarAsAuras) {
  Random random("links");
  for (int run = 0; run < 5000; ++run) {
    rules.lookahead = 1 + static_cast<int>(random.below(3));
    Path a = random_path(random, 4);
    Path b = random_path(random, 4);
    a.age_steps = b.age_steps = 0;
    ASSERT_TRUE(!aura()->meets(a, b, 1) || aura()->linked(a, b, 1));
  }
}

TEST_F(SweptMeeting, LinkRangeHoldsAllLinks) {
  Random random("links");
  int linked = 0;
  for (int run = 0; run < 20000; ++run) {
    rules.lookahead = 1 + static_cast<int>(random.below(3));
    const int hops = 1 + static_cast<int>(random.below(3));
    Path a = random_path(random, 6);
    Path b = random_path(random, 6);
    a.age_steps = b.age_steps = 0;
    if (!aura()->linked(a, b, hops)) continue;
    ++linked;
    const double apart = (a.pose.p_WB - b.pose.p_WB).norm() - a.radius_m - b.radius_m;
    ASSERT_LE(apart, aura()->link_range(hops).at(a.speed_m_s + b.speed_m_s) + 1e-9);
  }
  EXPECT_GT(linked, 1000);
}

/// Whoever meets a foreign body has been within the notice distance of it all the while before that counts.
TEST_F(SweptMeeting, NoticeHoldsAllMeetings) {
  Random random("meetings");
  int met = 0;
  for (int run = 0; run < 20000; ++run) {
    rules.lookahead = 1 + static_cast<int>(random.below(3));
    rules.gravity = Vec3::Zero();  // both speeds already hold what gravity adds
    Path foreign = random_path(random, 6);
    Path own = random_path(random, 6);
    own.age_steps = 0;
    if (!aura()->meets(foreign, own, 1)) continue;
    ++met;
    const double apart = (foreign.pose.p_WB - own.pose.p_WB).norm() - foreign.radius_m - own.radius_m;
    ASSERT_LE(apart, aura()->notice(foreign.speed_m_s, foreign.age_steps, 1).at(own.speed_m_s) + 1e-9);
  }
  EXPECT_GT(met, 500);
}

}  // namespace
}  // namespace aurasim::core::testing
