// Commands of clients to a real run: `aurasim send spawn, static, impulse, remove, rate, regions, scene, ray`.
#include <set>

#include <nlohmann/json.hpp>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class Commands : public SystemTest {
 protected:
  void run(const std::string& name, const Words& overrides, std::int64_t steps) {
    file_ = launch_file("corner_stacks");
    name_ = name;
    overrides_ = overrides;
    run_ = &launch(name, file_, Words{"--steps", std::to_string(steps)} + set(overrides));
  }

  void wait_for(int regions, std::int64_t step) { expect_reaches(report_of(name_), regions, step); }

  /// What it says, as JSON; null if it fails.
  nlohmann::json send(const Words& words, int code = 0) {
    SCOPED_TRACE(words[0]);
    Process& process = start(Words{"send", words[0], file_} + Words(words.begin() + 1, words.end()) + set(overrides_) +
                             in_own_domain());
    expect_exit(process, code);
    last_error_ = process.err();
    return code == 0 ? nlohmann::json::parse(process.out(), nullptr, false) : nlohmann::json();
  }

  void expect_end() {
    expect_exit(*run_, 0);
    expect_all_bodies_accounted_for(report_of(name_));
  }

  /// The same commands in the same states, wherever the bodies are hosted and however long each takes to be sent.
  void send_one_of_each() {
    const Words at = {"--at", "400"};
    send({"pause"});
    EXPECT_EQ(send(Words{"spawn", "--radius", "0.5", "--mass", "3", "--p", "1", "1", "8", "--v", "2", "0", "0"} + at)
                  .value("step", 0),
              400);
    send(Words{"spawn", "--size", "0.6", "0.6", "0.6", "--p", "-1", "-0.2", "9"} + at);
    send(Words{"static", "--size", "4", "0.5", "3", "--p", "0", "3", "1.5"} + at);
    send(Words{"impulse", "--body", "1", "--J", "0", "3", "2"} + at);
    send({"resume"});
  }

  void expect_the_bits_of_a_run_that_keeps_its_regions(const Words& overrides) {
    const Words deterministic = {"time.sync=deterministic"};
    run("redrawn", deterministic + overrides, 600);
    wait_for(4, 60);
    send({"regions", "--boxes", "-100", "-100", "-10", "100", "-10", "-100", "0", "100", "0", "-100", "10", "100", "10",
          "-100", "100", "100"});
    send({"regions", "--boxes", "-100", "-100", "100", "-9", "-100", "-9", "100", "0", "-100", "0", "100", "9", "-100",
          "9", "100", "100"});
    send({"regions", "--boxes", "-100", "-100", "0", "100", "0", "-100", "100", "100"}, 1);
    EXPECT_NE(last_error_.find("2 regions for 4 nodes"), std::string::npos) << last_error_;
    expect_end();
    run("kept", deterministic + Words{"time.pace=none", "regions.count=1"}, 600);
    expect_end();
    EXPECT_EQ(first_difference(report_of("redrawn").state_hash(), report_of("kept").state_hash()), "");
  }

  Process* run_ = nullptr;
  Words overrides_;
  std::string name_, file_, last_error_;
};

TEST_F(Commands, InDeterministicModeHaveTheSameBitsOnOneNodeAndOnFour) {
  const Words deterministic = {"time.sync=deterministic"};
  run("four", deterministic, 700);
  wait_for(4, 1);
  send_one_of_each();
  expect_end();
  EXPECT_GT(report_of("four").count("migrations"), 50);
  const std::string four = report_of("four").state_hash();
  run("one", deterministic + Words{"regions.count=1"}, 700);
  wait_for(1, 1);
  send_one_of_each();
  expect_end();
  EXPECT_EQ(first_difference(four, report_of("one").state_hash()), "");
}

/// Nobody feels it: the run has the bits of one that kept its regions.
TEST_F(Commands, RegionsAreDrawnAnewInMidRun) { expect_the_bits_of_a_run_that_keeps_its_regions({}); }

/// Blocks have other owners from one state to the next, and a heap over the old borders is cut by the new ones.
TEST_F(Commands, CoupledRegionsAreDrawnAnewInMidRun) {
  expect_the_bits_of_a_run_that_keeps_its_regions({"exchange=coupled"});
}

TEST_F(Commands, ARayFindsWhatEveryRegionHosts) {
  run("rays", {}, 100'000);
  wait_for(4, 30);
  send({"static", "--size", "2", "2", "2", "--p", "30", "30", "1"});
  const auto hit = send({"ray", "--from", "30", "30", "20", "--to", "30", "30", "-5"});
  EXPECT_TRUE(hit.value("complete", false)) << hit;
  EXPECT_NEAR(hit.value("distance_m", 0.0), 18, 1e-6) << hit;
  const auto above = send({"ray", "--from", "30", "30", "20", "--to", "30", "30", "40"});
  EXPECT_FALSE(above.value("hit", true)) << above;
  send({"impulse", "--body", "3000001", "--J", "0", "0", "1"}, 1);
  EXPECT_NE(last_error_.find("there is no body 3000001"), std::string::npos) << last_error_;
  send({"velocity", "--body", "5", "--v", "100", "0", "0"}, 1);
  EXPECT_NE(last_error_.find("faster than this run promises"), std::string::npos) << last_error_;
  send({"velocity", "--body", "5", "--v", "0", "0", "0", "--w", "1e5", "1e5", "1e5"}, 1);
  EXPECT_NE(last_error_.find("quarter turn in a substep"), std::string::npos) << last_error_;
  send({"impulse", "--body", "5", "--J", "9e6", "0", "0"}, 1);
  EXPECT_NE(last_error_.find("it would make the body"), std::string::npos) << last_error_;
  send({"rate", "--value", "0.01"});  // the end does not wait for states that are seconds apart
  start(Words{"send", "stop", file_} + in_own_domain());
  expect_exit(*run_, 0);
}

/// No node has seen it: the lead waits until all have.
TEST_F(Commands, ABodyOfANewMeshIsSpawnedAndNamed) {
  run("meshes", {}, 100'000);
  wait_for(4, 30);
  const std::string meshes = std::string(AURASIM_SOURCE_DIR) + "/tests/config/meshes/";
  std::set<std::int64_t> ids;
  for (const Words& mesh : {Words{meshes + "wedge.obj"}, Words{meshes + "wedge.obj", "--parts"},
                            Words{meshes + "wedge.stl"}, Words{meshes + "wedge.gltf"}}) {
    const auto reply = send(Words{"spawn", "--p", "0", "0", "40", "--mesh"} + mesh);
    EXPECT_GE(reply.value("body", std::int64_t{0}), 1'000'000'000) << reply;
    ids.insert(reply.value("body", std::int64_t{0}));
  }
  EXPECT_EQ(ids.size(), 4U);
  start(Words{"send", "stop", file_} + in_own_domain());
  expect_exit(*run_, 0);
}

TEST_F(Commands, ASceneIsChosenAndTheRunGoesOn) {
  run("scenes", {}, 400);
  wait_for(4, 60);
  send({"rate", "--value", "0.000001"}, 2);
  send({"rate", "--value", "0.01"});
  send({"rate", "--value", "2"});  // the states until an order's own would take half a minute
  send({"scene", "--name", "nosuch"}, 1);
  EXPECT_NE(last_error_.find("there is no scene"), std::string::npos) << last_error_;
  send({"scene", "--name", "tower"});
  expect_end();
  EXPECT_EQ(report_of("scenes").count("bodies_alive"), 21) << "the 20 slabs of the tower and the ball";
}

}  // namespace
}  // namespace aurasim::system_test
