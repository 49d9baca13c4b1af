// `aurasim echo` prints every topic of a run.
#include <sstream>

#include <nlohmann/json.hpp>

#include "messages/wire_error.h"
#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class Echo : public SystemTest {
 protected:
  const std::string file_ = launch_file("corner_stacks");
  const Words in_domain_ = in_own_domain();

  Process& echo(const std::string& topic, const Words& more = {}) {
    return start(Words{"echo", topic, file_, "--json", "--duration", "20"} + in_domain_ + more);
  }

  /// One per line; fails where a line is no JSON.
  std::vector<nlohmann::json> samples_of(Process& echo) {
    expect_exit(echo, 0);
    std::vector<nlohmann::json> samples;
    std::istringstream lines(echo.out());
    for (std::string line; std::getline(lines, line);) {
      samples.push_back(nlohmann::json::parse(line, nullptr, false));
      EXPECT_TRUE(samples.back().is_object()) << line;
      EXPECT_EQ(samples.back().value("version", 0), messages::kProtocolVersion) << line;
    }
    return samples;
  }
};

TEST_F(Echo, PrintsEveryTopic) {
  Process& run = launch("run", file_);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 1));
  std::map<std::string, Process*> echoes;
  for (const char* topic : {"node_status", "region_map", "replica", "replica_key", "migration", "run_control",
                            "command", "command_reply", "shape", "orders", "cluster_graph"}) {
    echoes[topic] = &echo(topic, {"--count", "1"});
  }
  Process& auras = echo("aura", {"--count", "30", "--partition", "region/2"});
  const std::vector<nlohmann::json> of_region_2 = samples_of(auras);
  ASSERT_EQ(of_region_2.size(), 30U);
  for (std::size_t i = 0; i < of_region_2.size(); ++i) {
    EXPECT_EQ(of_region_2[i].at("source"), 2);
    EXPECT_EQ(of_region_2[i].at("v_WB").size(), 3 * of_region_2[i].at("id").size());
    if (i > 0) {
      EXPECT_GT(of_region_2[i].at("stamp"), of_region_2[i - 1].at("stamp"));
    }
  }
  Process& sent = start(Words{"send", "static", file_, "--mesh", AURASIM_SOURCE_DIR "/tests/config/meshes/wedge.obj",
                              "--p", "30", "30", "5"} +
                        in_domain_);
  expect_exit(sent, 0);
  for (const auto& [topic, process] : echoes) {
    SCOPED_TRACE(topic);
    const std::vector<nlohmann::json> samples = samples_of(*process);
    ASSERT_EQ(samples.size(), 1U) << process->said();
  }
  const nlohmann::json command = nlohmann::json::parse(echoes["command"]->out());
  EXPECT_EQ(command.at("p"), (std::vector<double>{30, 30, 5}));
  const nlohmann::json mesh = nlohmann::json::parse(echoes["shape"]->out());
  EXPECT_EQ(mesh.at("hash"), command.at("mesh"));
  EXPECT_FALSE(mesh.at("triangles").empty());
  expect_exit(start(Words{"send", "stop", file_} + in_domain_), 0);
  expect_exit(run, 0);
}

TEST_F(Echo, AnUnknownTopicIsRefused) {
  Process& program = start({"echo", "aurora", file_});
  expect_exit(program, 2);
  EXPECT_THAT(program.err() + program.out(), ::testing::HasSubstr("cluster_graph"));
}

}  // namespace
}  // namespace aurasim::system_test
