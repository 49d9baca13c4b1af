// `aurasim send`, and what `aurasim top` shows of it.
#include <map>
#include <sstream>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

/// A line of the live table.
struct Row {
  std::string state;
  std::int64_t step = 0;
};

class Steering : public SystemTest {
 protected:
  void send(const Words& words) {
    SCOPED_TRACE(words[0]);
    expect_exit(start(Words{"send"} + words + Words{file_} + in_own_domain()), 0);
  }

  /// By region, as `aurasim top` tells.
  std::map<int, Row> statuses() {
    Process& top = start(Words{"top", file_, "--duration", "1"} + in_own_domain());
    expect_exit(top, 0);
    std::map<int, Row> rows;
    std::istringstream in(top.out());
    for (std::string line; std::getline(in, line);) {
      std::istringstream cells(line);
      int region = 0;
      Row row;
      if (cells >> region >> row.state >> row.step) rows[region] = row;
    }
    return rows;
  }

  /// Every node says so; returns the step, which must be the same everywhere.
  std::int64_t expect_all(const std::string& state) {
    const std::map<int, Row> rows = statuses();
    EXPECT_EQ(rows.size(), 4U);
    if (rows.empty()) return -1;
    for (const auto& [region, row] : rows) {
      EXPECT_EQ(row.state, state) << "region " << region;
      EXPECT_TRUE(state != "paused" || row.step == rows.begin()->second.step)
          << "region " << region << ": " << row.step;
    }
    return rows.begin()->second.step;
  }

  /// One row per region and step from 0 on: nothing is left of the world before the reset.
  void expect_only_the_last_world_recorded(const Report& report, std::int64_t last) const {
    const Table steps = report.steps();
    EXPECT_EQ(steps.rows(), static_cast<std::size_t>(4 * (last + 1)));
    std::map<std::int64_t, std::int64_t> next;
    for (std::size_t row = 0; row < steps.rows(); ++row) {
      EXPECT_EQ(steps.whole(row, "step"), next[steps.whole(row, "region")]++) << "row " << row;
    }
    EXPECT_EQ(Table(report.folder() / "state_hash.csv").rows(), static_cast<std::size_t>(last + 1));
  }

  const std::string file_ = launch_file("demo");
};

TEST_F(Steering, PauseStepResumeResetStop) {
  const Report report = report_of("run");
  Process& run = launch("run", file_);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 60));

  send({"pause"});
  const std::int64_t paused_at = expect_all("paused");
  EXPECT_EQ(expect_all("paused"), paused_at);

  send({"step", "--count", "5"});
  EXPECT_EQ(expect_all("paused"), paused_at + 5);

  send({"resume"});
  const std::int64_t resumed_at = expect_all("running");
  EXPECT_GT(resumed_at, paused_at + 5);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 300));

  send({"reset"});
  send({"pause"});
  const std::int64_t paused_again_at = expect_all("paused");
  EXPECT_LT(paused_again_at, resumed_at) << "the world begins anew";

  send({"reset"});
  EXPECT_EQ(expect_all("paused"), 0) << "a run that is paused stands in its first state";
  send({"step", "--count", "7"});
  EXPECT_EQ(expect_all("paused"), 7);

  send({"stop"});
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report);
  EXPECT_EQ(report.count("steps"), 7);
  expect_only_the_last_world_recorded(report, 7);
}

}  // namespace
}  // namespace aurasim::system_test
