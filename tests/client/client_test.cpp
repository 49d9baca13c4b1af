// The C++ client library against real runs.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>

#include <aurasim/client.h>

#include "system_fixture.h"

namespace aurasim::client {
namespace {

using system_test::Clock;
using system_test::kGenerous;
using system_test::launch_file;
using system_test::wait_until;
using system_test::Words;

class Client : public system_test::SystemTest {
 protected:
  std::vector<std::string> overrides(const Words& more = {}) const {
    return system_test::operator+({"dds.domain=" + std::to_string(test::own_domain())}, more);
  }
  World launch_world(const Words& more = {}, bool paused = true) const {
    return World::launch(launch_file("demo"), {.overrides = overrides(more),
                                               .time_out = kGenerous,
                                               .paused = paused,
                                               .saves = (folder() / "saves").string()});
  }
  World connect(const Words& more = {}, Seconds time_out = kGenerous) const {
    return World::connect(launch_file("demo"), {.overrides = overrides(more), .time_out = time_out});
  }
};

std::optional<std::size_t> row_of(const Bodies& bodies, std::uint64_t id) {
  const auto place = std::ranges::lower_bound(bodies.ids, id);
  if (place == bodies.ids.end() || *place != id) return std::nullopt;
  return place - bodies.ids.begin();
}

TEST_F(Client, AWorldIsLaunchedPausedAndSteppedStateByState) {
  World world = launch_world();
  Bodies bodies = world.bodies();
  EXPECT_EQ(bodies.step, 0);
  EXPECT_EQ(bodies.positions.size(), 3 * bodies.size());
  EXPECT_EQ(bodies.rotations.size(), 4 * bodies.size());
  for (std::int64_t step = 1; step <= 10; ++step) {
    bodies = world.step();
    EXPECT_EQ(bodies.step, step);
    EXPECT_TRUE(bodies.exact);
  }
  EXPECT_EQ(world.step(20).step, 30);
  EXPECT_EQ(world.nodes().size(), 4U);
  EXPECT_EQ(world.close(), 0);
  EXPECT_TRUE(world.closed());
}

TEST_F(Client, AnObserverIsToldWhatItHasAskedFor) {
  World world = launch_world();
  const Bodies all = world.bodies();
  Interest interest;
  interest.bodies = {all.ids[0], all.ids[5]};
  interest.contacts = true;
  interest.fans.push_back({{{}, {0, 0, 2}, {1, 0, 0, 0}}, RayFan::grid(-3.1, 3.1, 64), 50, 1});
  interest.triggers.push_back({{}, {1000, 1000, 1000}, 0});
  Observer observer = world.observe(interest);
  EXPECT_EQ(observer.next().bodies.ids, interest.bodies);
  world.step(3);
  for (std::int64_t step = 1; step <= 3; ++step) {
    const Observation state = observer.next();
    EXPECT_EQ(state.bodies.step, step);
    EXPECT_TRUE(state.bodies.exact);
    ASSERT_EQ(state.fans.size(), 1U);
    EXPECT_TRUE(state.fans[0].complete);
    EXPECT_EQ(state.fans[0].size(), 64U);
    ASSERT_EQ(state.triggers.size(), 1U);
    EXPECT_EQ(state.triggers[0].inside, all.ids);
  }
  interest.fans[0].range_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(world.observe(interest), Refused);
  world.close();
  EXPECT_THROW(observer.next(), Ended);
}

TEST_F(Client, AnActShowsInTheStateThatItSaysAndNotBefore) {
  World world = launch_world();
  const Acknowledgement ball = world.spawn({.shape = Shape::sphere(0.5), .mass_kg = 4, .position = {15, -15, 20}});
  ASSERT_TRUE(ball.body);
  EXPECT_FALSE(row_of(world.step(ball.step - 1), *ball.body));
  EXPECT_TRUE(row_of(world.step(), *ball.body));
  const Acknowledgement push = world.impulse(*ball.body, {8, 0, 0});
  const Bodies before = world.step(push.step - 1 - ball.step);
  EXPECT_NEAR(before.linear_velocities[3 * *row_of(before, *ball.body)], 0, 1e-6);
  const Bodies after = world.step();
  EXPECT_NEAR(after.linear_velocities[3 * *row_of(after, *ball.body)], 2, 0.01);
}

TEST_F(Client, ItJoinsARunThatWasStartedElsewhereAndLeavesItRunning) {
  system_test::Process& run = launch("run", launch_file("demo"));
  {
    World world = connect();
    EXPECT_GT(world.pause().size(), 50U);
    world.resume();
  }
  World again = connect();
  const std::int64_t step = again.bodies().step;
  EXPECT_TRUE(wait_until([&] { return again.bodies().step > step + 60; }, kGenerous));
  EXPECT_TRUE(run.running());
  again.stop();
  expect_exit(run, 0);
}

TEST_F(Client, ErrorsHaveTypes) {
  EXPECT_THROW(World::connect("no/such/file.yaml"), BadFile);
  EXPECT_THROW(connect({}, Seconds{2}), NoSuchRun);
  EXPECT_THROW(World::connect(launch_file("demo"), {.program = "/no/such/program"}), NoProgram);
  World world = launch_world();
  EXPECT_THROW(connect({"time.substeps=4"}), RunDiffers);
  EXPECT_THROW(world.impulse(1, {std::numeric_limits<double>::quiet_NaN(), 0, 0}), Refused);
  EXPECT_THROW(world.spawn({.prototype = "nothing"}), Refused);
  EXPECT_THROW(world.impulses({1, 2}, {0, 0, 1}), Error);
  EXPECT_THROW(world.step(600, Seconds{0.3}), TimedOut);
  world.close();
  EXPECT_THROW(world.step(), Ended);
}

TEST_F(Client, AWaitIsGivenUpWhenTheCallerSaysSo) {
  bool enough = false;
  World world = World::launch(
      launch_file("demo"),
      {.overrides = overrides(), .time_out = kGenerous, .interrupted = [&] { return enough; }, .paused = true});
  enough = true;
  EXPECT_THROW(world.step(6000), Interrupted);
  enough = false;
  EXPECT_FALSE(world.nodes().empty());
}

TEST_F(Client, WhatItHasLaunchedEndsWithItsAgent) {
  World world = launch_world();
  ::kill(world.agent_pid(), SIGKILL);
  EXPECT_THROW(world.step(), Ended);
  expect_nobody_left(kGenerous);
}

}  // namespace
}  // namespace aurasim::client
