// Starting, steering and watching a run over DDS. Domains 115 to 120.
#include "dds/control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "child.h"
#include "control_messages.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using testing::Child;
using testing::command_of;
using ::testing::ElementsAre;
using testing::map_of;
using testing::settings_for;
using testing::status_of;
using namespace std::chrono_literals;

/// A process with a bus.
struct Member {
  explicit Member(std::uint32_t domain, std::optional<std::uint32_t> region = {},
                  std::optional<std::uint64_t> map_version = {})
      : participant(settings_for(domain)),
        bus(participant, {.map_version = map_version,
                          .region = region ? std::optional(static_cast<RegionId>(*region)) : std::nullopt}) {}

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
  std::vector<RunCommandKind> take_commands(std::size_t count, std::chrono::nanoseconds time_out = testing::kDeadline) {
    std::vector<RunCommandKind> kinds;
    wait_until(
        [&] {
          for (const RunCommand& command : bus.take_commands()) {
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
  Member zero(115, 0);
  Member one(115, 1);
  for (core::Step step = 0; step < 5; ++step) {
    Status status = status_of(0);
    status.step = step;
    ASSERT_TRUE(zero.bus.publish_status(status));
    status.region = RegionId{1};
    ASSERT_TRUE(one.bus.publish_status(status));
  }
  Member late(115);
  ASSERT_TRUE(late.wait_until([&] { return late.bus.statuses().size() == 2; }));
  EXPECT_EQ(late.bus.statuses().at(RegionId{0}).status.step, 4);
  EXPECT_EQ(late.bus.statuses().at(RegionId{1}).status.text, "all is well");
  EXPECT_FALSE(late.bus.statuses().at(RegionId{1}).lost);
  ASSERT_TRUE(one.wait_until([&] { return one.bus.statuses().size() == 2; })) << "nodes see each other and themselves";
  EXPECT_EQ(late.bus.refused().total(), 0U);
}

TEST(Status, SaysThatAKilledNodeIsLostAndThatItIsBack) {
  Member observer(116);
  testing::Peer region_zero(116, 0, {1});
  const std::vector<std::string> words = {AURASIM_BINARY_DIR "/dds_peer_process", "116", "1", "0", "run"};
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

TEST(Status, OfAnotherRegionCannotBePublished) {
  Member zero(117, 0);
  EXPECT_THROW(zero.bus.publish_status(status_of(1)), std::logic_error);
  Member launcher(117);
  EXPECT_THROW(launcher.bus.publish_status(status_of(1)), std::logic_error);
}

TEST(Maps, AreSeenByLateJoiners) {
  Member launcher(117);
  ASSERT_TRUE(launcher.bus.publish_map(map_of(77)));
  ASSERT_TRUE(launcher.bus.publish_map(map_of(78)));
  Member late(117);
  ASSERT_TRUE(late.wait_until([&] { return late.bus.maps().size() == 2; }));
  EXPECT_EQ(late.bus.maps().at(77).scene, "tower");
  EXPECT_EQ(late.bus.maps().at(78).regions.size(), 2U);
}

TEST(Commands, ReachEveryoneInOrderOnceAndAlsoLateJoiners) {
  Member launcher(118);
  Member node(118, 0, 77);
  ASSERT_TRUE(launcher.wait_until([&] { return launcher.bus.listeners() == 1; }));
  launcher.bus.send(command_of(RunCommandKind::kStart));
  launcher.bus.send(command_of(RunCommandKind::kPause));
  EXPECT_THAT(node.take_commands(2), ElementsAre(RunCommandKind::kStart, RunCommandKind::kPause));
  Member late(118, 1, 77);
  EXPECT_THAT(late.take_commands(2), ElementsAre(RunCommandKind::kStart, RunCommandKind::kPause));
  EXPECT_TRUE(launcher.bus.take_commands().empty()) << "nobody is told what it said itself";
}

TEST(Commands, ThatAreSentTwiceCountOnce) {
  Member launcher(119);
  Member tool(119);
  Member node(119, 0);
  ASSERT_TRUE(launcher.wait_until([&] { return launcher.bus.listeners() == 2 && tool.bus.listeners() == 2; }));
  RunCommand command = command_of(RunCommandKind::kStep);
  command.request = launcher.bus.send(command);
  launcher.bus.send(command);
  tool.bus.send(command);
  EXPECT_THAT(node.take_commands(2, 500ms), ElementsAre(RunCommandKind::kStep));
}

TEST(Commands, ForAnotherMapAreRefused) {
  Member launcher(120);
  Member node(120, 0, 99);
  RunCommand command = command_of(RunCommandKind::kStop);
  launcher.bus.send(command);
  command.map_version = 0;
  command.kind = RunCommandKind::kPause;
  launcher.bus.send(command);
  EXPECT_THAT(node.take_commands(1), ElementsAre(RunCommandKind::kPause));
  EXPECT_EQ(node.bus.refused().count(WireError::kMapVersion), 1U);
}

}  // namespace
}  // namespace aurasim::dds
