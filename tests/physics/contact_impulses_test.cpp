// What presses on what, for whoever wants to know: right, and without a trace in what is computed.
#include <cmath>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::ContactImpulse;

constexpr double kWeight_Ns = 9.81 / 60;  // of 1 kg, in a step

class Impulses : public ::testing::TestWithParam<Solver> {
 protected:
  Impulses() { settings.solver = GetParam(); }

  static double sum(const std::vector<ContactImpulse>& contacts, core::ObjectRef a, core::ObjectRef b) {
    double sum = 0;
    for (const ContactImpulse& contact : contacts) sum += contact.a == a && contact.b == b ? contact.impulse_Ns : 0;
    return sum;
  }

  core::Scene scene = scene_of_all_shapes();
  Settings settings;
};

TEST_P(Impulses, OfAStackAtRestAreItsWeights) {
  RegionWorld world(scene, settings);
  world.watch_contacts(true);
  world.add(stack(10, 3, 0, 0));
  double on_ground = 0, on_first = 0, on_second = 0;
  constexpr int kSteps = 20;
  run(world, 20);  // the first touch is over
  for (int i = 0; i < kSteps; ++i) {
    world.step();
    on_ground += sum(world.contact_impulses(), 10, -1) / kSteps;
    on_first += sum(world.contact_impulses(), 10, 11) / kSteps;
    on_second += sum(world.contact_impulses(), 11, 12) / kSteps;
  }
  EXPECT_NEAR(on_ground, 3 * kWeight_Ns, 0.3 * kWeight_Ns);
  EXPECT_NEAR(on_first, 2 * kWeight_Ns, 0.3 * kWeight_Ns);
  EXPECT_NEAR(on_second, kWeight_Ns, 0.3 * kWeight_Ns);
}

TEST_P(Impulses, OfABlowAreTheMomentumThatItTakes) {
  scene.gravity.setZero();
  RegionWorld world(scene, settings);
  world.watch_contacts(true);
  world.add(std::vector{body(1, kSphere, {-1, 0, 5}, {3, 0, 0}), body(2, kSphere, {1, 0, 5}, {-3, 0, 0})});
  double total = 0;
  core::Vec3 normal = core::Vec3::Zero(), p = core::Vec3::Zero();
  for (int i = 0; i < 60; ++i) {
    world.step();
    for (const ContactImpulse& contact : world.contact_impulses()) {
      EXPECT_EQ(contact.a, 1);
      EXPECT_EQ(contact.b, 2);
      total += contact.impulse_Ns;
      normal = contact.normal_W;
      p = contact.p_W;
    }
  }
  const double after_m_s = world.snapshot().bodies[0].v_WB.x();  // overlaps are pushed apart
  EXPECT_LT(after_m_s, 0.1);
  EXPECT_NEAR(total, 3 - after_m_s, 0.05);  // 1 kg, less what damping took
  EXPECT_NEAR(normal.x(), 1, 1e-5) << "from 1 to 2";
  EXPECT_NEAR(p.x(), 0, 0.06);
  EXPECT_NEAR(p.z(), 5, 1e-5);
}

TEST_P(Impulses, ChangeNoBit) {
  std::mt19937_64 random{5};
  const std::vector<core::BodyRecord> bodies = pile(random, 1, 40, 0, 0);
  RegionWorld watched(scene, settings), alone(scene, settings);
  watched.watch_contacts(true);
  watched.add(bodies);
  alone.add(bodies);
  std::size_t seen = 0;
  for (int i = 0; i < 150; ++i) {
    watched.step();
    alone.step();
    seen += watched.contact_impulses().size();
    EXPECT_TRUE(alone.contact_impulses().empty());
  }
  EXPECT_GT(seen, 500U);
  EXPECT_TRUE(different(watched.records(), alone.records()).empty());
}

TEST_P(Impulses, OfStatesMadeUpAreThoseOfTheWorldThatWasLeft) {
  RegionWorld from(scene, settings), to(scene, settings);
  to.watch_contacts(true);
  from.watch_contacts(true);
  from.add(stack(10, 3, 0, 0));
  run(from, 10);
  const core::ClusterState cluster = from.peek_all();
  std::vector<std::vector<ContactImpulse>> expected;
  for (int i = 0; i < 4; ++i) {
    from.step();
    expected.push_back(from.contact_impulses());
  }
  run(to, 14);
  to.adopt(cluster, 10);
  const std::vector<MadeUpContacts> made_up = to.take_made_up_contacts();
  ASSERT_EQ(made_up.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(made_up[i].step, static_cast<core::Step>(11 + i));
    ASSERT_EQ(made_up[i].contacts.size(), expected[i].size());
    for (std::size_t k = 0; k < expected[i].size(); ++k) {
      EXPECT_EQ(made_up[i].contacts[k].impulse_Ns, expected[i][k].impulse_Ns);
      EXPECT_EQ(made_up[i].contacts[k].p_W, expected[i][k].p_W);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, Impulses, ::testing::Values(Solver::kSequentialImpulse, Solver::kSoftStep),
                         [](const auto& info) {
                           return info.param == Solver::kSoftStep ? "SoftStep" : "SequentialImpulse";
                         });

}  // namespace
}  // namespace aurasim::physics::testing
