// A process that goes on in another role is started with the words of its first one, but for what says which.
#include "host/other_role.h"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "scratch_folder.h"

namespace aurasim::host {
namespace {

using ::testing::ElementsAre;
using Words = std::vector<std::string>;

TEST(OtherRole, ASpareBecomesTheNodeOfTheRegionThatItIsToldToTake) {
  const Words spare = {"/bin/aurasim", "spare", "demo", "--report", "out", "--set", "dds.domain=7"};
  EXPECT_THAT(words_of_successor(spare, core::RegionId{3}, 12),
              ElementsAre("/bin/aurasim", "node", "demo", "--report", "out", "--set", "dds.domain=7", "--run", "12",
                          "--take-over", "--region", "3"));
}

TEST(OtherRole, TheRunThatItWasToldStays) {
  EXPECT_THAT(words_of_successor({"a", "spare", "demo", "--run", "5"}, core::RegionId{0}, 5),
              ElementsAre("a", "node", "demo", "--run", "5", "--take-over", "--region", "0"));
  EXPECT_THAT(words_of_successor({"a", "spare", "demo", "--run=5"}, core::RegionId{0}, 5),
              ElementsAre("a", "node", "demo", "--run=5", "--take-over", "--region", "0"));
}

TEST(OtherRole, ANodesHostTakesAnotherRegionToo) {
  EXPECT_THAT(words_of_successor({"a", "node", "demo", "--region", "1", "--start-time-out", "5", "--run", "5"},
                                 core::RegionId{2}, 5),
              ElementsAre("a", "node", "demo", "--run", "5", "--take-over", "--region", "2"));
}

TEST(OtherRole, ANodeThatTheOthersDoWithoutBecomesASpare) {
  EXPECT_THAT(words_of_spare({"a", "node", "demo", "--region=1", "--report", "out", "--take-over"}),
              ElementsAre("a", "spare", "demo", "--report", "out"));
}

TEST(OtherRole, ANodeThatMayBeASpareIsEither) {
  const Words words = {"a", "node", "demo", "--region", "1", "--or-spare", "--saves", "kept"};
  EXPECT_THAT(words_of_spare(words), ElementsAre("a", "spare", "demo", "--saves", "kept"));
  EXPECT_THAT(words_of_plain_node(words), ElementsAre("a", "node", "demo", "--region", "1", "--saves", "kept"));
}

class AProgramsPlace : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& name) { return scratch_.write(name, "program"); }
  std::filesystem::path link_to(const std::filesystem::path& target) {
    std::filesystem::create_symlink(target, folder_ / "exe");
    return folder_ / "exe";
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

TEST_F(AProgramsPlace, IsWhatTheLinkNames) {
  const std::filesystem::path program = file("aurasim");
  EXPECT_EQ(program_at(link_to(program)), program);
}

TEST_F(AProgramsPlace, IsThatOfTheNewOneAfterAnUpgrade) {
  EXPECT_EQ(program_at(link_to(folder_ / "aurasim (deleted)")), folder_ / "aurasim");
}

TEST_F(AProgramsPlace, MayReallyBeCalledDeleted) {
  const std::filesystem::path program = file("aurasim (deleted)");
  EXPECT_EQ(program_at(link_to(program)), program);
}

TEST(OtherRole, AFileMayBeCalledLikeARole) {
  EXPECT_THAT(words_of_spare({"a", "node", "node", "--region", "1"}), ElementsAre("a", "spare", "node"));
}

}  // namespace
}  // namespace aurasim::host
