// A few seconds of the scalability experiment: the harness, with the real protocol, physics and codec.
#include "lab/scale/rain_run.h"

#include <atomic>

#include <gtest/gtest.h>

#include "lab/scale/rain_summary.h"

namespace aurasim::lab {
namespace {

/// Does with a launch what the suite scalability does, for two columns listening to each other.
RainPlace place() {
  RainPlace place;
  place.launch_file = AURASIM_SOURCE_DIR "/launch_configs/columns_rain.yaml";
  place.setup_of = [](const config::Launch& launch, core::RegionId region) {
    node::NodeSetup setup;
    setup.protocol.self = region;
    setup.protocol.aura.kind = launch.aura.radius;
    setup.protocol.aura.lookahead = launch.lookahead();
    setup.protocol.aura.substeps = launch.time.substeps;
    setup.protocol.neighbour_distance_m = 40;
    setup.physics.substeps = launch.time.substeps;
    return setup;
  };
  return place;
}

Rain five_seconds() {
  Rain rain;
  rain.series = "columns";
  rain.regions = rain.world = {Layout::Kind::kColumns, 2, 80};
  rain.rain_s = rain.run_s = 5;
  rain.rate_per_s = 100;
  rain.border_share = 1;
  return rain;
}

std::vector<Window> run(const Rain& rain) {
  const std::atomic<bool> stop = false;
  auto result = run_rain(
      rain, place(), [](double) {}, stop);
  EXPECT_TRUE(result);
  return *result;
}

TEST(RainRun, EveryBodyFallsAndSomeChangeHosts) {
  const std::vector<Window> windows = run(five_seconds());
  ASSERT_EQ(windows.size(), 1U);
  const Window& all = windows.back();
  EXPECT_NEAR(static_cast<double>(all.bodies), 500, 5);
  EXPECT_GT(all.projecting, 0U);
  EXPECT_GT(all.aura_updates, 1000U);
  EXPECT_EQ(all.late, 0U);
  EXPECT_GT(all.frame_max_ms, all.frame_mean_ms);
  EXPECT_GT(all.physics_ms, 0);
}

TEST(RainRun, TheSameRunDoesTheSameWork) {
  const Window a = run(five_seconds()).back();
  const Window b = run(five_seconds()).back();
  EXPECT_EQ(a.aura_bytes, b.aura_bytes);
  EXPECT_EQ(a.departures, b.departures);
}

TEST(RainRun, AnotherRepeatHasOtherBodies) {
  Rain other = five_seconds();
  other.repeat = 1;
  EXPECT_NE(run(five_seconds()).back().aura_bytes, run(other).back().aura_bytes);
}

TEST(RainRun, ANarrowLinkSlowsTheWorldAndBreaksNothing) {
  Rain narrow = five_seconds();
  narrow.bandwidth_B_s = 20'000;
  const Window slow = run(narrow).back();
  EXPECT_GT(slow.slow_down, 1.5);
  EXPECT_LT(run(five_seconds()).back().slow_down, 1.01);
  EXPECT_EQ(slow.late, 0U);
}

}  // namespace
}  // namespace aurasim::lab
