// What becomes of a client's command, where replies are lost.
#include "steering/command_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "messages/control_samples.h"
#include "transport_fixture.h"

namespace aurasim::cli {
namespace {

using core::RegionId;
using dds::testing::holds_in_time;
using dds::testing::settings_for;

constexpr std::uint64_t kAgreement = 88;

/// What a node of a paused run says, without the rest of it.
struct PausedNode {
  PausedNode(std::uint32_t domain, std::uint32_t region)
      : participant(settings_for(domain)),
        control(participant, {.region = RegionId{region}, .agreement = kAgreement}),
        server(participant, RegionId{region}, dds::testing::kMapVersion),
        status(messages::testing::status_of(region)) {
    status.state = messages::NodeState::kPaused;
    status.dead.clear();
  }

  void say_accepted(std::uint64_t request, core::Step step) {
    core::CommandReply reply;
    reply.request = request;
    reply.at_step = step;
    reply.text = core::kSavedAsItStands;
    server.reply(reply);
  }

  void say_saved(std::uint64_t request, core::Step step) {
    has_saved = true;
    core::CommandReply reply;
    reply.request = request;
    reply.outcome = core::Outcome::kSeen;
    reply.at_step = step;
    reply.text = "part of region " + std::to_string(core::value_of(status.region));
    server.reply(reply);
  }

  dds::Participant participant;
  dds::ControlBus control;
  dds::CommandServerEndpoint server;
  messages::Status status;
  bool has_saved = false;
};

class SaveInAPause : public ::testing::Test {
 protected:
  static constexpr core::Step kSaved = 1200;

  SaveInAPause() { lead.status.step = other.status.step = kSaved; }

  void send() {
    ASSERT_TRUE(holds_in_time([&] {
      lead.control.publish_status(lead.status);
      other.control.publish_status(other.status);
      return control.statuses().size() == 2 && client.all_listen();
    }));
    core::Command save;
    save.ask = core::Save{"world.cut"};
    client.send(save);
  }

  /// It writes its part once it is told the state, and only in that.
  void let_other_answer() {
    for (const core::Command& command : other.server.take()) {
      if (command.at_step == other.status.step) {
        other.say_saved(command.request, command.at_step);
      } else {
        other.server.forget(command.request);
      }
    }
  }

  bool take() {
    if (ended.empty()) ended = client.take();
    return !ended.empty();
  }

  PausedNode lead{test::own_domain(), 0}, other{test::own_domain(), 1};
  dds::Participant at_client{settings_for(test::own_domain())};
  dds::ControlBus control{at_client, {.agreement = kAgreement}};
  steering::CommandClient client{at_client, control, kAgreement};
  std::vector<steering::Delivery> ended;
};

/// The lead says that it has taken a save, and of which state, and right after it that its part is saved. The first
/// word may find no reader yet. The others wait for the client to tell them the state.
TEST_F(SaveInAPause, TheOthersAreToldTheStateThoughItWasNotHeardThatTheLeadHasTakenIt) {
  ASSERT_NO_FATAL_FAILURE(send());
  ASSERT_TRUE(holds_in_time([&] {
    for (const core::Command& command : lead.server.take()) lead.say_saved(command.request, kSaved);
    let_other_answer();
    return take();
  }));
  EXPECT_TRUE(ended.front().done) << ended.front().text;
  EXPECT_EQ(ended.front().at_step, kSaved);
  EXPECT_THAT(ended.front().files, ::testing::UnorderedElementsAre("part of region 0", "part of region 1"));
}

TEST_F(SaveInAPause, TheOthersAreToldTheStateThoughStatusesAreOfAnEarlierOne) {
  lead.status.step = other.status.step = kSaved - 3;
  ASSERT_NO_FATAL_FAILURE(send());
  other.status.step = kSaved;  // and it has not said so yet
  ASSERT_TRUE(holds_in_time([&] {
    for (const core::Command& command : lead.server.take()) lead.say_accepted(command.request, kSaved);
    let_other_answer();
    client.take();
    return other.has_saved;
  }));
}

TEST_F(SaveInAPause, WhatTheRunHasGoneOnFromIsNotWaitedForLong) {
  ASSERT_NO_FATAL_FAILURE(send());
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(holds_in_time([&] {
    for (const core::Command& command : lead.server.take()) {
      lead.say_accepted(command.request, kSaved);
      lead.say_saved(command.request, kSaved);
      other.status.step = kSaved + 5;
      other.control.publish_status(other.status);
    }
    let_other_answer();
    return take();
  }));
  EXPECT_FALSE(ended.front().done || ended.front().timed_out);
  EXPECT_THAT(ended.front().text, ::testing::HasSubstr("has gone on from state 1200"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(15)) << "a disk is waited for longer";
}

}  // namespace
}  // namespace aurasim::cli
