// Whole runs that nothing disturbs.
#include <algorithm>
#include <set>
#include <utility>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::HasSubstr;

class Launch : public SystemTest {
 protected:
  void expect_no_broken_promise_to_bodies(const Report& report) const {
    expect_all_bodies_accounted_for(report);
    for (const char* key : {"thrashed", "late_collisions", "missed_collisions", "severed_contacts"}) {
      EXPECT_EQ(report.count(key), 0) << key;
    }
  }

  /// Exactly one row for each region and state, and the hash of each state.
  void expect_every_step_recorded(const Report& report, std::int64_t regions, std::int64_t last) const {
    const Table steps = report.steps();
    std::set<std::pair<std::int64_t, std::int64_t>> seen;
    for (std::size_t row = 0; row < steps.rows(); ++row) {
      const std::int64_t region = steps.whole(row, "region");
      const std::int64_t step = steps.whole(row, "step");
      EXPECT_TRUE(0 <= region && region < regions && 0 <= step && step <= last) << region << ", " << step;
      EXPECT_TRUE(seen.insert({region, step}).second) << "twice: region " << region << ", step " << step;
    }
    EXPECT_EQ(seen.size(), static_cast<std::size_t>(regions * (last + 1)));
    const Table hashes(report.folder() / "state_hash.csv");
    ASSERT_EQ(hashes.rows(), static_cast<std::size_t>(last + 1));
    for (std::size_t row = 0; row < hashes.rows(); ++row) {
      EXPECT_EQ(hashes.whole(row, "step"), static_cast<std::int64_t>(row));
    }
  }

  /// Every change of host was told by both sides, once each; only those of the last moment are still under way.
  void expect_every_departure_arrives_once(const Report& report, std::int64_t last) const {
    const Table moves = report.migrations();
    std::set<std::pair<std::int64_t, std::int64_t>> departed, arrived, under_way;
    for (std::size_t row = 0; row < moves.rows(); ++row) {
      const std::pair move(moves.whole(row, "body"), moves.whole(row, "epoch"));
      const bool out = moves.text(row, "direction") == "out";
      EXPECT_TRUE((out ? departed : arrived).insert(move).second) << "body " << move.first << ", epoch " << move.second;
      if (out && moves.whole(row, "stamp") >= last - 3) under_way.insert(move);
    }
    for (const auto& move : arrived) EXPECT_TRUE(departed.contains(move)) << move.first << ", " << move.second;
    for (const auto& move : departed) {
      EXPECT_TRUE(arrived.contains(move) || under_way.contains(move)) << move.first << ", " << move.second;
    }
  }
};

TEST_F(Launch, EndsWithALineWithoutATableAndAReport) {
  Process& run = start(Words{"launch", launch_file("two_spheres"), "--headless", "--steps", "90"} + in_own_domain());
  expect_exit(run, 0);
  EXPECT_THAT(run.out(),
              ::testing::MatchesRegex("ended with state 90, 1.50 s: 2 bodies, [0-9]+ hand-offs, 0 late and 0 "
                                      "missed collisions(; broken promises: .*)?\n"))
      << run.said();
}

TEST_F(Launch, OneBodyCrossesOneBorderBetweenTwoProcesses) {
  const Report report = report_of("run");
  Process& run = start(Words{"launch", launch_file("two_spheres"), "--duration", "2"} + in_own_domain() +
                       Words{"--report", report.folder().string()});
  expect_exit(run, 0);
  expect_no_broken_promise_to_bodies(report);
  EXPECT_EQ(report.count("bodies_spawned"), 2);
  EXPECT_GE(report.count("migrations"), 1);
  const Table collisions = report.collisions();
  ASSERT_GE(collisions.rows(), 1U);
  EXPECT_EQ(collisions.whole(0, "body_a"), 0);
  EXPECT_EQ(collisions.whole(0, "body_b"), 1);
  EXPECT_EQ(collisions.whole(0, "step"), 72) << "19 m at 16 m/s are 71.25 steps";
  EXPECT_NEAR(collisions.number(0, "relative_speed_m_s"), 16, 1e-9);
  EXPECT_THAT(run.out(), HasSubstr("frame ms")) << "the live table";
}

TEST_F(Launch, DemoHandsBodiesOver) {
  const Report report = report_of("run");
  expect_exit(launch("run", launch_file("demo"), {"--duration", "8"}), 0);
  expect_no_broken_promise_to_bodies(report);
  EXPECT_GT(report.count("migrations"), 50);
  EXPECT_EQ(report.count("steps"), 480);
  expect_every_step_recorded(report, 4, 480);
  expect_every_departure_arrives_once(report, 480);
  for (const auto& [file, header] : {
           std::pair{"steps.csv",
                     "region,step,frame_ms,wait_ms,physics_ms,protocol_ms,transport_ms,cut_ms,hash_ms,bodies,awake,"
                     "foreign_auras,"
                     "projecting,largest_cluster,hand_offs_out,hand_offs_in,violations"},
           std::pair{"collisions.csv",
                     "region,step,body_a,body_b,penetration_m,relative_speed_m_s,penetration_time_s,late,missed,"
                     "violation_flagged"},
           std::pair{"migrations.csv",
                     "region,direction,stamp,joined_step,body,epoch,source,destination,reason,touched"},
           std::pair{"violations.csv", "region,step,kind,of_region,body,value,allowed"},
           std::pair{"state_hash.csv", "step,hash"},
       }) {
    EXPECT_EQ(Table(report.folder() / file).header(), header) << file;
  }
  for (int region = 0; region < 4; ++region) {
    const auto folder = report.region_folder(region);
    EXPECT_EQ(Table(folder / "births.csv").header(), "region,body,birth_step");
    EXPECT_EQ(Table(folder / "bodies.csv").header(), "region,body,epoch,birth_step,where,x_m,y_m,z_m,qw,qx,qy,qz");
    EXPECT_EQ(nlohmann::json::parse(read_text(folder / "node.json")).at("outcome"), "finished");
  }
  EXPECT_EQ(report.entry("regions").size(), 4U);
  for (const auto& region : report.entry("regions")) {
    for (const char* phase : {"frame_ms", "physics_ms", "protocol_ms", "transport_ms"}) {
      const auto& times = region.at(phase);
      EXPECT_TRUE(times.at("p50") <= times.at("p99") && times.at("p99") <= times.at("max")) << phase << " " << times;
      EXPECT_GT(times.at("max"), 0.0) << phase;
    }
  }
}

}  // namespace
}  // namespace aurasim::system_test
