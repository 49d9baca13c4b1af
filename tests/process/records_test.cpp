// The files that a process records as it goes through generations and recoveries.
#include "process/records.h"

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace aurasim::process {
namespace {

class RecordsTest : public ::testing::Test {
 protected:
  RecordsTest() : folder_(std::filesystem::temp_directory_path() / ("records_test." + std::to_string(::getpid()))) {
    std::filesystem::remove_all(folder_);
  }
  ~RecordsTest() override { std::filesystem::remove_all(folder_); }

  void write(Records& records, core::Step step) {
    node::StepReport report;
    report.step = step;
    records.write(report);
  }
  /// The rows of steps.csv, without the head; the file is complete once the records are closed.
  std::vector<std::string> rows() const {
    std::ifstream in(records::Recorder::region_folder(folder_, core::RegionId{1}) / "steps.csv");
    std::vector<std::string> rows;
    for (std::string line; std::getline(in, line);) rows.push_back(line);
    if (!rows.empty()) rows.erase(rows.begin());
    return rows;
  }

  std::filesystem::path folder_;
};

TEST_F(RecordsTest, WithoutAFolderNothingIsRecorded) {
  Records records({}, core::RegionId{1});
  records.begin();
  write(records, 1);
  EXPECT_EQ(records.recorder(), nullptr);
  EXPECT_EQ(records.go_on_after(3), "");
  EXPECT_FALSE(records.is_replaced());
  EXPECT_FALSE(records.end());
}

TEST_F(RecordsTest, AStateHasItsFrameTimeWhenItIsConfirmed) {
  Records records(folder_, core::RegionId{1});
  records.begin();
  records.note_wait(1.25);
  records.note_wait(1.25);
  records.note_frame(1, 7.125);
  records.note_frame(2, 8.375);
  write(records, 1);
  write(records, 2);
  records.close();
  ASSERT_EQ(rows().size(), 2U);
  EXPECT_NE(rows()[0].find("7.125"), std::string::npos) << rows()[0];
  EXPECT_NE(rows()[0].find("2.5"), std::string::npos) << rows()[0];
  EXPECT_NE(rows()[1].find("8.375"), std::string::npos) << rows()[1];
  EXPECT_EQ(rows()[1].find("2.5"), std::string::npos) << "the wait was for state 1: " << rows()[1];
}

TEST_F(RecordsTest, AfterARecoveryTheStatesThatAreComputedAgainAreDropped) {
  Records records(folder_, core::RegionId{1});
  records.begin();
  for (core::Step step = 1; step <= 5; ++step) write(records, step);
  EXPECT_EQ(records.go_on_after(3), "");
  write(records, 4);
  records.close();
  EXPECT_EQ(rows().size(), 4U);
}

TEST_F(RecordsTest, AResetBeginsNewFiles) {
  Records records(folder_, core::RegionId{1});
  records.begin();
  for (core::Step step = 1; step <= 5; ++step) write(records, step);
  records.begin();
  write(records, 1);
  records.close();
  EXPECT_EQ(rows().size(), 1U);
}

TEST_F(RecordsTest, AFolderThatCannotBeMadeIsNamedAndTheRunGoesOn) {
  std::ofstream(folder_) << "a file";
  Records records(folder_, core::RegionId{1});
  EXPECT_NE(records.go_on_after(3), "");
  write(records, 4);
  EXPECT_EQ(records.recorder(), nullptr);
  EXPECT_THROW(records.begin(), std::runtime_error);
}

}  // namespace
}  // namespace aurasim::process
