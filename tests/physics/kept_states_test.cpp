// A world looks at changed bodies only for its snapshots and hashes. What it keeps of the others must be what they are.
#include <algorithm>
#include <random>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "physics/goes_back.h"

namespace aurasim::physics::testing {
namespace {

class KeptStates : public ::testing::TestWithParam<std::tuple<Solver, bool>> {
 protected:
  static Settings settings() {
    Settings settings;
    settings.solver = std::get<0>(GetParam());
    settings.continuous = std::get<1>(GetParam());
    settings.block_m = 5;
    return settings;
  }
};

bool same_state(const core::BodyState& a, const core::BodyState& b) {
  return a.id == b.id && a.epoch == b.epoch && a.prototype == b.prototype && a.awake == b.awake && a.birth == b.birth &&
         a.pose.p_WB == b.pose.p_WB && a.pose.q_WB.coeffs() == b.pose.q_WB.coeffs() && a.v_WB == b.v_WB &&
         a.w_WB == b.w_WB && a.coming_kick_m_s == b.coming_kick_m_s;
}

bool same_contacts(std::span<const core::Contact> a, std::span<const core::Contact> b) {
  return std::ranges::equal(a, b, [](const auto& x, const auto& y) { return x.a == y.a && x.b == y.b; });
}

/// Compares what a world shows of its bodies with what it shows once it has looked at all of them.
class Shown {
 public:
  explicit Shown(GoesBack& run) : run_(run), random_(run.random()) {}

  void look() {
    if (::testing::Test::HasFatalFailure() || random_() % 8 == 0) return;
    RegionWorld& world = run_.world;
    ASSERT_EQ(world.hash_sum(), hash_sum(world.records()));
    expect_only_changes(world.snapshot());
    shown_ = world.snapshot();
    expect_whole_copy();
    if (random_() % 6 == 0) look_at_all();
  }

  std::size_t kept = 0, compared = 0, shared = 0;

 private:
  void expect_whole_copy() {
    if (random_() % 3 == 0) return;
    run_.world.copy_all(copy_);
    if (copy_.before) shared += copy_.before->bodies.size() - copy_.replaced.size();
    const core::ClusterState is = core::whole(copy_), wanted = run_.world.peek_all();
    ASSERT_EQ(ids_of(is.bodies), ids_of(wanted.bodies));
    ASSERT_TRUE(different(is.bodies, wanted.bodies).empty());
    ASSERT_TRUE(std::ranges::equal(is.bodies, wanted.bodies, {}, &core::BodyRecord::epoch, &core::BodyRecord::epoch));
    ASSERT_TRUE(same_rows(is, wanted));
  }

  /// Whatever the snapshot does not call changed is as it was.
  void expect_only_changes(const core::Snapshot& now) {
    if (!now.goes_on_from(shown_.number)) return;
    ASSERT_TRUE(std::ranges::is_sorted(now.changed));
    const auto has_changed = [&](std::uint32_t i) { return std::ranges::binary_search(now.changed, i); };
    ASSERT_EQ(now.bodies.size(), shown_.bodies.size());
    for (std::uint32_t i = 0; i < now.bodies.size(); ++i) {
      if (has_changed(i)) continue;
      ++kept;
      ASSERT_TRUE(same_state(now.bodies[i], shown_.bodies[i])) << core::value_of(now.bodies[i].id);
    }
    const auto is_in = [](const core::Contact& contact, std::span<const core::Contact> contacts) {
      return std::ranges::any_of(contacts, [&](const auto& c) { return c.a == contact.a && c.b == contact.b; });
    };
    for (const core::Contact& contact : now.contacts) {
      if (is_in(contact, shown_.contacts)) continue;
      ASSERT_TRUE(is_in(contact, now.changed_contacts) && (has_changed(contact.a) || has_changed(contact.b)));
    }
    for (const core::Contact& contact : shown_.contacts) {
      if (is_in(contact, now.contacts)) continue;
      ASSERT_TRUE(has_changed(contact.a) || has_changed(contact.b));
    }
    ASSERT_TRUE(same_contacts(now.joints, shown_.joints));
  }

  /// A body that comes and goes changes nothing of the others.
  void look_at_all() {
    const core::BodyRecord stranger = body(1'000'000, kBox, {1000, 1000, 0.5});
    run_.world.add({&stranger, 1});
    ASSERT_EQ(run_.world.snapshot().bodies.size(), shown_.bodies.size() + 1);
    run_.world.release({&stranger.id, 1});
    expect_as_shown(run_.world.snapshot());
    expect_all(run_.world.peek_all(), run_.world.snapshot());
  }

  /// Copies of all bodies have what the snapshot has.
  void expect_all(const core::ClusterState& all, const core::Snapshot& now) {
    ASSERT_EQ(all.bodies.size(), now.bodies.size());
    for (std::size_t i = 0; i < all.bodies.size(); ++i) {
      core::BodyState wanted = core::state_of(all.bodies[i]);
      wanted.coming_kick_m_s = now.bodies[i].coming_kick_m_s;
      wanted.awake = wanted.awake || wanted.coming_kick_m_s > 0;
      ASSERT_TRUE(same_state(now.bodies[i], wanted)) << core::value_of(wanted.id);
    }
    std::set<std::pair<core::ObjectRef, core::ObjectRef>> pairs;
    for (const core::ManifoldRecord& m : all.manifolds) {
      if (std::min(m.object0, m.object1) >= 0) pairs.insert(std::minmax(m.object0, m.object1));
    }
    ASSERT_EQ(pairs.size(), now.contacts.size());
    for (const core::Contact& contact : now.contacts) {
      ASSERT_TRUE(pairs.contains({core::ref_of(now.bodies[contact.a].id), core::ref_of(now.bodies[contact.b].id)}));
    }
  }

  void expect_as_shown(const core::Snapshot& all) {
    ASSERT_FALSE(all.goes_on);
    ASSERT_TRUE(std::ranges::equal(shown_.bodies, all.bodies, same_state));
    ASSERT_TRUE(same_contacts(shown_.contacts, all.contacts));
    ASSERT_TRUE(same_contacts(shown_.joints, all.joints));
    ASSERT_EQ(shown_.born, all.born);
    ASSERT_EQ(shown_.awake, all.awake);
    ASSERT_EQ(run_.world.hash_sum(), hash_sum(run_.world.records()));
    ++compared;
  }

  GoesBack& run_;
  std::mt19937_64 random_;
  core::Snapshot shown_;
  core::ChangedState copy_;
};

/// Whatever comes, leaves, is born, breaks, sleeps, wakes, is ordered, pushed, and goes back: what a world keeps of its
/// bodies is what they are.
TEST_P(KeptStates, AreWhatTheBodiesAre) {
  std::size_t kept = 0, compared = 0, shared = 0;
  for (int seed = 10; seed < (settings().looks_once() ? 26 : 11); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    GoesBack run(settings(), seed);
    Shown shown(run);
    run.after_step = [&] { shown.look(); };
    for (int round = 0; round < 5; ++round) {
      run.run_on(5 + static_cast<int>(run.pick(60)));
      const core::ClusterState then = run.world.peek_all();
      const core::Step step = run.world.step_number();
      run.run_astray(10 + static_cast<int>(run.pick(40)), round % 2 == 0 ? 0 : 250);
      for (int i = 0; i < 40; ++i) {  // most bodies sleep now
        run.hand_over();
        run.run_on(2);
        run.take_back();
        run.run_on(3);
      }
      run.world.put_back(step, then);
      shown.look();
      if (HasFatalFailure()) return;
    }
    kept += shown.kept, compared += shown.compared, shared += shown.shared;
  }
  EXPECT_GT(compared, 50U);
  EXPECT_TRUE(shared > 1000 || !settings().looks_once()) << shared;
  EXPECT_TRUE(kept > 5000 || !settings().looks_once()) << kept;
}

INSTANTIATE_TEST_SUITE_P(Solvers, KeptStates,
                         ::testing::Combine(::testing::Values(Solver::kSequentialImpulse, Solver::kSoftStep),
                                            ::testing::Bool()),
                         solver_name);

}  // namespace
}  // namespace aurasim::physics::testing
