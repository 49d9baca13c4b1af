// A capture of a run's traffic says what it is to anybody's eyes: tshark knows topics by name.
#include <fstream>
#include <map>
#include <sstream>

#include <unistd.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class Tshark : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    if (::geteuid() != 0) GTEST_SKIP() << "capturing needs root";
  }

  /// What tshark prints of the capture; one line per packet that `filter` lets through. Port 13400, of domain 24, is
  /// also that of another protocol (DoIP), for which tshark would take the announcements.
  std::string tshark(const std::filesystem::path& capture, const Words& options) {
    Process& program =
        start_program(Words{"/usr/bin/tshark", "-r", capture.string(), "-n", "--disable-protocol", "doip"} + options);
    expect_exit(program, 0);
    return program.out();
  }

  /// The UDP ports of a domain (RTPS 2.5, section 9.6.2.3).
  static std::string ports() {
    const int first = static_cast<int>(7400 + 250 * test::own_domain());
    return "udp portrange " + std::to_string(first) + "-" + std::to_string(first + 249);
  }
};

TEST_F(Tshark, NamesTheTopicsOfARunAndFindsNothingMalformed) {
  const std::filesystem::path capture = folder() / "run.pcap";
  Process& capturing =
      start_program({"/usr/bin/tcpdump", "-i", "lo", "-U", "-w", capture.string(), "-Z", "root", ports()});
  ASSERT_TRUE(wait_until([&] { return capturing.err().find("listening on lo") != std::string::npos; }, 10s))
      << capturing.said();
  Process& run = launch("run", launch_file("corner_stacks"), {"--steps", "120"});
  expect_exit(run, 0);
  capturing.signal(SIGINT);
  expect_exit(capturing, 0);

  EXPECT_EQ(tshark(capture, {"-Y", "_ws.malformed"}), "");
  // Of data that are not discovery, in which topics introduce themselves: the topic is known by the writer's id alone.
  const std::string said = tshark(capture, {"-Y", "rtps.sm.id == 0x15 && rtps.sm.wrEntityId.entityKind == 0x02", "-T",
                                            "fields", "-e", "rtps.param.topicName", "-E", "occurrence=f"});
  std::map<std::string, int> data;
  std::istringstream lines(said);
  for (std::string topic; std::getline(lines, topic);) ++data[topic];
  for (const char* topic : {"aura", "node_status", "region_map", "run_control", "migration"}) {
    EXPECT_GT(data[topic], 0) << topic;
  }
  EXPECT_GT(data["aura"], 4 * 3 * 100) << "each of four nodes tells three neighbours of each of 120 steps";
}

}  // namespace
}  // namespace aurasim::system_test
