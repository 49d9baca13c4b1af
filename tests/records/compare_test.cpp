// Two reports, written by hand: are they the same run?
#include "records/compare.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "records/report_rows.h"
#include "scratch_folder.h"

namespace aurasim::records {
namespace {

class CompareReports : public ::testing::Test {
 protected:
  void hashes(const char* report, std::initializer_list<HashRow> rows) {
    std::string text = csv_header<HashRow>();
    for (const HashRow& row : rows) text += csv_line(row);
    folder_.write(std::filesystem::path(report) / "state_hash.csv", text);
  }
  void bodies(const char* report, std::uint32_t region, std::initializer_list<BodyRow> rows) {
    std::string text = csv_header<BodyRow>();
    for (const BodyRow& row : rows) text += csv_line(row);
    folder_.write(std::filesystem::path(report) / ("region_" + std::to_string(region)) / "bodies.csv", text);
  }
  static BodyRow here(std::uint64_t id, double x_m) {
    return {.body = core::BodyId{id}, .where = BodyRow::kHere, .x_m = x_m};
  }
  Comparison compare() const { return compare_reports(folder_.path() / "a", folder_.path() / "b"); }

  test::ScratchFolder folder_;
};

TEST_F(CompareReports, EqualHashesOfTheSameStepsAreTheSameRun) {
  hashes("a", {{0, Hex64{7}}, {1, Hex64{8}}});
  hashes("b", {{0, Hex64{7}}, {1, Hex64{8}}});
  const Comparison result = compare();
  EXPECT_TRUE(result.hashes_equal);
  EXPECT_EQ(result.steps_compared, 2u);
  EXPECT_EQ(result.first_difference_step, std::nullopt);
}

TEST_F(CompareReports, TheFirstStepThatDiffersIsNamed) {
  hashes("a", {{0, Hex64{7}}, {1, Hex64{8}}, {2, Hex64{9}}});
  hashes("b", {{0, Hex64{7}}, {1, Hex64{18}}, {2, Hex64{19}}});
  const Comparison result = compare();
  EXPECT_FALSE(result.hashes_equal);
  EXPECT_EQ(result.first_difference_step, 1);
}

TEST_F(CompareReports, ARunThatGoesOnFromASavedWorldIsComparedFromThere) {
  hashes("a", {{0, Hex64{7}}, {1, Hex64{8}}, {2, Hex64{9}}});
  hashes("b", {{1, Hex64{8}}, {2, Hex64{9}}});
  EXPECT_TRUE(compare().hashes_equal);
  EXPECT_EQ(compare().first_step, 1);
  EXPECT_EQ(compare().steps_compared, 2u);
  hashes("b", {{2, Hex64{9}}, {3, Hex64{9}}});
  EXPECT_FALSE(compare().hashes_equal);
  hashes("b", {{1, Hex64{8}}, {2, Hex64{10}}});
  EXPECT_FALSE(compare().hashes_equal);
  EXPECT_EQ(compare().first_difference_step, 2);
  hashes("b", {{3, Hex64{9}}});
  EXPECT_FALSE(compare().hashes_equal);
}

TEST_F(CompareReports, ARunThatIsShorterIsNotTheSame) {
  hashes("a", {{0, Hex64{7}}, {1, Hex64{8}}});
  hashes("b", {{0, Hex64{7}}});
  for (const auto& [one, other] : {std::pair{"a", "b"}, {"b", "a"}}) {
    const Comparison result = compare_reports(folder_.path() / one, folder_.path() / other);
    EXPECT_FALSE(result.hashes_equal);
    EXPECT_EQ(result.steps_compared, 1u);
    EXPECT_EQ(result.first_difference_step, std::nullopt);
  }
}

TEST_F(CompareReports, BodiesAreComparedWhoeverHostsThem) {
  hashes("a", {{0, Hex64{7}}});
  hashes("b", {{0, Hex64{7}}});
  bodies("a", 0, {here(1, 1), here(2, 2)});
  bodies("b", 0, {here(2, 2.5)});
  BodyRow turned = here(1, 1);
  turned.qw = turned.qx = std::numbers::sqrt2 / 2;
  bodies("b", 1, {turned});
  const Comparison result = compare();
  EXPECT_EQ(result.bodies_compared, 2u);
  EXPECT_EQ(result.bodies_in_one_only, 0u);
  EXPECT_DOUBLE_EQ(result.max_position_error_m, 0.5);
  EXPECT_NEAR(result.max_rotation_error_rad, std::numbers::pi / 2, 1e-12);
}

TEST_F(CompareReports, WhoIsInOneOnlyIsCountedAndWhoIsUnderWayIsNot) {
  hashes("a", {{0, Hex64{7}}});
  hashes("b", {{0, Hex64{7}}});
  BodyRow under_way = here(3, 9);
  under_way.where = BodyRow::kUnderWay;
  bodies("a", 0, {here(1, 1), under_way});
  bodies("b", 0, {here(2, 1)});
  const Comparison result = compare();
  EXPECT_EQ(result.bodies_compared, 0u);
  EXPECT_EQ(result.bodies_in_one_only, 2u);
}

TEST_F(CompareReports, AReportWithoutHashesIsRefused) {
  hashes("a", {{0, Hex64{7}}});
  std::filesystem::create_directories(folder_.path() / "b");
  EXPECT_THROW(compare(), std::runtime_error);
  hashes("b", {});
  EXPECT_THROW(compare(), std::runtime_error);
}

TEST_F(CompareReports, ABrokenHashIsRefused) {
  hashes("a", {{0, Hex64{7}}});
  folder_.write("b/state_hash.csv", "step,hash\n0,0000000000000007\n1\n");
  EXPECT_THROW(compare(), std::runtime_error);
}

}  // namespace
}  // namespace aurasim::records
