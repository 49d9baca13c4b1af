// Where a snapshot names what has changed, the protocol looks at nothing else but what is near others. It must come to
// the same as a protocol that looks at all bodies in each state.
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/letters.h"
#include "core/protocol.h"
#include "core/random.h"
#include "core/round_shapes.h"

namespace aurasim::core::testing {
namespace {

struct Rules {
  AuraKind kind;
  bool redo;
  int lookahead;
};

/// Region 1 of three, whose bodies wake, move, touch and fall asleep at random, beside bodies of regions 0 and 2.
class TwoLooks {
 public:
  TwoLooks(const Rules& rules, std::uint64_t seed) : random_("kept matching", seed) {
    settings_.self = region(1);
    settings_.aura.kind = rules.kind;
    settings_.aura.redo = rules.redo;
    settings_.aura.lookahead = rules.lookahead;
    settings_.aura.top_speed_m_s = 12;
    settings_.neighbour_distance_m = 1e9;
    settings_.sync = SyncMode::kDeterministic;
    for (std::uint64_t i = 0; i < 12; ++i) settings_.together.push_back({body(3 * i), body(500 + i), 30});
    for (std::uint64_t i = 0; i < 4; ++i) settings_.together.push_back({body(7 * i), body(7 * i + 40), 60});
    std::ranges::sort(settings_.together, {}, [](const TogetherPair& pair) { return std::pair(pair.a, pair.b); });
    keeps_.emplace(settings_, map_, shapes_);
    looks_.emplace(settings_, map_, shapes_);
    for (std::uint64_t i = 0; i < 150; ++i) add(i);
    for (std::uint64_t i = 0; i < 40; ++i) foreign_[500 + i] = {random_.chance(0.5) ? 0U : 2U, somewhere_else()};
    observe();
  }

  void pass_step() {
    ++now_;
    publish_others();
    for (std::optional<Protocol>* protocol : {&keeps_, &looks_}) (*protocol)->receive(now_);
    move();
    observe();
    if (!::testing::Test::HasFatalFailure()) compare();
    release();
  }

  std::size_t kept = 0, departed = 0, alarms = 0, projecting = 0;

 private:
  struct Other {
    std::uint32_t host;
    Vec3 p;
    bool is_known = false;
  };

  Vec3 somewhere() { return {random_.between(-21, 21), random_.between(-30, 30), 0.5}; }
  Vec3 somewhere_else() {
    return {(random_.chance(0.5) ? 1 : -1) * random_.between(16, 30), random_.between(-30, 30), 0.5};
  }

  void add(std::uint64_t id) {
    BodyState& state = snapshot_.bodies.emplace_back();
    state.id = body(id);
    state.prototype = random_.chance(0.1) ? large_ : ball_;
    state.pose.p_WB = somewhere();
    state.awake = random_.chance(0.3);
    if (state.awake) state.v_WB = 3 * random_.direction();
  }

  void publish_others() {
    Inbox inbox;
    for (const std::uint32_t host : {0U, 2U}) {
      AuraBatch out = batch(host, now_ - 1);
      out.map_version = map_.version();
      out.generation = settings_.generation;
      out.top_speed_m_s = 5;
      out.top_radius_m = 1;
      for (auto& [id, other] : foreign_) {
        if (other.host != host) continue;
        const bool moves = random_.chance(0.3);
        if (moves) other.p += Vec3(random_.between(-0.3, 0.3), random_.between(-0.3, 0.3), 0);
        if (other.is_known && random_.chance(0.02)) {
          out.deletes.push_back(body(id));
          other.is_known = false;
        } else if (!other.is_known || moves) {
          AuraRecord record = aura(id, 0);
          record.host = region(host);
          record.prototype = ball_;
          record.stamp = now_ - 1;
          record.pose.p_WB = other.p;
          record.speed_m_s = moves ? 2 : 0.05;
          record.flags = moves ? 0 : kAuraAsleep;
          if (moves) record.v_WB = {random_.between(-2, 2), 0, 0};
          out.updates.push_back(record);
          other.is_known = true;
        }
      }
      inbox.auras.push_back(out);
    }
    Inbox copy = inbox;
    keeps_->accept(inbox);
    looks_->accept(copy);
  }

  void move() {
    changed_.clear();
    for (std::uint32_t i = 0; i < snapshot_.bodies.size(); ++i) {
      BodyState& state = snapshot_.bodies[i];
      const bool was_awake = state.awake;
      if (random_.chance(was_awake ? 0.05 : 0.01)) {
        state.awake = !was_awake;
        state.v_WB = state.awake ? Vec3(random_.between(0.5, 8) * random_.direction()) : Vec3(Vec3::Zero());
        state.v_WB.z() = 0;
      }
      if (state.awake) state.pose.p_WB += state.v_WB / 60;
      if (was_awake || state.awake) changed_.push_back(i);
    }
  }

  void look_at_contacts() {
    snapshot_.contacts.clear();
    snapshot_.joints.clear();
    for (std::uint32_t i = 0; i < snapshot_.bodies.size(); ++i) {
      for (std::uint32_t j = i + 1; j < snapshot_.bodies.size(); ++j) {
        const BodyState &a = snapshot_.bodies[i], &b = snapshot_.bodies[j];
        if ((a.pose.p_WB - b.pose.p_WB).norm() < 1) snapshot_.contacts.push_back({i, j});
        if (value_of(a.id) + 3 == value_of(b.id) && value_of(a.id) % 10 == 0) snapshot_.joints.push_back({i, j});
      }
    }
  }

  void observe() {
    look_at_contacts();
    snapshot_.step = now_;
    ++snapshot_.number;
    snapshot_.goes_on = goes_on_;
    snapshot_.changed = changed_;
    snapshot_.changed_contacts.clear();
    const auto has_changed = [&](std::uint32_t i) { return std::ranges::binary_search(changed_, i); };
    for (const Contact& c : snapshot_.contacts) {
      if (has_changed(c.a) || has_changed(c.b)) snapshot_.changed_contacts.push_back(c);
    }
    if (goes_on_) kept += snapshot_.bodies.size() - changed_.size();
    goes_on_ = true;
    departing_ = keeps_->observe(snapshot_);
    Snapshot unnumbered = snapshot_;
    unnumbered.number = 0;
    const std::vector<Departure>& wanted = looks_->observe(unnumbered);
    ASSERT_TRUE(std::ranges::equal(departing_, wanted, [](const Departure& a, const Departure& b) {
      return a.destination == b.destination && a.reason == b.reason && a.bodies == b.bodies;
    }));
  }

  /// Bodies that leave are replaced by others now and then.
  void release() {
    std::set<BodyId> gone;
    for (const Departure& departure : departing_) {
      ClusterState cluster;
      for (const BodyId id : departure.bodies) {
        cluster.bodies.push_back(record_of(value_of(id), 0));
        gone.insert(id);
      }
      keeps_->hand_over(departure, cluster);
      looks_->hand_over(departure, std::move(cluster));
    }
    departed += gone.size();
    std::erase_if(snapshot_.bodies, [&](const BodyState& state) { return gone.contains(state.id); });
    goes_on_ = gone.empty();
    if (random_.chance(0.05)) {
      add(1000 + static_cast<std::uint64_t>(now_));
      goes_on_ = false;
    }
  }

  void compare() {
    SCOPED_TRACE(::testing::Message() << "state " << now_);
    const AuraBatch &is = keeps_->outbox().aura, &wanted = looks_->outbox().aura;
    ASSERT_TRUE(std::ranges::equal(is.updates, wanted.updates, [](const AuraRecord& a, const AuraRecord& b) {
      return a.id == b.id && a.epoch == b.epoch && a.host == b.host && a.flags == b.flags && a.stamp == b.stamp &&
             a.pose.p_WB == b.pose.p_WB && a.v_WB == b.v_WB && a.speed_m_s == b.speed_m_s && a.audience == b.audience;
    }));
    ASSERT_EQ(is.deletes, wanted.deletes);
    ASSERT_EQ(is.top_speed_m_s, wanted.top_speed_m_s);
    ASSERT_EQ(is.top_radius_m, wanted.top_radius_m);
    ASSERT_EQ(is.violations, wanted.violations);
    ASSERT_EQ(keeps_->projection().projecting(), looks_->projection().projecting());
    ASSERT_EQ(keeps_->projection().counters().bad_phase_changes, looks_->projection().counters().bad_phase_changes);
    ASSERT_EQ(keeps_->largest_cluster(), looks_->largest_cluster());
    const auto alarm = [](const Alarm& a) { return std::tuple(a.step, a.a, a.b); };
    const auto list = [](std::span<const Alarm> standing) {
      return std::vector<Alarm>(standing.begin(), standing.end());
    };
    std::vector<Alarm> raised = list(keeps_->alarms().standing()), wanted_alarms = list(looks_->alarms().standing());
    std::ranges::sort(raised, {}, alarm), std::ranges::sort(wanted_alarms, {}, alarm);
    ASSERT_TRUE(std::ranges::equal(raised, wanted_alarms, {}, alarm, alarm));
    alarms = raised.size();
    projecting += looks_->projection().projecting();
    compare_matching(keeps_->matching(), looks_->matching());
  }

  void compare_matching(const InterestMatching& is, const InterestMatching& wanted) {
    std::map<std::uint32_t, std::uint32_t> label;
    for (std::uint32_t i = 0; i < snapshot_.bodies.size(); ++i) {
      SCOPED_TRACE(i);
      ASSERT_EQ(is.audience(i), wanted.audience(i));
      ASSERT_EQ(is.outside(i), wanted.outside(i));
      ASSERT_EQ(is.touched(i), wanted.touched(i));
      ASSERT_EQ(is.expected(i), wanted.expected(i));
      ASSERT_EQ(is.pulled_to(i), wanted.pulled_to(i));
      ASSERT_EQ(is.clusters().hops(i), wanted.clusters().hops(i));
      ASSERT_EQ(is.clusters().is_complete(i), wanted.clusters().is_complete(i));
      ASSERT_EQ(is.clusters().size(i), wanted.clusters().size(i));
      const auto [known, is_new] = label.try_emplace(is.clusters().of(i), wanted.clusters().of(i));
      ASSERT_EQ(known->second, wanted.clusters().of(i));
      const Audience none = kNobodyListens;
      ASSERT_TRUE(std::ranges::binary_search(is.near_others(), i) ||
                  (wanted.audience(i) == none && !wanted.outside(i)));
    }
    ASSERT_EQ(is.clusters().links().size(), wanted.clusters().links().size());
    const auto pair_of = [](const InterestMatching::Pair& pair) { return std::pair(pair.foreign, pair.own); };
    std::vector<InterestMatching::Pair> pairs(is.pairs().begin(), is.pairs().end());
    std::vector<InterestMatching::Pair> wanted_pairs(wanted.pairs().begin(), wanted.pairs().end());
    std::ranges::sort(pairs, {}, pair_of), std::ranges::sort(wanted_pairs, {}, pair_of);
    ASSERT_TRUE(std::ranges::equal(pairs, wanted_pairs, {}, pair_of, pair_of));
  }

  Random random_;
  ProtocolSettings settings_;
  RoundShapes shapes_;
  PrototypeId ball_ = shapes_.sphere(0.5), large_ = shapes_.sphere(3);
  const RegionMap map_ = RegionMap::columns(3, 40);
  std::optional<Protocol> keeps_, looks_;
  Snapshot snapshot_;
  std::vector<std::uint32_t> changed_;
  bool goes_on_ = false;
  std::map<std::uint64_t, Other> foreign_;
  std::vector<Departure> departing_;
  Step now_ = 0;
};

class KeptMatching : public ::testing::TestWithParam<Rules> {};

TEST_P(KeptMatching, IsWhatALookAtAllBodiesFinds) {
  std::size_t kept = 0, departed = 0, alarms = 0, projecting = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TwoLooks both(GetParam(), seed);
    for (int n = 0; n < 150; ++n) {
      both.pass_step();
      if (HasFatalFailure()) return;
    }
    kept += both.kept, departed += both.departed, alarms += both.alarms, projecting += both.projecting;
  }
  EXPECT_GT(kept, 20'000U);
  EXPECT_GT(departed, 50U);
  if (GetParam().kind != AuraKind::kNone) {
    EXPECT_GT(projecting, 500U);
  }
  if (GetParam().redo) {
    EXPECT_GT(alarms, 5U);
  }
}

INSTANTIATE_TEST_SUITE_P(Rules, KeptMatching,
                         ::testing::Values(Rules{AuraKind::kSwept, true, 1}, Rules{AuraKind::kSwept, false, 1},
                                           Rules{AuraKind::kSwept, true, 4}, Rules{AuraKind::kTight, false, 2},
                                           Rules{AuraKind::kThesis, false, 1}, Rules{AuraKind::kNone, false, 1}),
                         [](const auto& info) { return "Case" + std::to_string(info.index); });

}  // namespace
}  // namespace aurasim::core::testing
