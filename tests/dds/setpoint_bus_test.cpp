// Programs say what they want, and nodes know up to which word they have heard each of them.
#include "dds/setpoint_bus.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dds/command_bus.h"
#include "dds/control.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using testing::holds_in_time;
using testing::settings_for;
using namespace std::chrono_literals;

constexpr core::Generation kGeneration = 3;

class SetpointBus : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(holds_in_time([this] { return program_.listeners() == 1; }));
  }
  bool is_heard(const core::ProgramWord& word) {
    return holds_in_time([&] {
      for (core::Setpoints& heard : node_.take(kGeneration)) taken_.push_back(std::move(heard));
      return node_.has_received(word);
    });
  }
  static core::Setpoints forces_on(std::size_t bodies, core::Generation generation = kGeneration) {
    core::Setpoints setpoints;
    setpoints.generation = generation;
    for (std::uint64_t id = 0; id < bodies; ++id) {
      setpoints.bodies.push_back({core::BodyId{id}, core::Quantity::kForce, core::Vec3(0, 0, 1)});
    }
    return setpoints;
  }

  Participant at_node_{settings_for(own_domain())}, at_program_{settings_for(own_domain())};
  SetpointReader node_{at_node_};
  SetpointWriter program_{at_program_};
  std::vector<core::Setpoints> taken_;
};

TEST_F(SetpointBus, AWordIsHeardOnceTheMessageHasCome) {
  EXPECT_EQ(program_.last_word().number, 0U);
  program_.send(forces_on(1));
  const core::ProgramWord word = program_.last_word();
  EXPECT_EQ(word.number, 1U);
  EXPECT_FALSE(node_.has_received(word)) << "nothing is taken before take()";
  EXPECT_TRUE(is_heard(word));
  EXPECT_FALSE(node_.has_received({word.program, word.number + 1}));
  EXPECT_FALSE(node_.has_received({word.program + 1, word.number}));
}

TEST_F(SetpointBus, ALargeMessageIsOneWord) {
  program_.send(forces_on(20'000));
  EXPECT_EQ(program_.last_word().number, 1U);
  ASSERT_TRUE(is_heard(program_.last_word()));
  ASSERT_EQ(taken_.size(), 1U);
  EXPECT_EQ(taken_.back().bodies.size(), 20'000U);
}

/// Or a node would wait for it.
TEST_F(SetpointBus, WhatWasSaidToAnotherWorldIsHeardAndNotTaken) {
  program_.send(forces_on(1, kGeneration - 1));
  EXPECT_TRUE(is_heard(program_.last_word()));
  EXPECT_TRUE(taken_.empty());
}

TEST(ANodeThatWaits, IsWokenByWhateverComesToIt) {
  Participant at_node(settings_for(own_domain())), at_client(settings_for(own_domain()));
  ControlBus waits(at_node, {.region_count = 3});
  CommandServerEndpoint commands(at_node, core::RegionId{0}, testing::kMapVersion);
  SetpointReader programs(at_node);
  CommandClientEndpoint client(at_client);
  SetpointWriter program(at_client);
  ASSERT_TRUE(holds_in_time([&] { return client.listeners() == 1 && program.listeners() == 1; }));
  const auto wait_is_short = [&] {
    const auto begin = std::chrono::steady_clock::now();
    waits.wait(testing::kDeadline);
    return std::chrono::steady_clock::now() < begin + testing::kDeadline / 2;
  };
  waits.wait(200ms);  // matches wake it up, too
  core::Command command;
  command.ask = core::SetRate{0.5};
  client.send(command, 0);
  EXPECT_TRUE(wait_is_short()) << "a command";
  bool has_come = false;
  ASSERT_TRUE(holds_in_time([&] { return has_come = has_come || !commands.take().empty(); }));
  waits.wait(200ms);
  program.send({});
  EXPECT_TRUE(wait_is_short()) << "a setpoint";
}

}  // namespace
}  // namespace aurasim::dds
