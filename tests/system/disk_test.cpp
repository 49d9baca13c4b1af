// A disk that is full while the nodes write their report.
#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

using FullDisk = SystemTest;

/// No file may grow beyond 50 KiB: that is step 700 or so of a region's steps.csv, and no room for the merged one.
TEST_F(FullDisk, EndsTheRecordsAndNotTheRun) {
  const Report report = report_of("run");
  const std::string command = "ulimit -f 50; exec " AURASIM_BINARY_DIR "/aurasim launch " + launch_file("two_spheres") +
                              " --headless --steps 1500 --set time.pace=none --report " + report.folder().string() +
                              " --set dds.domain=" + std::to_string(test::own_domain());
  Process& run = start_program({"/bin/bash", "-c", command});
  expect_exit(run, 1);
  EXPECT_THAT(run.err(), HasSubstr("end after step"));
  EXPECT_THAT(run.err(), HasSubstr("steps.csv: File too large"));
  EXPECT_EQ(report.count("steps"), 1500) << "the world goes on";
  const nlohmann::json incomplete = report.entry("incomplete_regions");
  ASSERT_EQ(incomplete.size(), 2U);
  for (const auto& region : incomplete) {
    const Table steps(report.region_folder(region.at("region")) / "steps.csv");
    const std::int64_t last = steps.whole(steps.rows() - 1, "step");
    EXPECT_GE(last, region.at("after_step").get<std::int64_t>());
    EXPECT_LT(last, 1500);
    EXPECT_EQ(static_cast<std::int64_t>(steps.rows()), last + 1) << "whole rows, one per step";
  }
  EXPECT_THAT(report.entry("not_merged").get<Words>(), Contains("steps.csv"));
  expect_all_bodies_accounted_for(report);
}

}  // namespace
}  // namespace aurasim::system_test
