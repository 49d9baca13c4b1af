// The overseer beside real runs.
#include <csignal>

#include <sys/wait.h>

#include "overseer/web_client.h"
#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using overseer::testing::Page;
using overseer::testing::request;
using overseer::testing::http::verb;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class Overseers : public SystemTest {
 protected:
  void start_run(const Words& more = {}) {
    run_ = &launch("run", file_, more);
    ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 30));
  }

  /// Port in the address that a program has printed; 0 if it prints none.
  static std::uint16_t port_of(Process& program, Clock::duration time_out = 10s) {
    const std::string head = "http://127.0.0.1:";
    wait_until([&] { return program.out().find(head) != std::string::npos; }, time_out);
    const std::string said = program.out();
    const std::size_t at = said.find(head);
    return at == std::string::npos ? 0 : static_cast<std::uint16_t>(std::stoi(said.substr(at + head.size())));
  }

  Process& start_overseer(const Words& more = {}) {
    return start(Words{"overseer", file_, "--port", "0"} + in_own_domain() + more);
  }

  static std::uint64_t sum_of(const Json& status, const char* key) {
    std::uint64_t sum = 0;
    for (const Json& node : status.at("nodes")) sum += node.at(key).get<std::uint64_t>();
    return sum;
  }
  /// All nodes, in one state.
  static bool all_stand(const Json& status) {
    const auto is_there = [&](const Json& node) { return node.at("step") == status.at("step"); };
    return status.value("state", "") == "paused" && std::ranges::all_of(status.at("nodes"), is_there);
  }
  /// Where nodes do not wait for each other, bodies that were handed over before the last state may belong to nobody
  /// yet; those that are handed over in it still count.
  static bool shows_all_bodies(const Page& page) {
    const Json& status = page.latest.at("status");
    const std::uint64_t shown = page.world.by_id().size(), hosted = sum_of(status, "bodies");
    const std::uint64_t under_way = sum_of(status, "hand_offs_out") - sum_of(status, "hand_offs_in");
    return page.world.stamp == status.at("step").get<double>() && shown >= hosted && shown <= hosted + under_way;
  }

  static bool sees_the_run(Page& page) {
    return page.wait_until(
        [&] { return page.has("status") && page.latest["status"].at("nodes").size() == 4 && page.world.frames > 0; });
  }

  /// Ctrl-C, as the last thing.
  void end_run(int code = 0) {
    run_->signal(SIGINT);
    expect_exit(*run_, code);
  }

  /// Pauses the run and expects the page to show every body that there is.
  void expect_whole_when_paused(Page& page) {
    ASSERT_TRUE(sees_the_run(page));
    const Json reply = page.ask({{"kind", "pause"}});
    ASSERT_EQ(reply.value("ok", false), true) << reply;
    ASSERT_TRUE(page.wait_until([&] { return all_stand(page.latest["status"]) && shows_all_bodies(page); }))
        << page.latest["status"] << page.world.bodies.size() << " bodies, stamp " << page.world.stamp;
  }

  const std::string file_ = launch_file("corner_stacks");
  Process* run_ = nullptr;
};

TEST_F(Overseers, APageSeesTheWholeWorldAndSteersIt) {
  ASSERT_NO_FATAL_FAILURE(start_run());
  Process& overseer = start_overseer();
  Page page(port_of(overseer));
  ASSERT_TRUE(page.open()) << overseer.said();
  ASSERT_TRUE(page.wait_until([&] {
    return page.has("hello") && page.has("scene") && page.has("map") && page.has("status") &&
           page.latest["status"].at("nodes").size() == 4 && page.world.bodies.size() >= 96;
  }));
  EXPECT_EQ(page.latest["hello"].at("mode"), "live");
  EXPECT_EQ(page.latest["scene"].at("prototypes").size(), 4U);
  EXPECT_EQ(page.latest["map"].at("regions").size(), 4U);
  EXPECT_EQ(page.latest["map"].at("regions")[0].at("x0"), nullptr);
  EXPECT_EQ(page.latest["status"].at("state"), "running");

  page.send(Json{{"type", "show"}, {"auras", true}});
  EXPECT_TRUE(page.wait_until([&] { return page.overlays.size() > 16; })) << "auras of bodies near the borders";
  page.send(Json{{"type", "show"}, {"auras", false}});
  page.send(Json{{"type", "watch"}, {"slot", page.world.bodies.begin()->first}});
  EXPECT_TRUE(page.wait_until([&] { return page.has("body"); }));

  ASSERT_NO_FATAL_FAILURE(expect_whole_when_paused(page));
  const double paused_at = page.world.stamp;
  EXPECT_EQ(page.ask({{"kind", "step"}, {"count", 5}}).at("ok"), true);
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp == paused_at + 5; })) << page.world.stamp;
  EXPECT_THAT(page.ask({{"kind", "spawn"}, {"prototype", "no such thing"}, {"p", {0, 0, 5}}}).at("text"),
              ::testing::HasSubstr("no prototype"));
  EXPECT_THAT(page.ask({{"kind", "move"}, {"static", "ground"}, {"p", {0, 0, 1}}}).at("text"),
              ::testing::HasSubstr("a plane cannot move"));
  EXPECT_THAT(page.ask({{"kind", "move"}, {"static", "no such gate"}}).at("text"),
              ::testing::HasSubstr("the name or number of a static"));
  EXPECT_THAT(page.ask({{"kind", "drain"}, {"region", 9}}).at("text"), ::testing::HasSubstr("there is no region 9"));
  EXPECT_EQ(page.ask({{"kind", "resume"}}).at("ok"), true);
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp > paused_at + 20; }));
  EXPECT_EQ(page.ask({{"kind", "step"}}).at("ok"), false) << "not while it runs";
  EXPECT_EQ(page.ask({{"kind", "reset"}}).at("ok"), true);
  EXPECT_TRUE(page.wait_until([&] { return page.world.generation == 1 && page.world.stamp > 30; }));
  EXPECT_GE(page.world.by_id().size(), 96U);
  EXPECT_EQ(page.latest["scene"].at("generation"), 1);
  EXPECT_THAT(request(port_of(overseer), verb::get, "/metrics").body, HasSubstr("aurasim_step{region=\"3\"}"));
  overseer.signal(SIGTERM);
  expect_exit(overseer, 0);
  end_run();
  expect_all_bodies_accounted_for(report_of("run"));
}

TEST_F(Overseers, MayBeKilledAndStartedAgainAndNoNodeNotices) {
  ASSERT_NO_FATAL_FAILURE(start_run({"--duration", "6"}));
  for (int i = 0; i < 2; ++i) {
    Process& overseer = start_overseer();
    Page page(port_of(overseer));
    EXPECT_TRUE(page.wait_until([&] { return page.world.by_id().size() >= 96; })) << overseer.said();
    overseer.signal(SIGKILL);
    expect_exit(overseer, 128 + SIGKILL);
  }
  Process& last = start_overseer();
  Page page(port_of(last));
  ASSERT_NO_FATAL_FAILURE(expect_whole_when_paused(page));
  EXPECT_EQ(page.ask({{"kind", "resume"}}).at("ok"), true);
  expect_exit(*run_, 0);
  expect_all_bodies_accounted_for(report_of("run"));
  EXPECT_TRUE(page.wait_until([&] { return page.latest["status"].at("state") == "finished"; }));
}

TEST_F(Overseers, HostileInputIsRefusedAndTheRunGoesOn) {
  ASSERT_NO_FATAL_FAILURE(start_run());
  Process& overseer = start_overseer({"--token", "open sesame"});
  const std::uint16_t port = port_of(overseer);
  EXPECT_FALSE(Page(port, {{"Origin", "http://evil.example"}}).open());
  EXPECT_EQ(request(port, verb::get, "/", {{"Host", "evil.example"}}).status, 403U);
  EXPECT_EQ(request(port, verb::get, "/../../../../etc/passwd").status, 404U);
  overseer::testing::raw(port, std::string(70'000, '\xff'));
  EXPECT_FALSE(Page(port, {{"Authorization", "Bearer guess"}}).open());
  Page page(port);
  ASSERT_TRUE(sees_the_run(page));
  EXPECT_EQ(page.ask({{"kind", "pause"}}).at("ok"), false);
  Page operators(port, {{"Authorization", "Bearer open sesame"}});
  operators.send(std::string(R"({"type":"command","request":"x","command":{"kind":"step","count":1e308}})"));
  EXPECT_TRUE(operators.wait_until([&] { return operators.replies.contains("x"); }));
  EXPECT_EQ(operators.ask({{"kind", "pause"}}).at("ok"), true);
  EXPECT_TRUE(overseer.running() && run_->running());
  end_run();
}

TEST_F(Overseers, FilesOfTlsThatCannotBeUsedAreNamedWithTheirPlace) {
  write("key.pem", "no key");
  const std::string file = write("launch.yaml", "scene: " + launch_file("scenes/two_spheres") +
                                                    "\nregions: {count: 1}\noverseer:\n  port: 0\n"
                                                    "  tls: {certificate: nowhere.pem, key: key.pem}\n");
  for (const char* command : {"overseer", "check", "launch"}) {
    Process& program = start({command, file});
    expect_exit(program, 2);
    EXPECT_THAT(program.err(), HasSubstr("launch.yaml:5:22: overseer.tls.certificate: found")) << command;
    EXPECT_THAT(program.err(), HasSubstr("nowhere.pem")) << command;
  }
}

TEST_F(Overseers, AReplaySpeaksHttpsWithFilesThatCanBeUsed) {
  const std::string recording = write("recording", "none").string(), key = write("key.pem", "no key").string();
  Process& without_key = start({"replay", recording, "--tls-certificate", "nowhere.pem"});
  EXPECT_TRUE(without_key.wait(kGenerous));
  EXPECT_THAT(without_key.err(), HasSubstr("--tls-key"));
  Process& without_certificate = start({"replay", recording, "--tls-certificate", "nowhere.pem", "--tls-key", key});
  expect_exit(without_certificate, 2);
  EXPECT_THAT(without_certificate.err(), HasSubstr("--tls-certificate: "));
  EXPECT_THAT(without_certificate.err(), HasSubstr("nowhere.pem"));
}

TEST_F(Overseers, SayWhenARunHasEndedBecauseANodeDied) {
  const Words stops = set({"survival.on_death=stop"});
  ASSERT_NO_FATAL_FAILURE(start_run(stops));
  Process& overseer = start_overseer(stops);
  Page page(port_of(overseer));
  ASSERT_TRUE(sees_the_run(page));
  ASSERT_NO_FATAL_FAILURE(kill_node(*run_, 2));
  expect_exit(*run_, 1);
  const auto is_lost = [&] { return page.latest["status"].at("nodes")[2].at("lost") == true; };
  EXPECT_TRUE(page.wait_until(is_lost, kGenerous));  // the status comes by itself
  EXPECT_TRUE(page.wait_until([&] { return page.latest["status"].at("state") == "lost"; }, kGenerous))
      << page.latest["status"];
}

TEST_F(Overseers, APageLivesThroughADeathAndItsWordStillCounts) {
  const Words own = set({"time.sync=deterministic", "survival.checkpoint=0.5"});
  ASSERT_NO_FATAL_FAILURE(start_run(own));
  Process& overseer = start_overseer(own);
  Page page(port_of(overseer));
  ASSERT_TRUE(sees_the_run(page));
  ASSERT_NO_FATAL_FAILURE(kill_node(*run_, 2));
  // They may be back before a status could say that they recover.
  const auto is_back = [&] {
    return run_->err().find("region 2 went back to state") != std::string::npos ||
           run_->out().find("region 2 went back to state") != std::string::npos;
  };
  ASSERT_TRUE(page.wait_until(is_back, kGenerous)) << run_->said();
  ASSERT_TRUE(page.wait_until([&] { return page.latest["status"].at("state") == "running"; }, kGenerous));
  const std::int64_t then = page.world.stamp;
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp > then + 60; }, kGenerous));
  EXPECT_EQ(page.ask({{"kind", "pause"}}).at("ok"), true);
  const auto stands = [&] {
    const Json& status = page.latest["status"];
    return all_stand(status) && page.world.stamp == status.at("step").get<double>() &&
           page.world.by_id().size() >= sum_of(status, "bodies");
  };
  EXPECT_TRUE(page.wait_until(stands, kGenerous))
      << page.latest["status"] << page.world.by_id().size() << " bodies, stamp " << page.world.stamp;
  EXPECT_EQ(page.ask({{"kind", "resume"}}).at("ok"), true);
  end_run();
}

TEST_F(Overseers, ARecordingGoesOnAfterADeath) {
  const std::string recording = (folder() / "recording").string();
  run_ = &launch(
      "run", file_,
      Words{"--record", recording, "--steps", "360"} + set({"time.sync=deterministic", "survival.checkpoint=0.5"}));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 90));
  ASSERT_NO_FATAL_FAILURE(kill_node(*run_, 1));
  expect_exit(*run_, 0);
  Process& replay = start({"replay", recording, "--port", "0"});
  Page page(port_of(replay));
  ASSERT_TRUE(page.wait_until([&] { return page.has("hello") && page.has("replay") && page.has("scene"); }))
      << replay.said();
  // States that were computed twice are in it twice, as they were seen, and some after the last one that was confirmed.
  const Json last = page.latest["hello"].at("last");
  EXPECT_GT(last, 360);
  page.send(Json{{"type", "replay"}, {"action", "pause"}});
  page.send(Json{{"type", "replay"}, {"action", "seek"}, {"value", last}});
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp >= 360; })) << page.world.stamp << " of " << last;
  EXPECT_GE(page.world.by_id().size(), static_cast<std::size_t>(report_of("run").count("bodies_alive")));
}

TEST_F(Overseers, WhatTheyRecordIsShownAgain) {
  const std::string recording = (folder() / "recording").string();
  Process& run = launch("run", file_, {"--record", recording, "--duration", "4"});
  expect_exit(run, 0);
  Process& replay = start({"replay", recording, "--port", "0"});
  Page page(port_of(replay));
  ASSERT_TRUE(page.wait_until([&] { return page.has("hello") && page.has("replay") && page.has("scene"); }))
      << replay.said();
  const Json hello = page.latest["hello"];
  EXPECT_EQ(hello.at("mode"), "replay");
  EXPECT_EQ(hello.at("scene"), "corner_stacks");
  EXPECT_EQ(hello.at("last"), 240);
  page.send(Json{{"type", "replay"}, {"action", "pause"}});
  page.send(Json{{"type", "replay"}, {"action", "seek"}, {"value", 240}});
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp == 240; }));
  EXPECT_EQ(page.world.by_id().size(), static_cast<std::size_t>(report_of("run").count("bodies_alive")));
  page.send(Json{{"type", "replay"}, {"action", "seek"}, {"value", 120}});
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp == 120; }));
  EXPECT_EQ(page.ask({{"kind", "pause"}}).at("ok"), false);
}

TEST_F(Overseers, ALaunchBringsOneAndTakesAnotherPortWhenItsOwnIsTaken) {
  Process& first = start(Words{"launch", file_} + in_own_domain() + set({"overseer.port=0"}));
  const std::uint16_t port = port_of(first);
  ASSERT_GT(port, 0);
  Process& second = start(Words{"overseer", file_, "--port", std::to_string(port)} + in_own_domain());
  const std::uint16_t other = port_of(second);
  EXPECT_NE(other, port);
  EXPECT_THAT(second.out(), HasSubstr("port " + std::to_string(port) + " is taken"));
  for (const std::uint16_t each : {port, other}) {
    Page page(each);
    EXPECT_TRUE(page.wait_until([&] { return page.world.by_id().size() >= 96; })) << each;
  }
  first.signal(SIGINT);
  expect_exit(first, 0);
}

}  // namespace
}  // namespace aurasim::system_test
