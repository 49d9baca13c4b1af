// The view of simulated clusters: real protocol, real physics, virtual time, and a wire to the observer that delays and
// loses. Bodies cross borders all the time; every composed frame has each of them exactly once.
#include <iostream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"
#include "node/replica_feed.h"
#include "overseer/frame_codec.h"
#include "overseer/page_reader.h"
#include "overseer/world_view.h"

namespace aurasim::overseer {
namespace {

using core::RegionId;
using core::Step;
using testing::PageWorld;

constexpr double kCell = 9;
constexpr Step kTick = 3;
constexpr Step kSteps = 240;
constexpr double kStepS = 1.0 / 60;

struct Wire {
  double delay_s = 0.02;
  double jitter_s = 0;
  double delta_loss = 0;
  double key_loss = 0;
  double joins_s = 0;          ///< the observer
  double loses_until_s = 1e9;  ///< after that the wire is good
};

/// What the nodes of a simulated cluster publish, and an observer that puts it together.
class Observed {
 public:
  Observed(const core::Scene& scene, const test::ClusterOptions& options, const Wire& wire, std::uint64_t seed)
      : scene_(scene),
        wire_(wire),
        random_(seed),
        view_({.region_count = options.map.size(), .unclaimed_patience = 120, .wait_s = 0.5}),
        sim_(scene, options) {
    for (std::uint32_t r = 0; r < options.map.size(); ++r) {
      feeds_.emplace_back(RegionId{r}, 0, 1);
      last_s_.push_back(0);
      joined_.push_back(false);
      view_.set_region(RegionId{r}, WorldView::RegionState::kLive);
    }
    if (options.crash) crash_ = *options.crash;
    sim_.on_state = [this](node::Node& node, const node::StepReport& report, double now_s) {
      publish(node, report, now_s);
      if (crash_ && node.region() == crash_->region && report.step >= crash_->step) crashed_s_ = now_s;
      look(now_s);
    };
  }

  test::Outcome run() {
    const test::Outcome outcome = sim_.run(kSteps);
    now_s_ += 10;
    look(now_s_);
    return outcome;
  }

  /// Bodies that have been born by then.
  std::size_t born(Step stamp) const {
    std::size_t count = scene_.bodies.size();
    for (const core::Injector& injector : scene_.injectors) count += core::injected_count(injector, stamp, kStepS);
    return count;
  }

  WorldView& view() { return view_; }
  test::CheckedRun& sim() { return sim_; }
  const PageWorld& page() const { return page_; }

  std::ostringstream why;
  int wrong_counts = 0;   ///< frames that lacked a body
  int wrong_poses = 0;    ///< bodies elsewhere than their host had them
  std::set<Step> stamps;  ///< of all frames
  int under_way = 0;      ///< bodies seen between two hosts
  double last_wrong_s = -1;

 private:
  struct Letter {
    double due_s = 0;
    core::Replica replica;
  };

  double chance() { return std::uniform_real_distribution<double>(0, 1)(random_); }

  void publish(node::Node& node, const node::StepReport& report, double now_s) {
    const std::size_t r = core::value_of(node.region());
    node::ReplicaFeed& feed = feeds_[r];
    if (now_s < wire_.joins_s) {
      feed.forget();
      return;
    }
    feed.note(report);
    if (report.step % kTick != 0) return;
    const core::Snapshot& snapshot = node.world().snapshot();
    for (const core::BodyState& body : snapshot.bodies) {
      if (body.birth <= snapshot.step) truth_[snapshot.step][core::value_of(body.id)] = body.pose.p_WB;
    }
    send(feed.compose_changes(snapshot), r, now_s, wire_.delta_loss);
    const bool first = !joined_[r];
    joined_[r] = true;
    if (!first && (report.step % 60 != 0 || !feed.changed_since_key_frame())) return;
    send(feed.compose_key_frame(snapshot, node.protocol().departures().open()), r, now_s, first ? 0 : wire_.key_loss);
  }

  void send(const core::Replica& replica, std::size_t r, double now_s, double loss) {
    if (now_s < wire_.loses_until_s && chance() < loss) return;
    double due_s = now_s + wire_.delay_s + wire_.jitter_s * chance();
    if (!replica.key_frame) last_s_[r] = due_s = std::max(due_s, last_s_[r]);
    letters_.push_back({due_s, replica});
  }

  void look(double now_s) {
    now_s_ = std::max(now_s_, now_s);
    std::stable_sort(letters_.begin(), letters_.end(),
                     [](const Letter& a, const Letter& b) { return a.due_s < b.due_s; });
    while (!letters_.empty() && letters_.front().due_s <= now_s_) {
      view_.accept(std::move(letters_.front().replica), letters_.front().due_s);
      letters_.pop_front();
    }
    if (crash_ && now_s_ > crashed_s_ + 0.5) view_.set_region(crash_->region, WorldView::RegionState::kDead);
    while (const WorldFrame* frame = view_.compose(now_s_)) check(*frame);
  }

  void check(const WorldFrame& frame) {
    stamps.insert(frame.stamp);
    table_.apply(frame);
    client_.note(frame);
    page_.read(client_.encode(table_));
    const auto seen = page_.by_id();
    bool wrong = seen.size() != born(frame.stamp);
    wrong_counts += wrong;
    for (const auto& [id, p_WB] : truth_[frame.stamp]) {
      const auto found = seen.find(id);
      const bool right = found != seen.end() && (found->second.p - p_WB).norm() < 5e-4;
      wrong_poses += !right;
      if (!right)
        why << "\n  body " << id << " in frame " << frame.stamp << " at " << now_s_ << " s, off by "
            << (found == seen.end() ? -1 : (found->second.p - p_WB).norm()) << ", flags "
            << (found == seen.end() ? 0 : found->second.flags);
      wrong = wrong || !right;
    }
    for (const auto& [id, body] : seen) under_way += (body.flags & 2) != 0;
    if (wrong) last_wrong_s = now_s_;
  }

  const core::Scene& scene_;
  Wire wire_;
  std::mt19937 random_;
  WorldView view_;
  test::CheckedRun sim_;
  std::optional<test::Crash> crash_;
  double crashed_s_ = 1e9;
  std::vector<node::ReplicaFeed> feeds_;
  std::vector<double> last_s_;
  std::vector<bool> joined_;
  std::deque<Letter> letters_;
  std::map<Step, std::map<std::uint64_t, core::Vec3>> truth_;
  SlotTable table_;
  ClientFrames client_;
  PageWorld page_;
  double now_s_ = 0;
};

test::ClusterOptions options_for(std::uint64_t seed) {
  test::ClusterOptions options;
  options.map = core::RegionMap::grid(2, 2, kCell, kCell);
  options.seed = seed;
  options.aura.lookahead = 1 + static_cast<int>(seed % 3);
  options.aura.top_speed_m_s = 40;
  options.network.loss = 0.05 * static_cast<double>(seed % 4);
  options.network.latency_s = 0.004 * static_cast<double>(seed % 5);
  return options;
}

class ViewOfACluster : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  core::Scene scene_ = test::thrown_bodies(60, 2 * kCell, 2 * kCell, 12, GetParam());
};

TEST_P(ViewOfACluster, HasEveryBodyOnceInEveryFrameWhereItsHostHasIt) {
  Observed run(scene_, options_for(GetParam()), {.delay_s = 0.02, .jitter_s = 0.1, .key_loss = 0.7}, GetParam());
  const test::Outcome outcome = run.run();
  EXPECT_GT(outcome.hand_offs, 5U);
  EXPECT_EQ(run.wrong_counts, 0);
  EXPECT_EQ(run.wrong_poses, 0) << run.why.str();
  EXPECT_EQ(run.view().counters().incomplete, 0U);
  EXPECT_EQ(run.stamps.size(), kSteps / kTick + 1U);
  EXPECT_EQ(run.page().key_frames, 1);
  EXPECT_EQ(run.view().counters().given_up, 0U);
  std::cout << "seed " << GetParam() << ": " << outcome.hand_offs << " hand-offs, " << run.under_way
            << " bodies seen under way\n";
}

TEST_P(ViewOfACluster, IsWholeForALateObserverFromItsFirstFramesOn) {
  Observed run(scene_, options_for(GetParam()), {.joins_s = 2.03}, GetParam());
  run.run();
  EXPECT_GT(run.page().frames, 30);
  EXPECT_LT(run.last_wrong_s, 2.2);
}

TEST_P(ViewOfACluster, RecoversFromLostTicksByTheNextKeyFrames) {
  Observed run(scene_, options_for(GetParam()),
               {.jitter_s = 0.05, .delta_loss = 0.2, .key_loss = 0.3, .loses_until_s = 2.5}, GetParam());
  run.run();
  EXPECT_GT(run.view().counters().gaps, 5U);
  EXPECT_GE(run.last_wrong_s, 0.0) << "or nothing was lost";
  EXPECT_LT(run.last_wrong_s, 3.6);
}

TEST_P(ViewOfACluster, DropsTheBodiesOfADeadRegionAndNoOthers) {
  test::ClusterOptions options = options_for(GetParam());
  options.crash = test::Crash{RegionId{static_cast<std::uint32_t>(GetParam() % 4)}, 60, 0.2};
  Observed run(scene_, options, {}, GetParam());
  run.run();
  std::map<std::uint64_t, RegionId> hosted;
  for (std::uint32_t r = 0; r < 4; ++r) {
    if (RegionId{r} == options.crash->region) continue;
    for (const core::BodyState& body : run.sim().node(r).world().snapshot().bodies)
      hosted[core::value_of(body.id)] = RegionId{r};
    // Those on their way to the dead region stay in the ledger of their sender, and are seen where they left it.
    for (const core::HandOff& open : run.sim().node(r).protocol().departures().open()) {
      for (const core::BodyRecord& body : open.cluster.bodies) hosted[core::value_of(body.id)] = open.destination;
    }
  }
  const auto seen = run.page().by_id();
  for (const auto& [id, region] : hosted) EXPECT_TRUE(seen.contains(id)) << "body " << id;
  for (const auto& [id, body] : seen) EXPECT_TRUE(hosted.contains(id)) << "body " << id << " of " << body.host;
}

INSTANTIATE_TEST_SUITE_P(Seeds, ViewOfACluster, ::testing::Range<std::uint64_t>(1, 7));

}  // namespace
}  // namespace aurasim::overseer
