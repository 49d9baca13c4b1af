// Clients ask, nodes obey and answer.
#include "dds/command_bus.h"

#include <gtest/gtest.h>

#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using testing::holds_in_time;
using testing::settings_for;

/// A reply is lost whose writer had not found the client's reader yet.
TEST(CommandBus, WhoAsksAgainIsToldAgainAndObeyedOnce) {
  Participant at_node(settings_for(own_domain())), at_client(settings_for(own_domain()));
  CommandServerEndpoint node(at_node, RegionId{2}, testing::kMapVersion);
  CommandClientEndpoint client(at_client);
  ASSERT_TRUE(holds_in_time([&] { return client.listeners() == 1; }));
  core::Command command;
  command.ask = core::SetRate{0.5};
  command.request = client.send(command, 0);
  std::vector<core::Command> taken;
  const auto take = [&] {
    for (core::Command& each : node.take()) taken.push_back(std::move(each));
    return !taken.empty();
  };
  ASSERT_TRUE(holds_in_time(take));
  client.send(command, 0);  // before there is a reply
  core::CommandReply reply;
  reply.request = command.request;
  reply.outcome = core::Outcome::kAccepted;
  reply.at_step = 17;
  node.reply(reply);
  std::vector<core::CommandReply> replies;
  const auto replies_are = [&](std::size_t count) {
    return holds_in_time([&] {
      take();
      for (core::CommandReply& each : client.take()) replies.push_back(std::move(each));
      return replies.size() >= count;
    });
  };
  ASSERT_TRUE(replies_are(1));
  const std::size_t so_far = replies.size();
  client.send(command, 0);
  ASSERT_TRUE(replies_are(so_far + 1));
  EXPECT_EQ(taken.size(), 1U);
  for (const core::CommandReply& each : replies) {
    EXPECT_EQ(each.request, command.request);
    EXPECT_EQ(each.at_step, 17);
    EXPECT_EQ(each.source, RegionId{2});
  }
}

}  // namespace
}  // namespace aurasim::dds
