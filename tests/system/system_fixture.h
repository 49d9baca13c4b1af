// A test that runs the real program. Each has a DDS domain of its own (own_domain.h), all traffic stays on loopback,
// and when it ends no process and no shared memory may be left.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "own_domain.h"
#include "process.h"
#include "report.h"

namespace aurasim::system_test {

using Words = std::vector<std::string>;

inline Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A launch file of the project.
std::string launch_file(const std::string& name);

/// `--set key=value` for each of these.
Words set(const Words& overrides);
/// `--set dds.domain=N`: the running test's, or its second one.
Words in_own_domain(std::size_t which = 0);

class SystemTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Where this test may write; removed at the end if it passes.
  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const;

  /// Starts a program; `words[0]` is its path.
  Process& start_program(const Words& words);
  /// Starts `aurasim` with these words.
  Process& start(const Words& words);
  /// Starts `aurasim launch FILE --headless --report ... --set dds.domain=... ` and more, in this test's domain. Its
  /// report is report_of(name).
  Process& launch(const std::string& name, const std::string& file, const Words& more = {});
  Report report_of(const std::string& name) const { return Report(folder_ / name); }

  /// The process of a region's node; 0: there is none.
  pid_t node_of(const Process& launcher, int region) const;
  void kill_node(const Process& launcher, int region) const;

  void expect_exit(Process& process, int code, Clock::duration time_out = kGenerous) const;
  /// Waits until every node of a run has written down this step.
  void expect_reaches(const Report& report, int regions, std::int64_t step, Clock::duration time_out = kGenerous) const;
  /// No body is lost, and none is there twice.
  void expect_all_bodies_accounted_for(const Report& report) const;
  void expect_nobody_left(Clock::duration time_out) const;

 private:
  std::filesystem::path folder_;
  std::vector<std::unique_ptr<Process>> processes_;
  std::set<std::string> shared_memory_;
};

}  // namespace aurasim::system_test
