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
  void SetUp() override {
    SystemTest::SetUp();
    ::setenv("CYCLONEDDS_URI", kCycloneOnLoopback, 1);
  }
};

TEST_F(Cyclone, ReadsEveryRegionAndItsCommandsAreObeyed) {
  Process& run = launch("run", launch_file("corner_stacks"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 1));
  Process& peer = start_program({AURASIM_BINARY_DIR "/cyclone_peer", std::to_string(test::own_domain()), "4"});
  expect_exit(peer, 0);
  EXPECT_THAT(peer.out(), ::testing::HasSubstr("was made, pushed and seen to rise"));
  expect_exit(start(Words{"send", "stop", launch_file("corner_stacks")} + in_own_domain()), 0);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("run"));
  EXPECT_THAT(run.err(), ::testing::Not(::testing::HasSubstr("refused")));
}

}  // namespace
}  // namespace aurasim::system_test
