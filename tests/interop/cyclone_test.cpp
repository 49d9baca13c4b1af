// A run is heard and steered by a program that was made with Cyclone DDS from the same IDL.
#include <cstdlib>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

/// Loopback only, and found by multicast, as the nodes are.
constexpr const char* kCycloneOnLoopback =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"true\"/>"
    "</Interfaces><AllowMulticast>true</AllowMulticast></General></Domain></CycloneDDS>";

class Cyclone : public SystemTest {
 protected:
  void expect_reads_and_is_obeyed(const std::string& configuration, const Words& discovery, const Words& more = {}) {
    ::setenv("CYCLONEDDS_URI", configuration.c_str(), 1);
    Process& run = launch("run", launch_file("corner_stacks"), discovery);
    ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 1));
    Process& peer =
        start_program(Words{AURASIM_BINARY_DIR "/cyclone_peer", std::to_string(test::own_domain()), "4"} + more);
    expect_exit(peer, 0);
    EXPECT_THAT(peer.out(), ::testing::HasSubstr("was made, pushed and seen to rise"));
    expect_exit(start(Words{"send", "stop", launch_file("corner_stacks")} + in_own_domain() + discovery), 0);
    expect_exit(run, 0);
    expect_all_bodies_accounted_for(report_of("run"));
    EXPECT_THAT(run.err(), ::testing::Not(::testing::HasSubstr("refused")));
  }
};

TEST_F(Cyclone, ReadsEveryRegionAndItsCommandsAreObeyed) { expect_reads_and_is_obeyed(kCycloneOnLoopback, {}); }

TEST_F(Cyclone, MeetsTheNodesByMulticastWhereTheyHaveAHub) {
  expect_reads_and_is_obeyed(kCycloneOnLoopback, set({"dds.discovery=neighbours"}), {"by_hub"});
}

TEST_F(Cyclone, MeetsTheNodesByTheHubOfTheRun) {
  const std::string hub = "127.0.0.1:" + std::to_string(7402 + 250 * test::own_domain());
  expect_reads_and_is_obeyed(
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
      "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<Peers><Peer Address=\"" +
          hub + "\"/></Peers></Discovery></Domain></CycloneDDS>",
      set({"dds.discovery=neighbours"}), {"by_hub"});
}

}  // namespace
}  // namespace aurasim::system_test
