// Starting, steering and watching a run over DDS.
#include "dds/control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "child.h"
#include "core/wall_clock.h"
#include "messages/control_codec.h"
#include "messages/control_samples.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using messages::testing::command_of;
using messages::testing::map_of;
using messages::testing::status_of;
using testing::Child;
using ::testing::ElementsAre;
using testing::settings_for;
using namespace std::chrono_literals;

/// A process with a bus.
struct Member {
  explicit Member(std::uint32_t domain, std::optional<std::uint32_t> region = {},
                  std::optional<std::uint64_t> map_version = {})
      : participant(settings_for(domain)),
        bus(participant, {.map_version = map_version,
                          .region = region ? std::optional(static_cast<RegionId>(*region)) : std::nullopt}) {}

  Member(std::uint32_t domain, const ControlSettings& settings)
      : participant(settings_for(domain)), bus(participant, settings) {}

  template <class Done>
  bool wait_until(Done done, std::chrono::nanoseconds time_out = testing::kDeadline) {
    const auto deadline = std::chrono::steady_clock::now() + time_out;
    while (!done()) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      bus.wait(20ms);
    }
    return true;
  }

  /// Collects commands until there are `count`.
  std::vector<messages::RunCommandKind> take_commands(std::size_t count,
                                                      std::chrono::nanoseconds time_out = testing::kDeadline) {
    std::vector<messages::RunCommandKind> kinds;
    wait_until(
        [&] {
          for (const messages::RunCommand& command : bus.take_commands()) {
            kinds.push_back(command.kind);
          }
          return kinds.size() >= count;
        },
        time_out);
    return kinds;
  }

  Participant participant;
  ControlBus bus;
};

TEST(Status, OfEveryNodeIsSeenAlsoByLateObservers) {
  Member zero(own_domain(), 0);
  Member one(own_domain(), 1);
  for (core::Step step = 0; step < 5; ++step) {
    messages::Status status = status_of(0);
    status.step = step;
    ASSERT_TRUE(zero.bus.publish_status(status));
    status.region = RegionId{1};
    ASSERT_TRUE(one.bus.publish_status(status));
  }
  Member late(own_domain());
  ASSERT_TRUE(late.wait_until([&] { return late.bus.statuses().size() == 2; }));
  EXPECT_EQ(late.bus.statuses().at(RegionId{0}).status.step, 4);
  EXPECT_EQ(late.bus.statuses().at(RegionId{1}).status.text, "all is well");
  EXPECT_FALSE(late.bus.statuses().at(RegionId{1}).lost);
  ASSERT_TRUE(one.wait_until([&] { return one.bus.statuses().size() == 2; })) << "nodes see each other and themselves";
  EXPECT_EQ(late.bus.refused().total(), 0U);
}

TEST(Status, SaysThatAKilledNodeIsLostAndThatItIsBack) {
  Member observer(own_domain());
  testing::Peer region_zero(own_domain(), 0, {1});
  const std::vector<std::string> words = {AURASIM_BINARY_DIR "/dds_peer_process", std::to_string(own_domain()), "1",
                                          "0", "run"};
  auto node = std::make_unique<Child>(words);
  const auto lost = [&] {
    const auto& statuses = observer.bus.statuses();
    const auto found = statuses.find(RegionId{1});
    return found == statuses.end() ? -1 : int{found->second.lost};
  };
  ASSERT_TRUE(observer.wait_until([&] { return lost() == 0; }));
  node->kill(SIGKILL);
  ASSERT_TRUE(observer.wait_until([&] { return lost() == 1; }));
  node = std::make_unique<Child>(words);
  EXPECT_TRUE(observer.wait_until([&] { return lost() == 0; }));
}

messages::Status status_of_run(std::uint64_t run, core::Step step) {
  messages::Status status = status_of(0);
  status.run = run;
  status.step = step;
  return status;
}

/// Two launches of one file: the same regions, the same agreement.
TEST(Status, OfAStrangerDoesNotTouchThatOfTheRun) {
  Member node(own_domain(), {.region = RegionId{0}, .run = 5});
  auto stranger = std::make_unique<Member>(own_domain(), ControlSettings{.region = RegionId{0}, .run = 6});
  Member launcher(own_domain(), {.agreement = 88, .run = 5});
  Member tool(own_domain(), {.agreement = 88});
  ASSERT_TRUE(node.bus.publish_status(status_of_run(5, 10)));
  const auto step_seen_by = [](Member& member) {
    const auto& statuses = member.bus.statuses();
    return statuses.empty() ? -1 : statuses.at(RegionId{0}).status.step;
  };
  ASSERT_TRUE(launcher.wait_until([&] { return step_seen_by(launcher) == 10; }));
  ASSERT_TRUE(tool.wait_until([&] { return step_seen_by(tool) == 10; }));
  ASSERT_TRUE(node.wait_until([&] { return step_seen_by(node) == 10; }));

  ASSERT_TRUE(stranger->bus.publish_status(status_of_run(6, 999)));
  for (Member* member : {&launcher, &tool, &node}) {
    const std::size_t strangers = member == &tool ? 0 : 1;
    ASSERT_TRUE(member->wait_until([&] { return member->bus.strangers().size() == strangers; }));
    EXPECT_EQ(step_seen_by(*member), 10);
  }
  EXPECT_EQ(launcher.bus.strangers().at(0).status.run, 6U);

  stranger.reset();
  ASSERT_TRUE(launcher.wait_until([&] { return launcher.bus.strangers().empty(); }));
  ASSERT_TRUE(node.bus.publish_status(status_of_run(5, 11)));
  for (Member* member : {&launcher, &tool}) {
    ASSERT_TRUE(member->wait_until([&] { return step_seen_by(*member) == 11; }));
    EXPECT_FALSE(member->bus.statuses().at(RegionId{0}).lost) << "it was the stranger who left";
  }
}

TEST(Status, OfANodeThatDoesNotAgreeIsAStrangers) {
  Member node(own_domain(), {.region = RegionId{0}});
  Member tool(own_domain(), {.agreement = 77});
  ASSERT_TRUE(node.bus.publish_status(status_of(0)));
  ASSERT_TRUE(tool.wait_until([&] { return tool.bus.strangers().size() == 1; }));
  EXPECT_TRUE(tool.bus.statuses().empty());
}

TEST(Commands, ForAnotherRunAreNotTaken) {
  Member launcher(own_domain());
  Member node(own_domain(), {.region = RegionId{0}, .run = 5});
  messages::RunCommand command = command_of(messages::RunCommandKind::kStop);
  command.run = 6;
  launcher.bus.send(command);
  command.kind = messages::RunCommandKind::kPause;
  command.run = 5;
  launcher.bus.send(command);
  command.kind = messages::RunCommandKind::kResume;
  command.run = 0;
  launcher.bus.send(command);
  EXPECT_THAT(node.take_commands(2), ElementsAre(messages::RunCommandKind::kPause, messages::RunCommandKind::kResume));
}

TEST(Commands, SayWhetherTheSendersClockIsOurs) {
  Member launcher(own_domain());
  Member node(own_domain(), 0);
  launcher.bus.send(command_of(messages::RunCommandKind::kPause));
  std::vector<messages::RunCommand> commands;
  ASSERT_TRUE(node.wait_until([&] { return !(commands = node.bus.take_commands()).empty(); }));
  EXPECT_LE(commands[0].clock_ahead, 0ns) << "both are of this host, and the way takes its time";
  EXPECT_GT(commands[0].clock_ahead, -testing::kDeadline);
}

/// A hub that passes the status on has a clock of its own.
TEST(Status, SaysItselfHowFarTheSendersClockIsAhead) {
  Participant sender(settings_for(own_domain()));
  Writer writer(sender.domain(), on(TopicId::kNodeStatus, {.source = RegionId{0}}, RegionId{0}),
                sender.domain().wakeup());
  wire::NodeStatus status;
  messages::encode(status_of(0), status);
  status.sent_ns(core::wall_clock_ns() + std::chrono::nanoseconds(1h).count());
  ASSERT_NE(writer.write(&status), WriteResult::kFailed);
  Member watcher(own_domain());
  ASSERT_TRUE(watcher.wait_until([&] { return watcher.bus.statuses().contains(RegionId{0}); }));
  const std::chrono::nanoseconds ahead = watcher.bus.statuses().at(RegionId{0}).clock_ahead;
  EXPECT_LE(ahead, 1h);
  EXPECT_GT(ahead, 1h - testing::kDeadline);
}

TEST(Status, OfAnotherRegionCannotBePublished) {
  Member zero(own_domain(), 0);
  EXPECT_THROW(zero.bus.publish_status(status_of(1)), std::logic_error);
  Member launcher(own_domain());
  EXPECT_THROW(launcher.bus.publish_status(status_of(1)), std::logic_error);
}

TEST(Maps, AreSeenByLateJoiners) {
  Member launcher(own_domain());
  ASSERT_TRUE(launcher.bus.publish_map(map_of(77)));
  ASSERT_TRUE(launcher.bus.publish_map(map_of(78)));
  Member late(own_domain());
  ASSERT_TRUE(late.wait_until([&] { return late.bus.maps().size() == 2; }));
  EXPECT_EQ(late.bus.maps().at(77).scene, "tower");
  EXPECT_EQ(late.bus.maps().at(78).regions.size(), 2U);
}

TEST(Maps, OfALaterGenerationCountWhoeverPublishesThem) {
  Member one(own_domain()), other(own_domain()), reader(own_domain());
  for (Member* const last : {&one, &other}) {
    messages::WorldMap map = map_of(77);
    ASSERT_TRUE(one.bus.publish_map(map));
    ASSERT_TRUE(other.bus.publish_map(map));
    map.generation = last == &one ? 3 : 4;
    ASSERT_TRUE(last->bus.publish_map(map));
    EXPECT_TRUE(reader.wait_until([&] {
      const auto& maps = reader.bus.maps();
      return maps.contains(77) && maps.at(77).generation == map.generation;
    }));
  }
}

TEST(Commands, ReachEveryoneInOrderOnceAndAlsoLateJoiners) {
  Member launcher(own_domain());
  Member node(own_domain(), 0, 77);
  ASSERT_TRUE(launcher.wait_until([&] { return launcher.bus.listeners() == 1; }));
  launcher.bus.send(command_of(messages::RunCommandKind::kStart));
  launcher.bus.send(command_of(messages::RunCommandKind::kPause));
  EXPECT_THAT(node.take_commands(2), ElementsAre(messages::RunCommandKind::kStart, messages::RunCommandKind::kPause));
  Member late(own_domain(), 1, 77);
  EXPECT_THAT(late.take_commands(2), ElementsAre(messages::RunCommandKind::kStart, messages::RunCommandKind::kPause));
  EXPECT_TRUE(launcher.bus.take_commands().empty()) << "nobody is told what it said itself";
}

TEST(Commands, ThatAreSentTwiceCountOnce) {
  Member launcher(own_domain());
  Member tool(own_domain());
  Member node(own_domain(), 0);
  ASSERT_TRUE(launcher.wait_until([&] { return launcher.bus.listeners() == 2 && tool.bus.listeners() == 2; }));
  messages::RunCommand command = command_of(messages::RunCommandKind::kStep);
  command.request = launcher.bus.send(command);
  launcher.bus.send(command);
  tool.bus.send(command);
  EXPECT_THAT(node.take_commands(2, 500ms), ElementsAre(messages::RunCommandKind::kStep));
}

TEST(Commands, ForAnotherMapAreRefused) {
  Member launcher(own_domain());
  Member node(own_domain(), 0, 99);
  messages::RunCommand command = command_of(messages::RunCommandKind::kStop);
  launcher.bus.send(command);
  command.map_version = 0;
  command.kind = messages::RunCommandKind::kPause;
  launcher.bus.send(command);
  EXPECT_THAT(node.take_commands(1), ElementsAre(messages::RunCommandKind::kPause));
  EXPECT_EQ(node.bus.refused().count(messages::WireError::kMapVersion), 1U);
}

}  // namespace
}  // namespace aurasim::dds
