#include "system_fixture.h"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iostream>

#include <sys/wait.h>
#include <unistd.h>

namespace aurasim::system_test {
namespace {

/// Segments of DDS. (Other programs of this host may come and go in /dev/shm as they like.)
std::set<std::string> shared_memory_of_dds() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    const std::string name = entry.path().filename();
    if (name.find("fastrtps") != std::string::npos || name.find("fastdds") != std::string::npos) names.insert(name);
  }
  return names;
}

/// Does a process that lives have it mapped? (Another test's, that runs beside this one.)
bool is_in_use(const std::string& name) {
  for (const auto& process : std::filesystem::directory_iterator("/proc")) {
    if (read_text(process.path() / "maps").find("/dev/shm/" + name) != std::string::npos) return true;
  }
  return false;
}

/// What is there now, was not there `before`, and belongs to nobody.
std::set<std::string> shared_memory_left(const std::set<std::string>& before) {
  std::set<std::string> left;
  for (const std::string& name : shared_memory_of_dds()) {
    if (!before.contains(name) && !is_in_use(name)) left.insert(name);
  }
  return left;
}

}  // namespace

std::string launch_file(const std::string& name) { return AURASIM_SOURCE_DIR "/launch_configs/" + name + ".yaml"; }

Words set(const Words& overrides) {
  Words words;
  for (const std::string& change : overrides) words = words + Words{"--set", change};
  return words;
}

Words in_own_domain(std::size_t which) { return set({"dds.domain=" + std::to_string(test::own_domain(which))}); }

void SystemTest::SetUp() {
  adopt_orphans();
  std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
  std::replace(name.begin(), name.end(), '/', '_');
  folder_ = std::filesystem::path(::testing::TempDir()) / ("aurasim_" + std::to_string(::getpid()) + "_" + name);
  std::filesystem::remove_all(folder_);
  std::filesystem::create_directories(folder_);
  shared_memory_ = shared_memory_of_dds();
}

void SystemTest::TearDown() {
  const bool stopped_early = HasFatalFailure();
  for (const auto& process : processes_) {
    if (HasFailure()) std::cerr << process->said() << '\n';
  }
  processes_.clear();
  const Words left = end_all_children();
  if (!stopped_early) {
    EXPECT_THAT(left, ::testing::IsEmpty()) << "these were still running";
  }
  EXPECT_THAT(shared_memory_left(shared_memory_), ::testing::IsEmpty()) << "/dev/shm";
  if (!HasFailure()) std::filesystem::remove_all(folder_);
}

std::filesystem::path SystemTest::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
  return folder_ / name;
}

Process& SystemTest::start_program(const Words& words) {
  const std::filesystem::path prefix = folder_ / ("process_" + std::to_string(processes_.size()));
  processes_.push_back(std::make_unique<Process>(words, prefix));
  return *processes_.back();
}

Process& SystemTest::start(const Words& words) { return start_program(Words{AURASIM_BINARY_DIR "/aurasim"} + words); }

Process& SystemTest::launch(const std::string& name, const std::string& file, const Words& more) {
  return start(Words{"launch", file, "--headless", "--report", (folder_ / name).string()} + in_own_domain() + more);
}

pid_t SystemTest::node_of(const Process& launcher, int region) const {
  for (const pid_t child : children_of(launcher.pid())) {
    const Words words = command_line_of(child);
    const auto flag = std::find(words.begin(), words.end(), "--region");
    if (flag != words.end() && flag + 1 != words.end() && *(flag + 1) == std::to_string(region)) return child;
  }
  return 0;
}

void SystemTest::kill_node(const Process& launcher, int region) const {
  const pid_t node = node_of(launcher, region);
  ASSERT_GT(node, 0);
  ::kill(node, SIGKILL);
}

void SystemTest::expect_exit(Process& process, int code, Clock::duration time_out) const {
  const std::optional<int> found = process.wait(time_out);
  ASSERT_TRUE(found) << "still running\n" << process.said();
  EXPECT_EQ(*found, code) << process.said();
}

void SystemTest::expect_reaches(const Report& report, int regions, std::int64_t step, Clock::duration time_out) const {
  const auto all_there = [&] {
    for (int region = 0; region < regions; ++region) {
      if (report.recorded_step(region) < step) return false;
    }
    return true;
  };
  ASSERT_TRUE(wait_until(all_there, time_out)) << "step " << step << " of " << report.folder();
}

void SystemTest::expect_all_bodies_accounted_for(const Report& report) const {
  const nlohmann::json summary = report.summary();
  EXPECT_EQ(summary.at("bodies_lost"), 0) << summary.at("lost");
  EXPECT_EQ(summary.at("bodies_duplicated"), 0);
  EXPECT_EQ(summary.at("bodies_alive").get<int>() + summary.at("bodies_with_dead_regions").get<int>(),
            summary.at("bodies_spawned").get<int>());
}

void SystemTest::expect_nobody_left(Clock::duration time_out) const {
  const auto nobody = [] {
    for (const pid_t child : children_of(::getpid())) {
      if (::waitpid(child, nullptr, WNOHANG) != child) return false;
    }
    return true;
  };
  EXPECT_TRUE(wait_until(nobody, time_out));
}

}  // namespace aurasim::system_test
