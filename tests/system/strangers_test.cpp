// A run of which anybody may say anything: without keys, what cannot be true is refused, and the world does not notice.
#include <fstream>
#include <string>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::HasSubstr;

class Strangers : public SystemTest {
 protected:
  Process& run(const std::string& name) {
    return launch(name, launch_file("corner_stacks"), Words{"--steps", "1200"} + set({"time.sync=deterministic"}));
  }
  Process& run_as_fast_as_it_goes(const std::string& name) {
    return launch(name, launch_file("corner_stacks"),
                  Words{"--steps", "3000"} + set({"time.sync=deterministic", "time.pace=none"}));
  }
  /// KiB.
  static long memory_of(pid_t process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    for (std::string word; status >> word;) {
      long size = 0;
      if (word == "VmRSS:" && status >> size) return size;
    }
    return 0;
  }
};

TEST_F(Strangers, WhoForgesWhatNodesSayChangesNoBitAndEndsNobody) {
  Process& attacked = run("attacked");
  expect_reaches(report_of("attacked"), 4, 60);
  std::vector<pid_t> nodes;
  std::vector<long> before_KiB;
  for (int region = 0; region < 4; ++region) {
    nodes.push_back(node_of(attacked, region));
    before_KiB.push_back(memory_of(nodes.back()));
  }
  Process& stranger =
      start_program({AURASIM_BINARY_DIR "/dds_stranger_process", std::to_string(test::own_domain()), "400"});
  ASSERT_TRUE(
      wait_until([&] { return stranger.out().find("done") != std::string::npos || !attacked.running(); }, kGenerous))
      << stranger.said() << attacked.said();
  ASSERT_TRUE(attacked.running()) << attacked.said();
  for (std::size_t r = 0; r < nodes.size(); ++r) {
    EXPECT_EQ(node_of(attacked, static_cast<int>(r)), nodes[r]) << "its node was started again";
    EXPECT_LT(memory_of(nodes[r]), before_KiB[r] + 200 * 1024) << "region " << r;
  }
  expect_exit(attacked, 0, 2 * kGenerous);
  expect_all_bodies_accounted_for(report_of("attacked"));
  EXPECT_THAT(attacked.err(), HasSubstr("has another node"));
  EXPECT_THAT(attacked.err(), HasSubstr("is not listened to any more"));
  stranger.signal(SIGKILL);
  EXPECT_TRUE(stranger.wait(kGenerous));

  Process& alone = run("alone");
  expect_exit(alone, 0, 2 * kGenerous);
  EXPECT_TRUE(report_of("attacked").state_hash() == report_of("alone").state_hash());
  EXPECT_GT(report_of("alone").count("migrations"), 50);
}

/// 17 readers that take no samples and ask for all of them with each heartbeat: a run was 60 times slower.
TEST_F(Strangers, WhoListensAndNeverReadsSlowsNobodyDown) {
  using Seconds = std::chrono::duration<double>;
  const auto start = Clock::now();
  Process& alone = run_as_fast_as_it_goes("alone");
  expect_exit(alone, 0, 2 * kGenerous);
  const auto undisturbed = Clock::now() - start;

  const auto again = Clock::now();
  Process& attacked = run_as_fast_as_it_goes("attacked");
  Process& stranger =
      start_program({AURASIM_BINARY_DIR "/dds_stranger_process", std::to_string(test::own_domain()), "60", "deaf"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("attacked"), 4, 300));
  std::vector<pid_t> nodes;
  std::vector<long> before_KiB;
  for (int region = 0; region < 4; ++region) {
    nodes.push_back(node_of(attacked, region));
    before_KiB.push_back(memory_of(nodes.back()));
  }
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("attacked"), 4, 2800, 3 * undisturbed + kGenerous));
  for (std::size_t r = 0; r < nodes.size(); ++r) {
    EXPECT_LT(memory_of(nodes[r]), before_KiB[r] + 50 * 1024) << "region " << r;
  }
  EXPECT_TRUE(stranger.running()) << stranger.said();
  expect_exit(attacked, 0, 2 * kGenerous);
  const Seconds disturbed = Clock::now() - again;
  EXPECT_LT(disturbed.count(), 3 * Seconds(undisturbed).count() + 5);
  EXPECT_THAT(attacked.err(), HasSubstr("asks for more to be sent again than it is given"));
  EXPECT_TRUE(report_of("attacked").state_hash() == report_of("alone").state_hash());
  stranger.signal(SIGKILL);
  EXPECT_TRUE(stranger.wait(kGenerous));
}

}  // namespace
}  // namespace aurasim::system_test
