// A process that goes on in another role is started with the words of its first one, but for what says which.
#include "cli/other_role.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::cli {
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

TEST(OtherRole, AFileMayBeCalledLikeARole) {
  EXPECT_THAT(words_of_spare({"a", "node", "node", "--region", "1"}), ElementsAre("a", "spare", "node"));
}

}  // namespace
}  // namespace aurasim::cli
