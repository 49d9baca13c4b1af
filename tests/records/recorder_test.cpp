// What a node leaves on disk, and what is left when the disk is full.
#include "records/recorder.h"

#include <csignal>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "records/csv.h"
#include "records/report.h"
#include "scratch_folder.h"
#include "transport/memory_transport.h"

namespace aurasim::records {
namespace {

using core::RegionId;
using ::testing::HasSubstr;

/// From now on no file grows beyond this, as if the disk were full.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~SmallDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

class Records : public ::testing::Test {
 protected:
  Records() : network_({{}}, {}, 1), node_({}, core::Scene{}, map_, network_.endpoint(RegionId{0})) {}

  void write_steps(Recorder& recorder, core::Step first, core::Step last) {
    for (core::Step step = first; step <= last; ++step) {
      node::StepReport report;
      report.step = step;
      report.hash = {{step, static_cast<std::uint64_t>(step)}};
      recorder.write(report, {});
    }
  }
  void finish(Recorder& recorder) { recorder.finish(node_, {1, "finished", {}}); }

  std::filesystem::path file(const char* name) const { return folder_ / "region_0" / name; }
  std::string text(const char* name) const {
    std::ifstream in(file(name));
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  /// The values of the column, row by row.
  std::vector<std::uint64_t> column(const char* name, std::size_t index) const {
    std::vector<std::uint64_t> values;
    read_csv(file(name), [&](const std::vector<std::string_view>& cells) { values.push_back(whole(cells.at(index))); });
    return values;
  }
  nlohmann::json last_word() const { return nlohmann::json::parse(text("node.json")); }

  core::RegionMap map_ = core::RegionMap::columns(1, 1);
  transport::MemoryNetwork network_;
  node::Node node_;
  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

TEST_F(Records, HaveOneRowPerStepAndALastWord) {
  Recorder recorder(folder_, RegionId{0});
  write_steps(recorder, 0, 100);
  finish(recorder);
  const auto steps = column("steps.csv", 1);
  ASSERT_EQ(steps.size(), 101U);
  for (std::size_t i = 0; i < steps.size(); ++i) EXPECT_EQ(steps[i], i);
  EXPECT_EQ(last_word().at("outcome"), "finished");
  EXPECT_EQ(last_word().at("computing_s"), node_.time_spent().all_s());
  EXPECT_EQ(last_word().at("in_redos_s"), 0);
  EXPECT_FALSE(recorder.records_end());
}

TEST_F(Records, OfANodeThatIsKilledEndEarlyAndSaySo) {
  Recorder recorder(folder_, RegionId{0});
  write_steps(recorder, 0, 119);
  EXPECT_EQ(column("steps.csv", 1).size(), 61U) << "what the last flush has brought to the disk";
  EXPECT_EQ(last_word().at("outcome"), "died");
  EXPECT_EQ(regions_without_end(folder_, 1).size(), 1U);
}

TEST_F(Records, HashesReachTheDiskAsTheyCome) {
  Recorder recorder(folder_, RegionId{0});
  write_steps(recorder, 0, 60);
  EXPECT_EQ(column("state_hash.csv", 0).size(), 61U);
  node::StepReport late;
  late.hash = {{3, 5}};  // a cluster that joined makes up an older state
  recorder.write_settling(late);
  finish(recorder);
  RunFacts facts;
  facts.regions = 1;
  merge_report(folder_, facts);
  std::ifstream merged(folder_ / "state_hash.csv");
  std::string line;
  for (int i = 0; i < 5; ++i) std::getline(merged, line);
  EXPECT_EQ(line, "3,0000000000000008") << "both parts of the state";
}

TEST_F(Records, EndWithWholeRowsWhereTheDiskIsFullAndTheRunGoesOn) {
  Recorder recorder(folder_, RegionId{0});
  {
    const SmallDisk disk(20'000);
    write_steps(recorder, 0, 1000);
    finish(recorder);
  }
  ASSERT_TRUE(recorder.records_end());
  EXPECT_THAT(recorder.records_end()->why, HasSubstr("steps.csv: File too large"));
  const auto steps = column("steps.csv", 1);
  ASSERT_FALSE(steps.empty());
  EXPECT_EQ(steps.back(), static_cast<std::uint64_t>(recorder.records_end()->after));
  EXPECT_EQ(text("steps.csv").back(), '\n');
  EXPECT_EQ(last_word().at("records_end").at("after_step"), recorder.records_end()->after);
}

TEST_F(Records, TheLastWordHasItsRoomKept) {
  Recorder recorder(folder_, RegionId{0});
  const auto before = std::filesystem::file_size(file("node.json"));
  write_steps(recorder, 0, 10);
  finish(recorder);
  EXPECT_LE(std::filesystem::file_size(file("node.json")), before);
  EXPECT_EQ(last_word().at("steps"), 0);
}

/// Every write to that file fails, as on a disk that is full from the first byte.
TEST_F(Records, KnowWhenAnotherProcessHasTakenThemOver) {
  const Recorder first(folder_, RegionId{0});
  EXPECT_FALSE(first.is_replaced());
  const Recorder successor(folder_, RegionId{0}, 0);
  EXPECT_TRUE(first.is_replaced());
  EXPECT_FALSE(successor.is_replaced());
}

/// Of a long file only the end is read.
TEST_F(Records, GoOnAfterAnEarlierState) {
  constexpr core::Step kLast = 20'000, kAfter = 15'000;
  {
    Recorder recorder(folder_, RegionId{0});
    write_steps(recorder, 0, kLast - 1);
    node::StepReport last;
    last.step = kLast;
    last.births = {{core::BodyId{7}, kAfter - 10}, {core::BodyId{8}, kAfter + 1}};  // both told late
    recorder.write(last, {});
    finish(recorder);
  }
  ASSERT_EQ(column("steps.csv", 1).size(), kLast + 1);
  std::ofstream(file("steps.csv"), std::ios::app) << "0,12";  // killed while it wrote
  {
    Recorder successor(folder_, RegionId{0}, kAfter);
    write_steps(successor, kAfter + 1, kAfter + 100);
    finish(successor);
  }
  const auto steps = column("steps.csv", 1);
  ASSERT_EQ(steps.size(), kAfter + 101);
  for (std::size_t i = 0; i < steps.size(); ++i) ASSERT_EQ(steps[i], i);
  EXPECT_EQ(column("state_hash.csv", 0).size(), kAfter + 101);
  EXPECT_THAT(column("births.csv", 1), ::testing::ElementsAre(7));
  EXPECT_FALSE(std::filesystem::exists(file("steps.csv.new")));
}

TEST_F(Records, AFileThatCannotBeWrittenIsNamedAtTheStart) {
  std::filesystem::create_directories(folder_ / "region_0");
  std::filesystem::create_symlink("/dev/full", file("steps.csv"));
  try {
    const Recorder recorder(folder_, RegionId{0});
    FAIL() << "nothing said";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("steps.csv: No space left on device"));
  }
}

}  // namespace
}  // namespace aurasim::records
