// What becomes of a client's command, where replies are lost.
#include "cli/command_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "control_samples.h"
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
        status(dds::testing::status_of(region)) {
    status.state = dds::NodeState::kPaused;
    status.dead.clear();
  }

  void say_saved(std::uint64_t request, core::Step step) {
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
  dds::Status status;
};

/// In a pause the lead says that it has taken a save, and of which state, and right after it that its part is saved.
/// The first word may find no reader yet. The others wait for the client to tell them the state.
TEST(CommandClient, TellsTheOthersTheStateThatTheLeadHasSavedThoughItHasNotHeardThatItWasTaken) {
  constexpr core::Step kSaved = 1200;
  PausedNode lead(test::own_domain(), 0), other(test::own_domain(), 1);
  dds::Participant at_client(settings_for(test::own_domain()));
  dds::ControlBus control(at_client, {.agreement = kAgreement});
  CommandClient client(at_client, control, kAgreement);
  ASSERT_TRUE(holds_in_time([&] {
    lead.control.publish_status(lead.status);
    other.control.publish_status(other.status);
    return control.statuses().size() == 2 && client.all_listen();
  }));
  core::Command save;
  save.ask = core::Save{"world.cut"};
  client.send(save);
  std::vector<Delivery> ended;
  ASSERT_TRUE(holds_in_time([&] {
    for (const core::Command& command : lead.server.take()) lead.say_saved(command.request, kSaved);
    for (const core::Command& command : other.server.take()) {
      if (command.at_step > 0) {
        other.say_saved(command.request, command.at_step);
      } else {
        other.server.forget(command.request);
      }
    }
    if (ended.empty()) ended = client.take();
    return !ended.empty();
  }));
  EXPECT_TRUE(ended.front().done) << ended.front().text;
  EXPECT_EQ(ended.front().at_step, kSaved);
  EXPECT_THAT(ended.front().files, ::testing::UnorderedElementsAre("part of region 0", "part of region 1"));
}

}  // namespace
}  // namespace aurasim::cli
