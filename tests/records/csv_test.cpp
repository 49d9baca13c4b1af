// Rows are written in the order of their columns, and read by name.
#include "records/csv.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/ids.h"
#include "scratch_folder.h"

namespace aurasim::records {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Crate {
  core::RegionId region{};
  std::string_view kind{};
  double mass_kg = 0;
  double length_m = 0;
  bool open = false;
  std::optional<core::Step> seen{};
  Hex64 hash{};

  double density_kg_m() const { return mass_kg / length_m; }

  static constexpr auto columns() {
    return std::tuple{Column{"region", &Crate::region},
                      Column{"kind", &Crate::kind},
                      Column{"mass_kg", &Crate::mass_kg},
                      Column{"length_m", &Crate::length_m, "{:.2f}"},
                      Column{"density_kg_m", &Crate::density_kg_m, "{:.1f}"},
                      Column{"open", &Crate::open},
                      Column{"seen", &Crate::seen},
                      Column{"hash", &Crate::hash}};
  }
};

class CsvTest : public ::testing::Test {
 protected:
  /// The masses of the rows in a file with this text; `broken_` is how many rows were none.
  std::vector<double> masses_in(const std::string& text) {
    folder_.write("crates.csv", text);
    std::vector<double> masses;
    broken_ = read_csv<Crate>(file_, [&](const Crate& crate) { masses.push_back(crate.mass_kg); });
    return masses;
  }

  test::ScratchFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "crates.csv";
  std::size_t broken_ = 0;
};

constexpr const char* kHeader = "region,kind,mass_kg,length_m,density_kg_m,open,seen,hash\n";

TEST_F(CsvTest, ARowIsWrittenInTheOrderAndTheFormatsOfItsColumns) {
  EXPECT_EQ(csv_header<Crate>(), kHeader);
  const Crate crate{core::RegionId{3}, "pine", 0.1, 2, true, 41, Hex64{0xabc}};
  EXPECT_EQ(csv_line(crate), "3,pine,0.1,2.00,0.1,1,41,0000000000000abc\n");
}

TEST_F(CsvTest, WhatIsNotThereIsAnEmptyCell) {
  EXPECT_EQ(csv_line(Crate{.kind = "oak", .mass_kg = 1, .length_m = 1}), "0,oak,1,1.00,1.0,0,,0000000000000000\n");
}

TEST_F(CsvTest, ARowReadIsTheRowWritten) {
  const Crate crate{core::RegionId{3}, "pine", 0.1 + 0.2, 2, true, -41, Hex64{~0ull}};
  folder_.write("crates.csv", csv_header<Crate>() + csv_line(crate) + csv_line(Crate{.length_m = 1}));
  std::vector<std::string> lines;
  EXPECT_EQ(read_csv<Crate>(file_, [&](const Crate& read) { lines.push_back(csv_line(read)); }), 0u);
  EXPECT_THAT(lines, ElementsAre(csv_line(crate), csv_line(Crate{.length_m = 1})));
}

TEST_F(CsvTest, ColumnsAreFoundByTheirNamesBesideOthers) {
  Crate read;
  folder_.write("crates.csv",
                "length_m,colour,hash,seen,open,mass_kg,kind,region\n"
                "2,red,ff,7,1,5,oak,9\n");
  EXPECT_EQ(read_csv<Crate>(file_, [&](const Crate& crate) { read = crate; }), 0u);
  EXPECT_EQ(read.region, core::RegionId{9});
  EXPECT_EQ(read.mass_kg, 5);
  EXPECT_EQ(read.length_m, 2);
  EXPECT_TRUE(read.open);
  EXPECT_EQ(read.seen, 7);
  EXPECT_EQ(read.hash, Hex64{0xff});
}

TEST_F(CsvTest, AColumnThatIsMissingIsNamedWithItsFile) {
  try {
    masses_in("region,kind,length_m,open,seen,hash\n");
    FAIL() << "nothing was said";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("crates.csv: no column mass_kg"));
  }
}

TEST_F(CsvTest, ADerivedColumnMayBeMissing) {
  EXPECT_THAT(masses_in("region,kind,mass_kg,length_m,open,seen,hash\n1,a,5,1,0,,0\n"), ElementsAre(5));
}

TEST_F(CsvTest, ARowThatIsNoneIsLeftOutAndCounted) {
  EXPECT_THAT(masses_in(std::string(kHeader) + "1,a,5,1,0,0,,0\n"
                                               "1,a,5,1,0\n"
                                               "1,a,five,1,0,0,,0\n"
                                               "1,a,5,1,0,maybe,,0\n"
                                               "-1,a,5,1,0,0,,0\n"
                                               "1,a,5x,1,0,0,,0\n"
                                               "1,a,6,1,0,0,,0,more\n"
                                               "1,a,7,1,0,0,,0\n"),
              ElementsAre(5, 7));
  EXPECT_EQ(broken_, 6u);
}

TEST_F(CsvTest, ALastLineThatWasCutOffIsLeftOut) {
  EXPECT_THAT(masses_in(std::string(kHeader) + "1,a,5,1,0,0,,0\n1,a,6,1,0,0,,0"), ElementsAre(5));
  EXPECT_EQ(broken_, 0u);
}

TEST_F(CsvTest, AHeaderThatWasCutOffHasNoRows) { EXPECT_TRUE(masses_in("region,ki").empty()); }

TEST_F(CsvTest, AFileThatIsNotThereHasNoRows) {
  EXPECT_EQ(read_csv<Crate>(file_.string() + "_not", [](const Crate&) { FAIL(); }), 0u);
}

}  // namespace
}  // namespace aurasim::records
