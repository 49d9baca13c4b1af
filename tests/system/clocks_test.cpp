// Hosts whose wall clocks are wrong, or are set while the world runs. Nodes on their own, as on separate hosts;
// libfaketime gives some of them another clock.
#include <fstream>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::ContainsRegex;

class WrongClocks : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    for (const auto& entry : std::filesystem::directory_iterator("/usr/lib")) {
      const auto library = entry.path() / "faketime" / "libfaketime.so.1";
      if (std::filesystem::exists(library)) faketime_ = library;
    }
    if (faketime_.empty()) GTEST_SKIP() << "no libfaketime";
  }

  /// A node that ends by _exit leaves what libfaketime has made for it.
  void TearDown() override {
    SystemTest::TearDown();
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
      const std::string name = entry.path().filename();
      if (name.find("faketime_") == std::string::npos) continue;
      const std::string pid = name.substr(name.rfind('_') + 1);
      std::error_code gone;
      if (!std::filesystem::exists("/proc/" + pid)) std::filesystem::remove(entry.path(), gone);
    }
  }

  /// Seconds; read by a node with a clock of its own whenever it looks at it.
  void set_clock(int ahead_s) const {
    std::ofstream(folder() / "clock.new") << (ahead_s < 0 ? "" : "+") << ahead_s << '\n';
    std::filesystem::rename(folder() / "clock.new", folder() / "clock");
  }

  Words node(int region, const Words& more) const {
    return Words{AURASIM_BINARY_DIR "/aurasim",     "node", file_, "--region", std::to_string(region), "--report",
                 report_of("run").folder().string()} +
           in_own_domain() + more;
  }
  Words with_own_clock(const Words& words) const {
    return Words{"/usr/bin/env", "LD_PRELOAD=" + faketime_.string(),
                 "FAKETIME_TIMESTAMP_FILE=" + (folder() / "clock").string(), "FAKETIME_NO_CACHE=1",
                 "FAKETIME_DONT_FAKE_MONOTONIC=1"} +
           words;
  }
  /// The node of `odd` has a clock of its own.
  void start_run(int regions, int odd, const Words& more) {
    for (int region = 0; region < regions; ++region) {
      const Words words = node(region, more);
      nodes_.push_back(&start_program(region == odd ? with_own_clock(words) : words));
    }
  }
  void expect_all_finish(Clock::duration time_out = kGenerous) {
    for (Process* one : nodes_) expect_exit(*one, 0, time_out);
  }
  void expect_nobody_is_lost_or_doubled(const Words& overrides) {
    expect_exit(start(Words{"report", file_, report_of("run").folder().string()} + overrides), 0);
    expect_all_bodies_accounted_for(report_of("run"));
  }

  std::filesystem::path faketime_;
  std::string file_ = launch_file("demo");
  std::vector<Process*> nodes_;
};

/// In free_running nobody waits for anybody: a node that ran ahead would be alone with its bodies.
TEST_F(WrongClocks, AClockThatIsSetWhileTheyRunDoublesNobody) {
  const Words free_running = set({"time.sync=free_running"});
  set_clock(0);
  start_run(4, 1, Words{"--duration", "9"} + free_running);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 120));
  set_clock(20);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 300));
  for (int region = 0; region < 4; ++region) EXPECT_LT(report_of("run").recorded_step(region), 530);
  set_clock(-20);
  expect_all_finish();
  EXPECT_THAT(nodes_[1]->err(), ContainsRegex("wall clock was set (19|20)\\.[0-9] s forward"));
  EXPECT_THAT(nodes_[1]->err(), ContainsRegex("wall clock was set (39|40)\\.[0-9] s back"));
  expect_nobody_is_lost_or_doubled(free_running);
}

TEST_F(WrongClocks, ARunBeginsAtOnceWhateverTheClockOfRegionZeroSays) {
  set_clock(90);
  start_run(4, 0, {"--duration", "2"});
  expect_all_finish(kGenerous);  // less than those 90 s
  for (int region = 1; region < 4; ++region) {
    EXPECT_THAT(nodes_[static_cast<std::size_t>(region)]->err(),
                ContainsRegex("region 0's host is (89|90)\\.[0-9] s ahead of this one's"));
  }
  expect_nobody_is_lost_or_doubled({});
}

}  // namespace
}  // namespace aurasim::system_test
