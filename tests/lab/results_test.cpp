// Stored results: what a run appends, and what a quick run is compared with.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lab/suites/results_file.h"
#include "lab/suites/suites.h"
#include "scratch_folder.h"

namespace aurasim::lab {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class StoredResults : public ::testing::Test {
 protected:
  void store(const std::vector<ResultRow>& rows, bool quick = false, const char* commit = "abc") {
    append_results(file(), rows, {commit, "2026-01-02", "4 cores", quick});
  }
  std::vector<nlohmann::json> lines() const {
    std::vector<nlohmann::json> all;
    std::ifstream in(file());
    for (std::string line; std::getline(in, line);) all.push_back(nlohmann::json::parse(line));
    return all;
  }
  std::filesystem::path file() const { return folder_ / "suite.jsonl"; }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path() / "results";
};

TEST_F(StoredResults, EachRunAppendsOneLinePerRow) {
  store({{"stack/exact", "sunk", 0.125, "m", 3}});
  store({{"stack/exact", "sunk", std::nan(""), "m"}}, true);
  ASSERT_EQ(lines().size(), 2u);
  EXPECT_EQ(lines()[0], nlohmann::json::parse(R"({"case": "stack/exact", "metric": "sunk", "value": 0.125, "unit": "m",
      "n": 3, "commit": "abc", "date": "2026-01-02", "machine": "4 cores", "run": "full"})"));
  EXPECT_TRUE(lines()[1]["value"].is_null()) << "JSON has no NaN";
  EXPECT_EQ(lines()[1]["run"], "quick");
}

TEST_F(StoredResults, AFolderThatCannotBeWrittenIsNamed) {
  std::ofstream(folder_) << "a file where the folder should be";
  EXPECT_THROW(store({{"a", "b", 1, "m"}}), std::exception);
}

TEST_F(StoredResults, AnErrorThatChangedIsADifferenceAndATimeThatScattersIsNot) {
  store({{"stack", "sunk", 0.1, "m"}, {"stack", "time", 100, "us"}, {"stack", "times", 1, "ratio"}});
  EXPECT_THAT(differences(file(), {{"stack", "sunk", 0.1, "m"}, {"stack", "time", 160, "us"}}), IsEmpty());
  const auto found = differences(file(), {{"stack", "sunk", 0.102, "m"},
                                          {"stack", "time", 250, "us"},
                                          {"stack", "times", 0.6, "ratio"},
                                          {"stack", "new metric", 1, "m"}});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].now.metric, "sunk");
  EXPECT_EQ(found[0].stored, 0.1);
  EXPECT_EQ(found[0].stored_commit, "abc");
  EXPECT_EQ(differences(file(), {{"stack", "sunk", std::nan(""), "m"}}).size(), 1u);
}

TEST_F(StoredResults, TheNewestFullRunCounts) {
  store({{"stack", "sunk", 0.1, "m"}});
  store({{"stack", "sunk", 0.2, "m"}}, false, "def");
  store({{"stack", "sunk", 0.3, "m"}}, true);
  EXPECT_THAT(differences(file(), {{"stack", "sunk", 0.2, "m"}}), IsEmpty());
  const auto found = differences(file(), {{"stack", "sunk", 0.3, "m"}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].stored_commit, "def");
}

TEST_F(StoredResults, ALineThatIsNoRowIsNamed) {
  store({{"stack", "sunk", 0.1, "m"}});
  std::ofstream(file(), std::ios::app) << R"({"case": "stack"})"
                                       << "\n";
  try {
    differences(file(), {});
    FAIL() << "the second line was taken for a row";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("suite.jsonl:2: "));
  }
}

TEST_F(StoredResults, NothingStoredYetDiffersFromNothing) {
  EXPECT_THAT(differences(file(), {{"stack", "sunk", 0.1, "m"}}), IsEmpty());
}

TEST(Suites, ARequirementThatIsMissedIsHandedOnAndStored) {
  SuiteResults results;
  add_targets(results, {{"late", 2, 1}, {"counted", 2, 1, true}});
  ASSERT_EQ(results.rows.size(), 4u);
  EXPECT_EQ(results.rows[1].what, "requirement/late");
  EXPECT_EQ(results.rows[1].metric, "at most");
  EXPECT_EQ(results.rows[3].metric, "at least");
  EXPECT_FALSE(results.targets[0].met());
  EXPECT_TRUE(results.targets[1].met());
}

TEST(Suites, ASuiteThatIsStoppedSaysNothingMoreOfItsCases) {
  for (const Suite& suite : suites()) {
    if (suite.name == std::string_view("correctness_over_dds")) continue;  // it needs DDS
    int asked = 0;
    suite.run({}, [&](double share) {
      EXPECT_GE(share, 0) << suite.name;
      EXPECT_LE(share, 1) << suite.name;
      return ++asked < 1;
    });
    EXPECT_GE(asked, 1) << suite.name;
    EXPECT_LE(asked, 3) << suite.name;
  }
}

/// The parts of a suite, run alone, give the rows that they have in the whole.
TEST(Suites, APartAloneHasTheRowsThatItHasAmongOthers) {
  const auto go_on = [](double) { return true; };
  const SuiteResults spring = run_accuracy_suite({Effort::kQuick, {"spring"}}, go_on);
  const SuiteResults both = run_accuracy_suite({Effort::kQuick, {"free_fall", "spring"}}, go_on);
  ASSERT_FALSE(spring.rows.empty());
  for (const ResultRow& row : spring.rows) {
    if (row.unit == "us") continue;
    const auto same = [&](const ResultRow& other) {
      return other.what == row.what && other.metric == row.metric && other.value == row.value;
    };
    EXPECT_TRUE(std::ranges::any_of(both.rows, same)) << row.what << ", " << row.metric;
    EXPECT_TRUE(row.what.starts_with("spring/") || row.what.starts_with("requirement/")) << row.what;
  }
  EXPECT_GT(both.rows.size(), spring.rows.size());
}

}  // namespace
}  // namespace aurasim::lab
