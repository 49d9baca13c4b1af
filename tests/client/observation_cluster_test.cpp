// Simulated clusters: real protocol, real physics, virtual time. What an observer puts together of their nodes is,
// state by state and bit by bit, what it is told of the same world on one node, also of bodies between two hosts.
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "agent/merged_states.h"
#include "cluster/checked_run.h"
#include "cluster/scenes.h"
#include "node/observation_feed.h"
#include "physics/state_hash.h"

namespace aurasim::agent {
namespace {

using core::RegionId;
using core::Step;

constexpr double kCell = 9;
constexpr Step kSteps = 150;

class Watched {
 public:
  Watched(const core::Scene& scene, const test::ClusterOptions& options, core::Interest interest)
      : interest_(std::move(interest)),
        lookahead_(options.aura.lookahead),
        states_({.latest_steps = 2 * options.aura.lookahead + 2, .patience_s = 1e9}),
        sim_(scene, options) {
    for (std::uint32_t r = 0; r < options.map.size(); ++r) {
      regions_.insert(RegionId{r});
      feeds_.emplace_back(node::FeedSettings{RegionId{r}, 0, 1, lookahead_}, scene);
    }
    sim_.on_state = [this](node::Node& node, const node::StepReport& report, double) { tell(node, report); };
  }

  test::Outcome run() { return sim_.run(kSteps); }

  std::map<Step, MergedState> seen;
  std::size_t made_up = 0;   ///< rows
  std::size_t foreseen = 0;  ///< rows that were made up later, and have been compared

 private:
  /// What would be told if the run stood now is what will be made up.
  void compare_foreseen(node::Node& node, const node::StepReport& report) {
    std::map<std::pair<Step, core::BodyId>, core::BodyRecord>& ahead = ahead_[core::value_of(node.region())];
    if (report.put_back_from) ahead.clear();
    for (const node::MadeUp& state : report.made_up) {
      for (const core::BodyRecord& body : state.bodies) {
        const auto before = ahead.find({state.step, body.id});
        if (before == ahead.end()) continue;
        ++foreseen;
        EXPECT_EQ(physics::state_hash(before->second), physics::state_hash(body))
            << "state " << state.step << ", body " << core::value_of(body.id);
      }
    }
    for (const node::MadeUp& state : node.foresee()) {
      for (const core::BodyRecord& body : state.bodies) ahead.insert_or_assign({state.step, body.id}, body);
    }
  }

  void tell(node::Node& node, const node::StepReport& report) {
    compare_foreseen(node, report);
    node::ObservationFeed& feed = feeds_[core::value_of(node.region())];
    node.observe(true, interest_.contacts);
    const auto& open = node.protocol().departures().open();
    if (report.put_back_from) {
      feed.begin(report.step, open);
      return;
    }
    feed.note(report, open);
    for (const node::MadeUp& state : report.made_up) {
      if (interest_.is_for(state.step)) accept(feed.compose(interest_, state, node.redos()));
    }
    if (!interest_.is_for(report.step)) return;
    accept(feed.compose(interest_, node.world().snapshot(), node.world().contact_impulses(), node.redos()));
  }

  void accept(core::Observation observation) {
    if (observation.kind == core::Observation::Kind::kMadeUp) made_up += observation.bodies.size();
    states_.accept(std::move(observation), 0);
    for (MergedState& state : states_.take(regions_, 0)) seen.insert_or_assign(state.step, std::move(state));
  }

  core::Interest interest_;
  int lookahead_;
  std::set<RegionId> regions_;
  std::vector<node::ObservationFeed> feeds_;
  std::map<std::uint32_t, std::map<std::pair<Step, core::BodyId>, core::BodyRecord>> ahead_;
  MergedStates states_;
  test::CheckedRun sim_;
};

/// Where, or nothing. Host and epoch are no matter of the world's.
std::string first_difference(const MergedState& a, const MergedState& b) {
  std::ostringstream where;
  where << "state " << a.step << ": ";
  if (!a.is_complete() || !b.is_complete()) return where.str() + "incomplete";
  if (a.bodies.size() != b.bodies.size()) return where.str() + "number of bodies";
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const core::ReplicaBody &x = a.bodies[i].row, &y = b.bodies[i].row;
    const bool same = x.id == y.id && x.prototype == y.prototype && x.asleep == y.asleep && x.p_WB == y.p_WB &&
                      x.q_WB.coeffs() == y.q_WB.coeffs() && x.v_WB == y.v_WB && x.w_WB == y.w_WB;
    where << "body " << core::value_of(x.id);
    if (!same) return where.str();
    where.str("");
    where << "state " << a.step << ": ";
  }
  if (a.contacts.size() != b.contacts.size()) return where.str() + "number of contacts";
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    const core::ContactImpulse &x = a.contacts[i], &y = b.contacts[i];
    if (x.a != y.a || x.b != y.b || x.p_W != y.p_W || x.normal_W != y.normal_W || x.impulse_Ns != y.impulse_Ns) {
      where << "contact " << x.a << " with " << x.b;
      return where.str();
    }
  }
  return {};
}

test::ClusterOptions options_for(int seed) {
  test::ClusterOptions options;
  options.sync = core::SyncMode::kDeterministic;
  options.seed = static_cast<std::uint64_t>(seed);
  options.map = core::RegionMap::grid(2, 2, kCell, kCell);
  options.aura.lookahead = 1 + seed % 3;
  options.aura.top_speed_m_s = 40;
  options.aura.redo = true;
  options.bandwidth_B_s = lab::kUnlimited_B_s;
  options.physics.solver = seed % 2 == 0 ? physics::Solver::kSoftStep : physics::Solver::kSequentialImpulse;
  options.network.latency_s = 0.004 * (seed % 5);
  options.network.jitter_s = 0.004 * (seed % 3);
  return options;
}

const int kLastSeed = test::seeds_or(6);

class Observation : public testing::TestWithParam<int> {
 protected:
  /// Of every state that both have: at least all but those at the very end, which wait for bodies under way.
  void expect_the_same(const core::Interest& interest, core::AuraKind auras = core::AuraKind::kSwept) {
    const core::Scene scene = test::thrown_bodies(40, 2 * kCell, 2 * kCell, 12, static_cast<std::uint64_t>(GetParam()));
    test::ClusterOptions options = options_for(GetParam());
    options.aura.kind = auras;
    Watched apart(scene, options, interest);
    const test::Outcome outcome = apart.run();
    options.map = core::RegionMap::columns(1, 1);
    Watched together(scene, options, interest);
    together.run();
    EXPECT_GT(outcome.hand_offs, 0U) << "or this test proves nothing";
    if (interest.all && options.aura.lookahead > 1) {
      EXPECT_GT(apart.made_up, 0U);
      foreseen_of_all_ += apart.foreseen;
    }
    redos_ = outcome.redos;
    if (GetParam() == kLastSeed) {
      EXPECT_GT(foreseen_of_all_, 0U) << "or this test proves nothing of what is told while the run stands";
    }
    std::size_t compared = 0, contacts = 0;
    for (const auto& [step, state] : apart.seen) {
      const auto other = together.seen.find(step);
      if (other == together.seen.end()) continue;
      ASSERT_EQ(first_difference(state, other->second), "");
      ++compared;
      contacts += state.contacts.size();
    }
    EXPECT_GE(compared, static_cast<std::size_t>((kSteps - 20) / interest.every));
    if (interest.contacts) {
      EXPECT_GT(contacts, 0U);
    }
    std::cout << compared << " states, " << outcome.hand_offs << " hand-offs, " << apart.made_up << " rows made up, "
              << contacts << " contacts, " << outcome.redos << " redos\n";
  }

  std::uint64_t redos_ = 0;
  static inline std::uint64_t redos_of_all_ = 0, foreseen_of_all_ = 0;
};

TEST_P(Observation, OfAllBodiesIsThatOfOneNode) {
  core::Interest interest;
  interest.all = true;
  interest.contacts = true;
  expect_the_same(interest);
}

TEST_P(Observation, OfABoxAcrossBordersIsThatOfOneNode) {
  core::Interest interest;
  interest.boxes = {{{-4, -3, -1}, {3, 5, 4}}};
  interest.contacts = true;
  interest.every = 3;
  expect_the_same(interest);
}

/// Without auras much is computed twice: what was told of it before does not count.
TEST_P(Observation, AfterRedosIsThatOfOneNode) {
  core::Interest interest;
  interest.all = true;
  expect_the_same(interest, core::AuraKind::kNone);
  redos_of_all_ += redos_;
  if (GetParam() == kLastSeed) {
    EXPECT_GT(redos_of_all_, 0U) << "or this test proves nothing";
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Observation, testing::Range(1, kLastSeed + 1));

}  // namespace
}  // namespace aurasim::agent
