// Commands of every kind with values from one end of double to the other, to whole simulated clusters: each is refused
// with a reason or becomes an order, no state is ever out of bounds, no node waits for ever, and one node and four have
// the same bits. Prints its seed where it fails.
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"
#include "core/limits.h"
#include "process/order_issuer.h"

namespace aurasim::process {
namespace {

using core::BodyId;
using core::Vec3;

constexpr double kCell = 9;
constexpr core::Step kSteps = 300;
constexpr core::Step kAhead = 50;  ///< time enough for an order to go round

class Commands {
 public:
  Commands(std::uint64_t seed, const core::Scene& scene) : random_(seed), scene_(scene) {}

  core::Command next(std::uint64_t request, core::Step now) { return {request, now + kAhead, ask()}; }

 private:
  bool sane() { return std::uniform_int_distribution(0, 2)(random_) > 0; }
  double number(double usual) {
    static constexpr double kWild[] = {0,
                                       -0.0,
                                       1e-300,
                                       -1e-12,
                                       1e-3,
                                       1,
                                       40,
                                       377,
                                       1e3,
                                       -1e6,
                                       1e7,
                                       1e12,
                                       1e38,
                                       1e39,
                                       1e154,
                                       1e200,
                                       -1e300,
                                       1.7e308,
                                       std::numeric_limits<double>::denorm_min(),
                                       std::numeric_limits<double>::infinity(),
                                       std::numeric_limits<double>::quiet_NaN()};
    if (!std::uniform_int_distribution(0, 3)(random_)) {
      return kWild[std::uniform_int_distribution<std::size_t>(0, std::size(kWild) - 1)(random_)];
    }
    return std::uniform_real_distribution(-usual, usual)(random_);
  }
  /// Wild or as people ask.
  Vec3 vector(double usual) {
    if (sane()) {
      std::uniform_real_distribution one(-usual, usual);
      const double x = one(random_), y = one(random_), z = one(random_);
      return {x, y, z};
    }
    const double x = number(usual), y = number(usual), z = number(usual);
    return {x, y, z};
  }
  double size() { return sane() ? std::uniform_real_distribution(0.05, 1.0)(random_) : number(1); }
  core::Pose pose() {
    core::Pose pose{vector(2 * kCell), core::Quat::Identity()};
    pose.p_WB.z() += 12;
    if (!sane()) {
      const Vec3 v = vector(1);
      pose.q_WB = core::Quat(number(1), v.x(), v.y(), v.z());
    }
    return pose;
  }
  core::ClientShape shape() {
    const double a = size(), b = size(), c = size();
    switch (std::uniform_int_distribution(0, 3)(random_)) {
      case 0:
        return core::Sphere{a};
      case 1:
        return core::Capsule{a, b};
      case 2:
        return core::Cylinder{a, b};
      default:
        return core::Box{{a, b, c}};
    }
  }
  BodyId body() {
    return scene_.bodies[std::uniform_int_distribution<std::size_t>(0, scene_.bodies.size() - 1)(random_)].id;
  }
  core::Ask ask() {
    switch (std::uniform_int_distribution(0, 10)(random_)) {
      case 0: {
        core::NewBody ask;
        ask.shape = shape();
        ask.mass_kg = sane() ? 2 : number(10);
        ask.pose = pose();
        ask.v_WB = vector(10);
        ask.w_WB = vector(10);
        return ask;
      }
      case 1:
        return core::NewStatic{shape(), pose()};
      case 2:
        return core::RemoveStatic{core::StaticId{std::uniform_int_distribution(1u, 20u)(random_)}};
      case 3:
        return core::SendStatic{core::StaticId{std::uniform_int_distribution(0u, 5u)(random_)}, pose(), number(5)};
      case 4:
      case 5:
      case 6:
        return core::Impulse{body(), vector(10), sane() ? std::nullopt : std::optional(vector(20))};
      default:
        return core::SetVelocity{body(), vector(15), sane() ? std::nullopt : std::optional(vector(30))};
    }
  }

  std::mt19937_64 random_;
  const core::Scene& scene_;
};

struct FuzzRun {
  test::Outcome outcome;
  std::vector<std::string> verdicts;  ///< by request: why it was refused, or the state of its order
  std::size_t issued = 0;
  std::size_t declined = 0;
  std::string out_of_bounds;
  std::string refused;  ///< message of a node
};

class CommandFuzz : public ::testing::TestWithParam<int> {
 protected:
  CommandFuzz() {
    launch_.regions = core::RegionMap::grid(2, 2, kCell, kCell);
    launch_.scene = scene_;
    launch_.tolerances.speed_m_s = 40;
    launch_.neighbour_distance_m = 1e9;
  }

  static void look(const node::Node& node, FuzzRun& run) {
    for (const core::BodyState& body : const_cast<node::Node&>(node).world().snapshot().bodies) {
      const bool is_sound = body.pose.p_WB.allFinite() && body.v_WB.allFinite() && body.w_WB.allFinite() &&
                            body.pose.p_WB.norm() < 2 * core::limits::kFarthestBody_m;
      if (!is_sound) run.out_of_bounds = "body " + std::to_string(core::value_of(body.id));
    }
  }

  FuzzRun run(const core::RegionMap& map) {
    test::ClusterOptions options;
    options.map = map;
    options.sync = core::SyncMode::kDeterministic;
    options.aura.top_speed_m_s = launch_.tolerances.speed_m_s;
    options.neighbour_distance_m = 1e9;
    options.bandwidth_B_s = lab::kUnlimited_B_s;
    options.physics.solver = physics::Solver::kSoftStep;  // as the launch file's
    FuzzRun run;
    OrderIssuer issuer(launch_);
    Commands commands(static_cast<std::uint64_t>(GetParam()), scene_);
    const auto no_meshes = [](const core::MeshRef&) { return std::optional<core::Shape>(); };
    test::CheckedRun cluster(scene_, options);
    cluster.on_state = [&](node::Node& node, const node::StepReport& report, double) {
      look(node, run);
      for (const core::Refusal& refusal : node.protocol().intake().refusals()) {
        run.refused = std::string(core::name_of(refusal.kind)) + " for state " + std::to_string(refusal.stamp) + ": " +
                      std::string(refusal.why);
      }
      run.declined += report.declined.size();
      if (node.region() != core::RegionId{0} || report.step + kAhead + 20 > kSteps) return;
      const core::Command command = commands.next(run.verdicts.size() + 1, report.step);
      const Issued issued = issuer.issue(command, {true, scene_.bodies.size()}, no_meshes, node);
      EXPECT_NE(issued.order.has_value(), !issued.refused.empty());
      run.verdicts.push_back(issued.order ? std::to_string(issued.order->at_step) : issued.refused);
      run.issued += issued.order.has_value();
    };
    run.outcome = cluster.run(kSteps);
    return run;
  }

  core::Scene scene_ = test::thrown_bodies(40, 4 * kCell, 4 * kCell, 6, static_cast<std::uint64_t>(GetParam()));
  config::Launch launch_;
};

TEST_P(CommandFuzz, EachCommandIsRefusedOrObeyedAndTheWorldStaysSound) {
  const FuzzRun four = run(launch_.regions);
  EXPECT_EQ(four.out_of_bounds, "");
  EXPECT_EQ(four.refused, "");
  EXPECT_EQ(four.outcome.doubled + four.outcome.lost, 0u);
  EXPECT_GT(four.issued, 40u);
  EXPECT_LT(four.issued, four.verdicts.size()) << "none was refused";
  const FuzzRun one = run(core::RegionMap::columns(1, 1));
  EXPECT_EQ(one.out_of_bounds, "");
  EXPECT_EQ(four.verdicts, one.verdicts);
  EXPECT_EQ(four.declined, one.declined);
  if (four.outcome.violations > 0) return;  // a body was faster than promised: then its auras say too little
  EXPECT_EQ(test::first_difference(four.outcome, one.outcome), kSteps + 1);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CommandFuzz, ::testing::Range(1, 1 + test::seeds_or(4)));

}  // namespace
}  // namespace aurasim::process
