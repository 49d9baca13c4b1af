// When a look at the roster shows something new, without DDS.
#include "dds/node_roster.h"

#include <chrono>
#include <csignal>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace aurasim::dds {
namespace {

using core::RegionId;

class ARoster : public ::testing::Test {
 protected:
  static Guid writer_of(unsigned char process) {
    Guid guid;
    guid.guidPrefix.value[0] = process;
    guid.entityId = 0x103U;
    return guid;
  }
  explicit ARoster(RosterSettings of = settings()) : roster_(std::move(of), speakers_) {}
  void receive_status(std::uint32_t region, unsigned char process, bool by_hub = false) {
    messages::Status status;
    status.region = RegionId{region};
    status.process = process;
    Origin origin;
    origin.writer = writer_of(process);
    origin.by_hub = by_hub;
    roster_.note(status, origin);
  }
  void look() { roster_.look({live_writer(1), live_writer(2)}); }
  void look_at_news() { roster_.look_at_news({live_writer(1), live_writer(2)}); }
  static RemoteWriter live_writer(unsigned char process) {
    RemoteWriter writer;
    writer.guid = writer_of(process);
    writer.order = process;
    writer.alive = true;
    return writer;
  }
  static RosterSettings settings() {
    RosterSettings settings;
    settings.region_count = 4;
    return settings;
  }

  Speakers speakers_;
  NodeRoster roster_;
};

TEST_F(ARoster, HasNewsOnceAStatusHasCome) {
  EXPECT_FALSE(roster_.has_news());
  receive_status(2, 1);
  EXPECT_TRUE(roster_.has_news());
  look();
  EXPECT_FALSE(roster_.has_news());
  EXPECT_EQ(roster_.statuses().size(), 1U);
}

TEST_F(ARoster, LooksOnlyAtRegionsWithNews) {
  receive_status(2, 1);
  receive_status(3, 3);
  look_at_news();
  EXPECT_FALSE(roster_.has_news());
  EXPECT_FALSE(roster_.statuses().at(RegionId{2}).lost);
  EXPECT_TRUE(roster_.statuses().at(RegionId{3}).lost) << "nobody has such a writer";
  receive_status(1, 2);
  roster_.look_at_news({live_writer(2)});
  EXPECT_FALSE(roster_.statuses().at(RegionId{1}).lost);
  EXPECT_FALSE(roster_.statuses().at(RegionId{2}).lost) << "it was not looked at";
  roster_.look({live_writer(2)});
  EXPECT_TRUE(roster_.statuses().at(RegionId{2}).lost);
}

TEST_F(ARoster, KnowsWhoLivesByItsProcessWhereAStatusCameByAHub) {
  RosterSettings here = settings();
  here.stays_on_this_host = true;
  NodeRoster roster(here, speakers_);
  const auto receive = [&](std::uint32_t region, unsigned char process, std::uint32_t pid) {
    messages::Status status;
    status.region = RegionId{region};
    status.process = process;
    status.pid = pid;
    Origin origin;
    origin.writer = writer_of(process);
    origin.by_hub = true;
    roster.note(status, origin);
  };
  receive(1, 7, static_cast<std::uint32_t>(::getpid()));
  receive(2, 8, 0x3fffffff);
  roster.look({});
  EXPECT_FALSE(roster.statuses().at(RegionId{1}).lost) << "no writer of it is matched here, and the hub may be gone";
  EXPECT_TRUE(roster.statuses().at(RegionId{2}).lost) << "there is no such process";
}

TEST_F(ARoster, WaitsForTheLastWordOfAProcessThatHasEndedWhereItComesByAHub) {
  RosterSettings here = settings();
  here.stays_on_this_host = true;
  here.until_last_word = std::chrono::milliseconds(200);
  NodeRoster roster(here, speakers_);
  const pid_t child = ::fork();
  if (child == 0) {
    ::pause();
    ::_exit(0);
  }
  messages::Status status;
  status.region = RegionId{1};
  status.process = 7;
  status.pid = static_cast<std::uint32_t>(child);
  Origin origin;
  origin.writer = writer_of(7);
  origin.by_hub = true;
  roster.note(status, origin);
  roster.look({});
  const auto alive = std::chrono::steady_clock::now();
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  roster.look({});
  if (std::chrono::steady_clock::now() < alive + here.until_last_word / 2) {
    EXPECT_FALSE(roster.statuses().at(RegionId{1}).lost) << "its last status may be on its way";
  }
  std::this_thread::sleep_for(here.until_last_word);
  roster.look({});
  EXPECT_TRUE(roster.statuses().at(RegionId{1}).lost);
}

/// Statuses that come by hubs of several hosts, in virtual time. Hubs are processes 101 and 102.
class ARosterByHubs : public ARoster {
 protected:
  ARosterByHubs() : ARoster(by_hubs([this] { return now_; })) {
    for (const unsigned char hub : {101, 102}) speakers_.add_hub(writer_of(hub).guidPrefix);
  }
  static constexpr auto kSilence = std::chrono::milliseconds(15500);
  static RosterSettings by_hubs(std::function<std::chrono::steady_clock::time_point()> now) {
    RosterSettings by_hubs = settings();
    by_hubs.silence_by_hub = kSilence;
    by_hubs.now = std::move(now);
    return by_hubs;
  }
  void hub_comes(unsigned char number) {
    hubs_.push_back(live_writer(number));
    hubs_.back().since = now_;
  }
  /// Looks several times a second; meanwhile statuses come of `heard`, which is process and region.
  void pass(std::chrono::milliseconds time, const std::vector<unsigned char>& heard) {
    for (const auto end = now_ + time; now_ < end; now_ += std::chrono::milliseconds(100)) {
      for (const unsigned char one : heard) receive_status(one, one, true);
      roster_.look(hubs_);
    }
  }
  bool is_lost(std::uint32_t region) const { return roster_.statuses().at(RegionId{region}).lost; }

  std::chrono::steady_clock::time_point now_{std::chrono::hours(1)};
  std::vector<RemoteWriter> hubs_;
};

TEST_F(ARosterByHubs, TakesANodeForLostOfWhichNoHubPassesAnythingOn) {
  hub_comes(101);
  pass(std::chrono::seconds(5), {1, 2});
  pass(kSilence - std::chrono::milliseconds(200), {1});
  EXPECT_FALSE(is_lost(2)) << "a hub may have been cut off, without anybody noticing it";
  pass(std::chrono::milliseconds(500), {1});
  EXPECT_TRUE(is_lost(2));
  EXPECT_FALSE(is_lost(1));
  pass(std::chrono::milliseconds(100), {1, 2});
  EXPECT_FALSE(is_lost(2)) << "it is back";
}

TEST_F(ARosterByHubs, TakesNobodyForLostWhileNoHubIsThere) {
  hub_comes(101);
  pass(std::chrono::seconds(5), {1, 2});
  hubs_[0].matched = false;
  pass(std::chrono::minutes(5), {});
  EXPECT_FALSE(is_lost(1));
  EXPECT_FALSE(is_lost(2));
}

TEST_F(ARosterByHubs, TakesNobodyForLostWhileTheHubIsSilent) {
  hub_comes(101);
  pass(std::chrono::seconds(5), {1, 2});
  hubs_[0].silent_since = now_;  // not believed yet by the watch, whose grace goes on
  pass(std::chrono::minutes(5), {});
  EXPECT_FALSE(is_lost(1));
}

TEST_F(ARosterByHubs, GivesANewHubTimeToMeetTheNodes) {
  hub_comes(101);
  pass(std::chrono::seconds(5), {1, 2});
  hubs_.clear();
  pass(std::chrono::minutes(1), {});
  hub_comes(102);
  pass(kSilence - std::chrono::seconds(1), {});
  EXPECT_FALSE(is_lost(2)) << "it has to announce itself to the hub first";
  pass(std::chrono::seconds(2), {1});
  EXPECT_TRUE(is_lost(2)) << "it died while no hub was there";
  EXPECT_FALSE(is_lost(1));
}

TEST_F(ARosterByHubs, TakesNobodyForLostBecauseOneOfTwoHubsIs) {
  hub_comes(101);
  hub_comes(102);
  pass(std::chrono::seconds(5), {1, 2});
  hubs_[0].matched = false;
  pass(std::chrono::minutes(5), {1, 2});
  EXPECT_FALSE(is_lost(1));
  pass(std::chrono::minutes(1), {1});
  EXPECT_TRUE(is_lost(2)) << "the other hub would have passed it on";
}

TEST_F(ARosterByHubs, FirstTakesWhatHasComeWhileItSlept) {
  hub_comes(101);
  pass(std::chrono::seconds(5), {1, 2});
  now_ += std::chrono::minutes(1);
  pass(std::chrono::milliseconds(500), {});
  EXPECT_FALSE(is_lost(2)) << "DDS has not taken it yet";
  pass(std::chrono::seconds(3), {1});
  EXPECT_FALSE(is_lost(1));
  EXPECT_TRUE(is_lost(2));
}

TEST_F(ARosterByHubs, BelievesThatAProcessHasDiedOnlyOnceAHubWouldKnowBetter) {
  hub_comes(101);
  pass(std::chrono::seconds(5), {1, 2});
  roster_.receive_death(1);
  roster_.receive_death(2);
  pass(std::chrono::seconds(2), {1});
  EXPECT_FALSE(is_lost(1)) << "a hub still passes on what it says";
  EXPECT_TRUE(is_lost(2));
}

TEST_F(ARosterByHubs, BelievesNoDeathWhileNoHubIsThere) {
  hub_comes(101);
  pass(std::chrono::seconds(5), {1});
  hubs_.clear();
  roster_.receive_death(1);
  pass(std::chrono::minutes(1), {});
  EXPECT_FALSE(is_lost(1));
}

TEST_F(ARoster, LooksAtAllAfterADeath) {
  receive_status(2, 1);
  look();
  receive_status(1, 2);
  roster_.hold_for_dead(1);
  look_at_news();
  EXPECT_TRUE(roster_.statuses().at(RegionId{2}).dead);
}

TEST_F(ARoster, HasNewsOfADeath) {
  receive_status(2, 1);
  look();
  roster_.hold_for_dead(1);
  EXPECT_TRUE(roster_.has_news());
  look();
  EXPECT_TRUE(roster_.statuses().at(RegionId{2}).dead);
  roster_.receive_death(1);
  EXPECT_TRUE(roster_.has_news()) << "a report of it";
}

}  // namespace
}  // namespace aurasim::dds
