// The report of a run, from records written by hand: who is alive, lost, there twice, dead, or not accounted for.
#include "records/report.h"

#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "scratch_folder.h"

namespace aurasim::records {
namespace {

using core::RegionId;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

class Merged : public ::testing::Test {
 protected:
  Merged() {
    for (int region = 0; region < 2; ++region) {
      append(region, "steps.csv",
             "region,step,frame_ms,wait_ms,physics_ms,protocol_ms,transport_ms,cut_ms,hash_ms,bodies,awake,"
             "foreign_auras,projecting,largest_cluster,hand_offs_out,hand_offs_in,violations");
      append(region, "migrations.csv",
             "region,direction,stamp,joined_step,body,epoch,source,destination,reason,touched");
      append(region, "births.csv", "region,body,birth_step");
      append(region, "removals.csv", "region,body,removed_step");
      append(region, "bodies.csv", "region,body,epoch,birth_step,where,x_m,y_m,z_m,qw,qx,qy,qz");
      append(region, "state_hash.csv", "step,hash");
      last_word(region, {{"outcome", "finished"}, {"steps", 10}, {"real_time_factor", 1.0}});
    }
  }

  std::filesystem::path file(int region, const std::string& name) const {
    return folder_ / ("region_" + std::to_string(region)) / name;
  }
  void append(int region, const std::string& name, const std::string& line) const {
    std::filesystem::create_directories(file(region, name).parent_path());
    std::ofstream(file(region, name), std::ios::app) << line << '\n';
  }
  void last_word(int region, Json word) const {
    word["region"] = region;
    std::ofstream(file(region, "node.json")) << word;
  }
  void born(int region, int body) const {
    append(region, "births.csv", std::to_string(region) + "," + std::to_string(body) + ",0");
  }
  void hosted(int region, int body, const char* where = "here") const {
    append(region, "bodies.csv",
           std::to_string(region) + "," + std::to_string(body) + ",0,0," + where + ",0,0,0,1,0,0,0");
  }
  /// A row of `teller`: a change of host, pulled by an aura, with no contact since the last.
  void moved(int teller, const char* direction, int body, int epoch, int source, int destination) const {
    append(teller, "migrations.csv",
           std::to_string(teller) + "," + direction + ",5,6," + std::to_string(body) + "," + std::to_string(epoch) +
               "," + std::to_string(source) + "," + std::to_string(destination) + ",aura_collision,0");
  }
  Accounts merge(std::vector<RegionId> died = {}) {
    RunFacts facts;
    facts.regions = 2;
    facts.died = std::move(died);
    const Accounts accounts = merge_report(folder_, facts);
    summary_ = Json::parse(std::ifstream(folder_ / "summary.json"));
    return accounts;
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
  Json summary_;
};

TEST_F(Merged, CountsEveryBodyOnceWhereverItIs) {
  for (const int body : {1, 2, 3}) born(0, body);
  hosted(0, 1);
  hosted(1, 2);
  hosted(0, 3, "under_way");
  const Accounts accounts = merge();
  EXPECT_EQ(accounts.bodies, 3U);
  EXPECT_EQ(accounts.lost, 0U);
  EXPECT_EQ(accounts.duplicated, 0U);
}

TEST_F(Merged, SaysWhatShareOfTheTimeWentIntoRedos) {
  EXPECT_EQ(merge().redo_share, 0);
  const Json redo = {{"from_step", 9}, {"to_step", 5}, {"pairs", Json::array()}};
  last_word(0, {{"outcome", "finished"}, {"computing_s", 6.0}, {"in_redos_s", 1.0}, {"redos", Json::array({redo})}});
  last_word(1, {{"outcome", "finished"}, {"computing_s", 2.0}, {"in_redos_s", 0.5}, {"redos", Json::array({redo})}});
  const Accounts accounts = merge();
  EXPECT_EQ(accounts.redos, 1U);
  EXPECT_DOUBLE_EQ(accounts.redo_share, 1.5 / 8);
  EXPECT_DOUBLE_EQ(summary_["redo_share"].get<double>(), 1.5 / 8);
}

TEST_F(Merged, NamesWhoIsNowhere) {
  born(0, 1);
  born(1, 2);
  hosted(0, 1);
  EXPECT_EQ(merge().lost, 1U);
  EXPECT_EQ(summary_.at("lost"), Json::array({2}));
}

TEST_F(Merged, SeesWhoIsThereTwice) {
  born(0, 1);
  hosted(0, 1);
  hosted(1, 1);
  EXPECT_EQ(merge().duplicated, 1U);
}

TEST_F(Merged, ABodyThatWasTakenOutIsNotLost) {
  born(0, 1);
  append(1, "removals.csv", "1,1,7");
  EXPECT_EQ(merge().lost, 0U);
}

TEST_F(Merged, ABodyGoesDownWithTheRegionThatHadItLast) {
  born(0, 1);
  moved(0, "out", 1, 1, 0, 1);
  moved(1, "in", 1, 1, 0, 1);
  const Accounts accounts = merge({RegionId{1}});
  EXPECT_EQ(accounts.lost, 0U);
  ASSERT_EQ(accounts.dead.size(), 1U);
  EXPECT_EQ(accounts.dead[0].bodies, 1U);
}

TEST_F(Merged, WhatADeadRegionHadSentAndNobodyAdoptedDiedWithIt) {
  born(1, 1);
  moved(1, "out", 1, 1, 1, 0);
  EXPECT_EQ(merge({RegionId{1}}).dead.at(0).bodies, 1U);
  EXPECT_EQ(summary_.at("bodies_lost"), 0);
}

TEST_F(Merged, AHandOffThatBothSidesTellOfIsOne) {
  born(0, 1);
  hosted(1, 1);
  moved(0, "out", 1, 1, 0, 1);
  moved(1, "in", 1, 1, 0, 1);
  EXPECT_EQ(merge().hand_offs, 1U);
}

TEST_F(Merged, ThereAndBackWithoutAContactIsThrashing) {
  born(0, 1);
  hosted(0, 1);
  moved(0, "out", 1, 1, 0, 1);
  moved(1, "out", 1, 2, 1, 0);
  EXPECT_EQ(merge().thrashed, 1U);
}

TEST_F(Merged, WhereRecordsEndEarlyNobodyIsCalledLost) {
  born(0, 1);
  last_word(1, {{"outcome", "finished"}, {"records_end", {{"after_step", 888}, {"why", "the disk is full"}}}});
  const Accounts accounts = merge();
  EXPECT_EQ(accounts.lost, 0U);
  EXPECT_EQ(accounts.unaccounted, 1U);
  ASSERT_EQ(accounts.incomplete.size(), 1U);
  EXPECT_EQ(accounts.incomplete[0].region, RegionId{1});
  EXPECT_EQ(summary_.at("incomplete_regions")[0].at("after_step"), 888);
}

TEST_F(Merged, HashesOfAStateAreAddedUpOverAllRowsAndRegions) {
  append(0, "state_hash.csv", "0,0000000000000001");
  append(0, "state_hash.csv", "0,0000000000000010");
  append(1, "state_hash.csv", "0,ffffffffffffffff");
  append(1, "state_hash.csv", "2,000000000000000a");
  merge();
  std::ifstream in(folder_ / "state_hash.csv");
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  EXPECT_THAT(lines, ElementsAre("step,hash", "0,0000000000000010", "2,000000000000000a"));
}

TEST_F(Merged, ASummaryFitsOnAFullDiskAndSaysWhatDoesNot) {
  for (int step = 0; step < 2000; ++step)
    append(0, "steps.csv", "0," + std::to_string(step) + ",1,0,1,0,0,0.25,0.5,1,1,0,0,1,0,0,0");
  reserve_summary(folder_);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{40'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  const Accounts accounts = merge();
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(accounts.not_merged, ElementsAre("steps.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "steps.csv"));
  EXPECT_EQ(summary_.at("not_merged"), Json::array({"steps.csv"}));
  ASSERT_EQ(summary_.at("regions").size(), 1U) << "frame times are read from the regions' own files";
  EXPECT_EQ(summary_.at("regions")[0].at("cut_ms").at("p50"), 0.25);
  EXPECT_EQ(summary_.at("regions")[0].at("hash_ms").at("p50"), 0.5);
}

TEST_F(Merged, ClearingLeavesWhatIsNotAReport) {
  std::ofstream(folder_ / "notes.txt") << "mine";
  std::filesystem::create_directories(folder_ / "region_of_interest");
  merge();
  EXPECT_TRUE(has_records(folder_));
  clear_report(folder_);
  EXPECT_FALSE(has_records(folder_));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "notes.txt"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "region_of_interest"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "summary.json"));
}

}  // namespace
}  // namespace aurasim::records
