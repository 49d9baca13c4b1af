// Four nodes on hosts of their own save worlds: each has a folder, and hears of the others what their statuses say. A
// disk may be full, and a node may die in between.
#include "cut/part_writer.h"

#include <csignal>
#include <fstream>
#include <memory>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "cut/saved_world.h"
#include "scratch_folder.h"

namespace aurasim::cut {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kRegions = 4;
constexpr std::size_t kKeep = 2;

/// As on a disk without room, while it lives.
class NoRoom {
 public:
  explicit NoRoom(bool is_full) : is_full_(is_full) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, SIG_IGN);
    const ::rlimit full{20, before_.rlim_max};
    if (is_full_) ::setrlimit(RLIMIT_FSIZE, &full);
  }
  ~NoRoom() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  bool is_full_;
  ::rlimit before_{};
};

class PartWriters : public testing::Test {
 protected:
  PartWriters() {
    launch_.regions = core::RegionMap::columns(kRegions, 10);
    for (std::uint32_t r = 0; r < kRegions; ++r) start_node(r);
  }

  void start_node(std::uint32_t region) {
    const fs::path saves = folder_of(region);
    nodes_[region] =
        std::make_unique<PartWriter>(PartFolders{saves, saves / "run-1"}, core::RegionId{region}, kRegions, kKeep);
  }
  fs::path folder_of(std::uint32_t region) const { return folder_ / std::to_string(region); }

  void write_part(std::uint32_t region, const std::string& name, core::Step step, SaveKind kind = SaveKind::kAsked) {
    core::WorldCut cut;
    cut.step = step;
    const NoRoom room(full_.contains(region));
    const std::uint64_t request = kind == SaveKind::kAsked ? static_cast<std::uint64_t>(step) : 0;
    nodes_[region]->write(cut, launch_, {1, life_}, kind, request, name);
    nodes_[region]->finish();
  }
  void save(const std::string& name, core::Step step, SaveKind kind = SaveKind::kAsked) {
    for (std::uint32_t r = 0; r < kRegions; ++r) write_part(r, name, step, kind);
  }
  void save_regularly(core::Step step) { save("state-" + std::to_string(step) + ".cut", step, SaveKind::kRegular); }
  void keep_on_disk(core::Step step) { save("state-" + std::to_string(step) + ".cut", step, SaveKind::kKept); }

  /// Statuses go from each to all.
  void let_all_hear() {
    for (int round = 0; round < 2; ++round) {
      for (auto& node : nodes_) {
        for (const PartWriter::Written& one : node->progress(now_)) written_.push_back(one);
      }
      for (std::uint32_t to = 0; to < kRegions; ++to) {
        for (std::uint32_t from = 0; from < kRegions; ++from) {
          const SaveLedger& said = nodes_[from]->ledger();
          nodes_[to]->receive(core::RegionId{from}, said.saved(), said.not_saved());
        }
      }
    }
    for (auto& node : nodes_) {
      node->progress(now_);
      for (const std::string& word : node->take_words()) words_.push_back(word);
    }
  }

  /// As somebody does who brings the parts of all hosts together, and loads the world.
  core::Step state_of(const std::string& name) const {
    const fs::path all = folder_ / "all";
    fs::remove_all(all);
    fs::create_directories(all);
    for (std::uint32_t r = 0; r < kRegions; ++r) {
      for (const fs::path& file : files(r)) fs::copy_file(file, all / file.filename());
    }
    return read_world(all / name).cut.step;
  }
  std::vector<fs::path> files(std::uint32_t region) const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder_of(region))) {
      if (entry.is_regular_file()) found.push_back(entry.path());
    }
    return found;
  }
  std::vector<std::size_t> file_counts() const {
    std::vector<std::size_t> counts;
    for (std::uint32_t r = 0; r < kRegions; ++r) counts.push_back(files(r).size());
    return counts;
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
  config::Launch launch_;
  std::unique_ptr<PartWriter> nodes_[kRegions];
  std::set<std::uint32_t> full_;  ///< regions whose disks are
  std::uint64_t life_ = 1;
  PartWriter::Clock::time_point now_{};
  std::vector<PartWriter::Written> written_;
  std::vector<std::string> words_;
};

TEST_F(PartWriters, ANewWorldReplacesTheOldOneOnAllHosts) {
  save("w.cut", 100);
  let_all_hear();
  EXPECT_EQ(state_of("w.cut"), 100);
  save("w.cut", 200);
  EXPECT_THAT(file_counts(), ElementsAre(2, 2, 2, 2)) << "nobody knows yet whether it is whole";
  let_all_hear();
  EXPECT_EQ(state_of("w.cut"), 200);
  EXPECT_THAT(file_counts(), ElementsAre(1, 1, 1, 1));
  EXPECT_THAT(words_, IsEmpty());
}

TEST_F(PartWriters, OneFullDiskLeavesTheOldWorldAndNothingOfTheNew) {
  save("w.cut", 100);
  let_all_hear();
  full_ = {2};
  save("w.cut", 200);
  let_all_hear();
  EXPECT_EQ(state_of("w.cut"), 100);
  EXPECT_THAT(file_counts(), ElementsAre(1, 1, 1, 1));
  ASSERT_EQ(words_.size(), 1U);
  EXPECT_THAT(words_[0], testing::AllOf(HasSubstr("state 200 was not saved"), HasSubstr("regions [2]"),
                                        HasSubstr("File too large")));
  full_.clear();
  save("w.cut", 300);
  let_all_hear();
  EXPECT_EQ(state_of("w.cut"), 300);
}

TEST_F(PartWriters, ANodeThatDiesInBetweenLeavesTheOldWorld) {
  save("w.cut", 100);
  let_all_hear();
  for (const std::uint32_t survivor : {0U, 1U, 3U}) write_part(survivor, "w.cut", 200);
  start_node(2);  // another process
  let_all_hear();
  EXPECT_EQ(state_of("w.cut"), 100);
  life_ = 2;  // all have gone back, and somebody asks again
  save("w.cut", 190);
  let_all_hear();
  EXPECT_EQ(state_of("w.cut"), 190);
  EXPECT_THAT(file_counts(), ElementsAre(1, 1, 1, 1)) << "and what was half a world is gone";
}

/// All have written their parts of the new world, but one has not heard of that of a node that dies then.
TEST_F(PartWriters, WhoHasNotHeardOfTheLastPartKeepsBoth) {
  save("w.cut", 100);
  let_all_hear();
  save("w.cut", 200);
  for (auto& node : nodes_) node->progress(now_);
  const SaveLedger last = nodes_[2]->ledger();
  start_node(2);
  for (std::uint32_t from : {1U, 3U}) nodes_[0]->receive(core::RegionId{from}, nodes_[from]->ledger().saved(), {});
  nodes_[0]->receive(core::RegionId{2}, last.saved(), {});
  nodes_[0]->progress(now_);
  EXPECT_EQ(files(0).size(), 1U);
  let_all_hear();
  EXPECT_EQ(files(1).size(), 2U);
  EXPECT_EQ(state_of("w.cut"), 200);
}

TEST_F(PartWriters, OtherNamesAreLeftAlone) {
  save("a.cut", 100);
  save("b.cut", 150);
  let_all_hear();
  EXPECT_EQ(state_of("a.cut"), 100);
  EXPECT_EQ(state_of("b.cut"), 150);
  EXPECT_THAT(file_counts(), ElementsAre(2, 2, 2, 2));
}

TEST_F(PartWriters, TheNewestRegularWorldsStay) {
  for (core::Step step = 60; step <= 300; step += 60) {
    save_regularly(step);
    let_all_hear();
  }
  EXPECT_THAT(file_counts(), ElementsAre(kKeep, kKeep, kKeep, kKeep));
  EXPECT_EQ(state_of("state-300.cut"), 300);
  EXPECT_EQ(state_of("state-240.cut"), 240);
}

TEST_F(PartWriters, WhatFailsEachTimeIsSaidOnceAndRemembered) {
  full_ = {0, 1, 2, 3};
  for (core::Step step = 60; step <= 600; step += 60) {
    save_regularly(step);
    let_all_hear();
  }
  ASSERT_EQ(words_.size(), 1U);
  EXPECT_THAT(words_[0], HasSubstr("regions [0, 1, 2, 3]"));
  for (const auto& node : nodes_) EXPECT_TRUE(node->regular_ones_failed());
  EXPECT_THAT(file_counts(), ElementsAre(0, 0, 0, 0));
  full_.clear();
  save_regularly(660);
  let_all_hear();
  EXPECT_FALSE(nodes_[1]->regular_ones_failed());
  ASSERT_EQ(words_.size(), 2U) << "and so is that it works again";
  EXPECT_THAT(words_.back(), HasSubstr("state 660 is saved again"));
}

/// One host's disk is full from some state on: the newest state that is complete stays, on all hosts.
TEST_F(PartWriters, StatesOnDiskStayUntilLaterOnesAreWhole) {
  for (core::Step step = 60; step <= 240; step += 60) {
    keep_on_disk(step);
    let_all_hear();
  }
  full_ = {3};
  for (core::Step step = 300; step <= 900; step += 60) {
    keep_on_disk(step);
    let_all_hear();
  }
  EXPECT_EQ(state_of("state-240.cut"), 240);
  EXPECT_THAT(file_counts(), ElementsAre(2, 2, 2, 2));
  EXPECT_EQ(words_.size(), 1U);
  EXPECT_FALSE(nodes_[0]->regular_ones_failed());
}

/// Nobody else knows of the files of the process that had the region before.
TEST_F(PartWriters, WhoTakesARegionOverRemovesItsOldStates) {
  for (core::Step step = 60; step <= 180; step += 60) {
    keep_on_disk(step);
    let_all_hear();
  }
  write_part(2, "state-240.cut", 240, SaveKind::kKept);
  start_node(2);
  life_ = 2;
  for (core::Step step = 240; step <= 360; step += 60) {
    keep_on_disk(step);
    let_all_hear();
  }
  EXPECT_THAT(file_counts(), ElementsAre(2, 2, 2, 2));
  EXPECT_EQ(state_of("state-360.cut"), 360);
}

/// A host that says nothing of its disk: the others do not fill theirs, and there is always a state that all have.
TEST_F(PartWriters, StatesOfWhichNobodyKnowsWhetherTheyAreWholeAreLimited) {
  for (core::Step step = 60; step <= 3000; step += 60) keep_on_disk(step);
  for (auto& node : nodes_) node->progress(now_);
  for (const std::size_t count : file_counts()) EXPECT_LE(count, 6U);
  EXPECT_EQ(state_of("state-3000.cut"), 3000);
}

TEST_F(PartWriters, OnlyTheStateThatIsComputedAnewStays) {
  save_regularly(60);
  let_all_hear();
  life_ = 2;
  save_regularly(60);
  let_all_hear();
  EXPECT_THAT(file_counts(), ElementsAre(1, 1, 1, 1));
  EXPECT_EQ(state_of("state-60.cut"), 60);
}

/// What the last message of a lost run names.
class NewestWorld : public PartWriters {
 protected:
  SavedBy this_run() const { return {launch_.world_identity(), {1}, "aurasim launch demo"}; }
  /// All on one host.
  fs::path one_folder() {
    for (std::uint32_t r = 0; r < kRegions; ++r) {
      nodes_[r] = std::make_unique<PartWriter>(PartFolders{folder_, folder_ / "run-1"}, core::RegionId{r}, kRegions, 3);
    }
    return folder_;
  }
};

TEST_F(NewestWorld, IsOfThisRunCompleteAndReadable) {
  const fs::path folder = one_folder();
  EXPECT_FALSE(newest_saved_world({folder}, this_run()));
  EXPECT_THAT(world_is_lost({folder}, this_run()), HasSubstr("No whole world of this run"));
  save_regularly(60);
  save_regularly(120);
  for (const std::uint32_t some : {0U, 1U, 3U}) write_part(some, "state-180.cut", 180, SaveKind::kRegular);
  std::ofstream(folder / "state-999999.cut") << "junk";
  SavedWorld other;
  other.run = 2;
  other.saved_ms = std::int64_t{1} << 50;
  other.identity = identity_of(launch_);
  other.cut.step = 5000;
  PartStore(folder).write("state-5000.cut", other);
  EXPECT_EQ(newest_saved_world({folder}, this_run())->header.cut.step, 120);
  EXPECT_THAT(world_is_lost({folder}, this_run()),
              HasSubstr("aurasim launch demo --load " + (folder / "state-120.cut").string()));
  keep_on_disk(150);
  EXPECT_EQ(newest_saved_world({folder, folder / "run-1"}, this_run())->header.cut.step, 150);
  EXPECT_EQ(newest_saved_until(folder, this_run(), 119).step, 60);
  EXPECT_EQ(newest_saved_until(folder, this_run(), 59).step, -1);
}

}  // namespace
}  // namespace aurasim::cut
